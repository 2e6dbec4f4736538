/* Sizes of vibrations, to which tolerances refer, and the fastest motion of the linearised model. */

#define SQUARINGS 10

/* Write d xdot / d x at the equilibrium, with teeth that pull; all contacts closed too, if that is asked for. */
static int linearise(balance *b, double *matrix, int closed) {
  const ltcgear_model *model = b->run->model;
  const whole n = model->n_states;
  pose(b, 0, 1, closed);
  for (whole g = 0; closed && g < model->n_holds; ++g)
    if (model->hold_closes[g]) b->p[model->holds[g]] = HELD;
  int fault = find_jacobian(b->run, b->x, b->s, b->p, b->nonzeros);
  memset(matrix, 0, (size_t)(n * n) * sizeof *matrix);
  for (whole j = 0; j < n; ++j)
    for (whole k = model->jacobian_colind[j]; k < model->jacobian_colind[j + 1]; ++k)
      matrix[model->jacobian_row[k] * n + j] = b->nonzeros[k];
  return fault;
}

/* Write a size for every state: the motion in which it alone stores one small energy, 1e-4 of the mean strain energy per
 * freedom, so that coordinates of all kinds weigh alike. */
static void find_scale(balance *b, const double *matrix) {
  const ltcgear_model *model = b->run->model;
  const whole n = model->n_states, f = model->n_freedoms;
  march *m = &b->run->m;
  call(&m->energy, b->x, b->s, m->p);
  double strain = m->balance[1], energy = strain > LOADED ? 1e-4 * strain / (double)f : UNLOADED, stiffest = 0;
  for (whole i = 0; i < n; ++i) m->scale[i] = 1;
  for (whole i = 0; i < f; ++i)
    stiffest = larger(stiffest, -matrix[model->freedoms[i].rate * n + model->freedoms[i].position]);
  for (whole i = 0; i < f; ++i) {
    const ltcgear_freedom *freedom = model->freedoms + i;
    double mass = m->p[freedom->inertia], stiffness = -matrix[freedom->rate * n + freedom->position] * mass;
    double floor = (stiffest > 0 ? 1e-8 * stiffest : 1.0) * mass; /* where nothing holds anything, 1 rad/s */
    m->scale[freedom->position] = sqrt(2 * energy / larger(stiffness, floor));
    m->scale[freedom->rate] = sqrt(2 * energy / mass);
  }
}

/* Return the largest modulus of an eigenvalue: the limit of |A^k|^(1/k) (Gelfand 1941), k = 2^SQUARINGS. */
static double spectral_radius(whole n, double *a, double *square) {
  double logarithm = 0, power = 1;
  for (int k = 0;; ++k) {
    double size = 0;
    for (whole i = 0; i < n * n; ++i) size += a[i] * a[i];
    size = sqrt(size);
    if (!(size > 0) || !isfinite(size)) return 0;
    logarithm += log(size) / power;
    if (k == SQUARINGS) return exp(logarithm);
    for (whole i = 0; i < n * n; ++i) a[i] /= size, square[i] = 0;
    for (whole i = 0; i < n; ++i)
      for (whole l = 0; l < n; ++l) {
        const double part = a[i * n + l];
        if (part != 0)
          for (whole j = 0; j < n; ++j) square[i * n + j] += part * a[l * n + j];
      }
    memcpy(a, square, (size_t)(n * n) * sizeof *a);
    power *= 2;
  }
}

/* Set the scale of all states, and how fast the fastest mode swings with all contacts closed. */
static int set_scale(balance *b, double *matrix, double *square) {
  const whole n = b->run->model->n_states;
  const double *scale = b->run->m.scale;
  int fault;
  pose(b, 0, 0, 0);
  if ((fault = linearise(b, matrix, 0))) return fault;
  find_scale(b, matrix);
  if ((fault = linearise(b, matrix, 1))) return fault;
  for (whole i = 0; i < n; ++i)
    for (whole j = 0; j < n; ++j) matrix[i * n + j] *= scale[j] / scale[i];
  b->run->quickest = spectral_radius(n, matrix, square);
  return DONE;
}

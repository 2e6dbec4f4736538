/* The explicit Runge-Kutta pair 5(4) of Dormand and Prince (1980), with the dense output of Shampine (1986) and the step
 * control of Hairer, Norsett and Wanner (Solving Ordinary Differential Equations I, II.4). */

#define SMALLEST 1e-14 /* step over segment below which it gives up */

static const double NODE[STAGES] = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1};
static const double A[STAGES][STAGES - 1] = {
    {0},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84},
};
static const double WEIGHT[STAGES] = {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84, 0};
static const double MISS[STAGES] = {
    71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
/* Rows: stages; columns: powers 1 to 4 of the part of a step. */
static const double DENSE[STAGES][4] = {
    {1, -8048581381.0 / 2820520608, 8663915743.0 / 2820520608, -12715105075.0 / 11282082432},
    {0, 0, 0, 0},
    {0, 131558114200.0 / 32700410799, -68118460800.0 / 10900136933, 87487479700.0 / 32700410799},
    {0, -1754552775.0 / 470086768, 14199869525.0 / 1410260304, -10690763975.0 / 1880347072},
    {0, 127303824393.0 / 49829197408, -318862633887.0 / 49829197408, 701980252875.0 / 199316789632},
    {0, -282668133.0 / 205662961, 2019193451.0 / 616988883, -1453857185.0 / 822651844},
    {0, 40617522.0 / 29380423, -110615467.0 / 29380423, 69997945.0 / 29380423},
};

/* Write the rates at a displacement y [own units] and a time after the segment's start, the power [W], and the mesh
 * forces where they are wanted. */
static int motion_at(march *m, double time, const double *y, double *rate, double *power, double *force) {
  for (whole i = 0; i < m->n; ++i) m->x[i] = m->origin[i] + y[i];
  for (whole i = 0; i < m->n_signals; ++i) {
    whole at = m->n_levels + i;
    m->s_now[at] = m->s[at] + m->slope[i] * time;
  }
  m->motion.res[0] = rate;
  m->motion.res[1] = power;
  m->motion.res[2] = force;
  m->rhs += 1;
  return call(&m->motion, m->x, m->s_now, m->p);
}

/* y + h sum w_j k_j of the first ``count`` stages: one pass for each count. */
#define PASS(sum) \
  for (whole i = 0; i < n; ++i) to[i] = y[i] + h * (sum); \
  break
#define K(j) w[j] * k[(j) * n + i]
static void combine(const march *m, whole count, const double *w, double h, const double *y, double *out) {
  const whole n = m->n;
  const double *restrict k = m->stages;
  double *restrict to = out;
  switch (count) {
    case 1: PASS(K(0));
    case 2: PASS(K(0) + K(1));
    case 3: PASS(K(0) + K(1) + K(2));
    case 4: PASS(K(0) + K(1) + K(2) + K(3));
    case 5: PASS(K(0) + K(1) + K(2) + K(3) + K(4));
    case 6: PASS(K(0) + K(1) + K(2) + K(3) + K(4) + K(5));
    default: PASS(K(0) + K(1) + K(2) + K(3) + K(4) + K(5) + K(6));
  }
}
#undef PASS
#undef K

static double added(const double *w, const double *power) {
  double sum = 0;
  for (int j = 0; j < STAGES; ++j) sum += w[j] * power[j];
  return sum;
}

/* The root mean square of a vector over what the tolerance allows. */
static double size_of(const march *m, const double *v, const double *y, const double *other) {
  double sum = 0;
  for (whole i = 0; i < m->n; ++i) {
    double part = v[i] / (m->rtol * (m->scale[i] + larger(fabs(y[i]), fabs(other[i]))));
    sum += part * part;
  }
  return sqrt(sum / (double)m->n);
}

/* A first step: a tenth of the time in which the rates change by as much as they are. */
static double first_step(march *m, double duration, const double *y) {
  double *k = m->stages, *other = m->stages + m->n, power, trial = 1e-6 * duration;
  combine(m, 1, (double[]){1}, trial, y, m->trial);
  if (motion_at(m, trial, m->trial, other, &power, 0)) return 0;
  for (whole i = 0; i < m->n; ++i) other[i] = (other[i] - k[i]) / trial;
  double rate = size_of(m, k, y, y), change = size_of(m, other, y, y);
  return change > 0 ? smaller(larger(0.1 * rate / change, trial), duration) : duration;
}

/* Fill the nodes of the path that lie within a step; the last one is the step's end. */
static whole fill_nodes(march *m, whole node, double start, double h, double duration, const double *y, double work) {
  const whole last = m->n_nodes - 1;
  for (; node < last && m->points[node] * duration <= start + h; ++node) {
    double part = (m->points[node] * duration - start) / h, weights[STAGES];
    for (int j = 0; j < STAGES; ++j)
      weights[j] = part * (DENSE[j][0] + part * (DENSE[j][1] + part * (DENSE[j][2] + part * DENSE[j][3])));
    double *row = m->path + node * m->n;
    combine(m, STAGES, weights, h, y, row);
    for (whole i = 0; i < m->n; ++i) row[i] /= m->scale[i];
    m->node_work[node] = work + h * added(weights, m->power);
  }
  return node;
}

/* Integrate a segment from z on; the path's nodes and the work at them, from its start. */
static int advance_erk(march *m, double duration) {
  const whole n = m->n;
  double *y = m->y, *after = m->y_after, *k = m->stages, *power = m->power;
  double t = 0, work = 0, before = 1e-4;
  whole node = 1, steps = 0;
  memcpy(m->s_now, m->s, (size_t)(m->n_levels + m->n_signals) * sizeof *m->s);
  for (whole i = 0; i < n; ++i) y[i] = m->scale[i] * m->z[i], m->path[i] = m->z[i];
  m->node_work[0] = 0;
  begin_extremes(m);
  if (motion_at(m, 0, y, k, power, m->forces)) return NOT_FINITE;
  note_forces(m, 0);
  double step = m->step > 0 ? m->step : first_step(m, duration, y);
  int rejected = 0;
  while (t < duration) {
    double left = duration - t, parts = ceil(left / step - 1e-3), h = left / larger(parts, 1);
    int last = parts <= 1;
    if (!(h > SMALLEST * duration)) return TOO_SMALL;
    if (++steps > m->most_steps) return TOO_MANY;
    for (int j = 1; j < STAGES; ++j) {
      double *at = j == STAGES - 1 ? after : m->trial, *forces = j == STAGES - 1 ? m->forces : 0;
      combine(m, j, A[j], h, y, at);
      if (motion_at(m, t + NODE[j] * h, at, k + j * n, power + j, forces)) return NOT_FINITE;
    }
    combine(m, STAGES, MISS, h, m->zeros, m->trial);
    double error = size_of(m, m->trial, y, after);
    if (!(error <= 1)) {
      m->rejected += 1;
      rejected = 1;
      step = h * (isfinite(error) ? larger(0.2, 0.9 * pow(error, -0.2)) : 0.1);
      continue;
    }
    m->steps += 1;
    whole before_step = node;
    node = fill_nodes(m, node, t, h, duration, y, work);
    if (node > before_step) steps = 0;
    double factor = 0.9 * pow(larger(error, 1e-10), -0.17) * pow(before, 0.04);
    factor = smaller(rejected ? 1.0 : 5.0, larger(0.2, factor));
    before = larger(error, 1e-4);
    rejected = 0;
    /* A step that was shortened to divide what was left says nothing against the longer one. */
    step = h * factor < step && factor >= 1 ? step : h * factor;
    work += h * added(WEIGHT, power);
    t = last ? duration : t + h;
    note_forces(m, t);
    double *other = y;
    y = after, after = other;
    memcpy(k, k + (STAGES - 1) * n, (size_t)n * sizeof *k);
    power[0] = power[STAGES - 1];
  }
  m->step = step;
  double *end = m->path + (m->n_nodes - 1) * n;
  for (whole i = 0; i < n; ++i) end[i] = y[i] / m->scale[i];
  m->node_work[m->n_nodes - 1] = work;
  m->reached = duration;
  for (whole i = 0; i < n; ++i)
    if (!isfinite(end[i])) return NOT_FINITE;
  return DONE;
}

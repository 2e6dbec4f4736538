/* The adjoint of an arc: lambda' = -(df/dx)' lambda - dh/dx backwards in time along a path that is known, and the
 * integral of f_p' lambda + h_p, by the pair of erk.c. h = a y + b y^2 / 2 is what an output y is worth a second. */

typedef struct {
  function motion, report;
  whole n, n_p, n_s, n_levels, n_nodes, steps, most_steps;
  double rtol, step, duration;
  double *points, *weights, *origin, *scale, *size, *path, *s, *slope, *p, *worth, *lambda, *gradient;
  double *x, *s_now, *stages, *gains, *report_x, *report_p, *trial, *after;
} adjoint;

/* Write the state and the levels and signals at a time after the arc's start. */
static void look_up(adjoint *a, double time) {
  const whole n = a->n;
  double part = time / a->duration, sum = 0;
  whole hit = -1;
  for (whole i = 0; i < n; ++i) a->x[i] = 0;
  for (whole j = 0; j < a->n_nodes && hit < 0; ++j)
    if (fabs(part - a->points[j]) < 1e-14) hit = j;
  for (whole j = 0; j < a->n_nodes; ++j) {
    if (hit >= 0 && j != hit) continue;
    double weight = hit >= 0 ? 1.0 : a->weights[j] / (part - a->points[j]);
    const double *row = a->path + j * n;
    sum += weight;
    for (whole i = 0; i < n; ++i) a->x[i] += weight * row[i];
  }
  for (whole i = 0; i < n; ++i) a->x[i] = a->origin[i] + a->scale[i] * (a->x[i] / sum);
  for (whole i = 0; i < a->n_s; ++i) a->s_now[i] = a->s[i];
  for (whole i = a->n_levels; i < a->n_s; ++i) a->s_now[i] += a->slope[i - a->n_levels] * time;
}

/* Write the rates of lambda and of the gradient, backwards in time. */
static int adjoint_at(adjoint *a, double time, const double *lambda, double *rate, double *gain) {
  look_up(a, time);
  a->motion.arg[3] = lambda;
  a->motion.res[0] = rate;
  a->motion.res[1] = gain;
  if (call(&a->motion, a->x, a->s_now, a->p)) return NOT_FINITE;
  if (a->worth[0] == 0 && a->worth[1] == 0) return DONE;
  a->report.arg[3] = a->worth;
  a->report.res[0] = a->report_x;
  a->report.res[1] = a->report_p;
  if (call(&a->report, a->x, a->s_now, a->p)) return NOT_FINITE;
  for (whole i = 0; i < a->n; ++i) rate[i] += a->report_x[i];
  for (whole i = 0; i < a->n_p; ++i) gain[i] += a->report_p[i];
  return DONE;
}

static double root_mean_square(const adjoint *a, const double *v) {
  double sum = 0;
  for (whole i = 0; i < a->n; ++i) sum += a->size[i] * v[i] * a->size[i] * v[i];
  return sqrt(sum / (double)a->n);
}

/* Go back from one time after the arc's start to an earlier one. */
EXPORTED int ltcgear_adjoint(adjoint *a, double from, double to) {
  const whole n = a->n, n_p = a->n_p;
  double *k = a->stages, t = from;
  whole tries = 0;
  if (adjoint_at(a, t, a->lambda, k, a->gains)) return NOT_FINITE;
  while (t > to) {
    double left = t - to, h = left / larger(ceil(left / a->step - 1e-3), 1);
    int last = h >= left * (1 - 1e-12);
    if (!(h > SMALLEST * a->duration)) return TOO_SMALL;
    if (++tries > a->most_steps) return TOO_MANY;
    for (int j = 1; j < STAGES; ++j) {
      double *at = j == STAGES - 1 ? a->after : a->trial;
      for (whole i = 0; i < n; ++i) {
        double sum = 0;
        for (int l = 0; l < j; ++l) sum += A[j][l] * k[l * n + i];
        at[i] = a->lambda[i] + h * sum;
      }
      double time = j >= STAGES - 2 && last ? to : t - NODE[j] * h;
      if (adjoint_at(a, time, at, k + j * n, a->gains + j * n_p)) return NOT_FINITE;
    }
    for (whole i = 0; i < n; ++i) {
      double sum = 0;
      for (int l = 0; l < STAGES; ++l) sum += MISS[l] * k[l * n + i];
      a->trial[i] = h * sum;
    }
    double missed = root_mean_square(a, a->trial);
    double whole_size = larger(root_mean_square(a, a->lambda), root_mean_square(a, a->after));
    double error = missed > 0 ? missed / (a->rtol * whole_size) : 0.0;
    if (!(error <= 1)) {
      a->step = h * (isfinite(error) ? larger(0.2, 0.9 * pow(error, -0.2)) : 0.1);
      continue;
    }
    for (whole i = 0; i < n_p; ++i) {
      double sum = 0;
      for (int l = 0; l < STAGES; ++l) sum += WEIGHT[l] * a->gains[l * n_p + i];
      a->gradient[i] += h * sum;
    }
    memcpy(a->lambda, a->after, (size_t)n * sizeof *k);
    memcpy(k, k + (STAGES - 1) * n, (size_t)n * sizeof *k);
    memcpy(a->gains, a->gains + (STAGES - 1) * n_p, (size_t)n_p * sizeof *k);
    double factor = smaller(5.0, larger(0.2, 0.9 * pow(larger(error, 1e-10), -0.2)));
    a->step = last && factor >= 1 ? larger(a->step, h * factor) : h * factor;
    a->steps += 1;
    t = last ? to : t - h;
  }
  return DONE;
}

/* A model's functions for solvers that are not ours: levels and load signals are found here, by state and time or as
 * they are held, so that one call does all. The structure ``dynamics`` stands before it, written from one list. */

/* A table at a time: linear between its rows, constant beyond its ends; or its slope just after that time. */
static double read_table(const dynamics *d, whole signal, double t) {
  whole low = d->first[signal], high = d->first[signal + 1] - 1;
  const double *time = d->times, *value = d->values;
  int slope = d->sloping[signal];
  if (t < time[low]) return slope ? 0.0 : value[low];
  if (t >= time[high]) return slope ? 0.0 : value[high];
  while (high - low > 1) {
    whole middle = (low + high) / 2;
    if (t >= time[middle]) low = middle;
    else high = middle;
  }
  double gain = (value[high] - value[low]) / (time[high] - time[low]);
  return slope ? gain : gain * (t - time[low]) + value[low];
}

/* Write the load signals at a time. */
static void find_loads(dynamics *d, double t) {
  double *signals = d->s + d->n_levels;
  for (whole i = 0; i < d->n_signals; ++i)
    signals[i] = d->held ? d->signals[i] + d->slope[i] * (t - d->base) : read_table(d, i, t);
}

/* Write the mesh phases: rows tau, rate, share. */
static int find_course(dynamics *d, const double *x) {
  for (whole i = 0; i < d->n_levels; ++i) d->s[i] = 0.0;
  return call(&d->phases, x, d->s, d->p);
}

/* Write levels and signals, and put the sides that are held into the parameters. */
static int prepare(dynamics *d, double t, const double *x) {
  const whole count = d->n_levels;
  find_loads(d, t);
  for (whole g = 0; d->sided && g < d->n_holds; ++g)
    d->p[d->hold_index[g]] = d->sides[g] ? d->held_value : -d->held_value;
  if (!d->held && count) {
    if (find_course(d, x)) return 1;
    const double *tau = d->course, *rate = tau + count, *share = rate + count;
    for (whole i = 0; i < count; ++i) d->s[i] = isfinite(tau[i]) ? cell_of(tau[i], rate[i], share[i]) & 1 : NAN;
  }
  for (whole i = 0; d->held && i < count; ++i) d->s[i] = (double)(d->cells[i] & 1);
  return DONE;
}

EXPORTED int ltcgear_dynamics_rhs(dynamics *d, double t) {
  return prepare(d, t, d->x) || call(&d->rhs, d->x, d->s, d->p);
}

/* The Jacobian: its non-zeros column by column, and the same in their places of a matrix that is zero elsewhere. */
EXPORTED int ltcgear_dynamics_jac(dynamics *d, double t) {
  if (prepare(d, t, d->x) || call(&d->jac_rhs, d->x, d->s, d->p)) return 1;
  for (whole k = 0; k < d->n_entries; ++k) d->matrix[d->place_of[k]] = d->entries[k];
  return DONE;
}

/* The mesh phases under the load signals of a time. */
EXPORTED int ltcgear_dynamics_course(dynamics *d, double t) {
  find_loads(d, t);
  return find_course(d, d->x);
}

/* How far the state is from the borders, positive inside: indicators of regimes, and where the reference speed is free
 * what is left of the cells ahead and behind. */
EXPORTED int ltcgear_dynamics_borders(dynamics *d, double t) {
  const whole count = d->n_levels;
  double *ahead = d->distances + d->n_holds, *behind = ahead + count;
  if (prepare(d, t, d->x) || (d->n_holds && call(&d->borders, d->x, d->s, d->p))) return 1;
  for (whole g = 0; d->sided && g < d->n_holds; ++g)
    if (!d->sides[g]) d->distances[g] = -d->distances[g];
  if (!d->free || !d->held) return DONE;
  if (find_course(d, d->x)) return 1;
  for (whole i = 0; i < count; ++i) {
    double tau = d->course[i], share = d->course[2 * count + i];
    ahead[i] = upper(d->cells[i], share) - tau;
    behind[i] = tau - lower(d->cells[i], share);
  }
  return DONE;
}

/* Outputs at many times and states. */
EXPORTED int ltcgear_dynamics_outputs(dynamics *d, whole rows, const double *t, const double *x, double *y) {
  for (whole k = 0; k < rows; ++k, x += d->n, y += d->n_outputs) {
    if (prepare(d, t[k], x)) return 1;
    d->outputs.res[0] = y;
    if (call(&d->outputs, x, d->s, d->p)) return 1;
  }
  return DONE;
}

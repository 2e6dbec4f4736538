/* For integrators of other people: rates with everything held that would bend or jump, indicators that tell when that is
 * no longer right, and the events at which it changes. Both ways over a border it is passed a little late, by a margin in
 * which nothing else is felt than rounding: so what has just changed does not change back. */

#define ROUNDS 10 /* after a change, how often contacts are looked at again: one may open or close another */
#define SAME (64 * DBL_EPSILON) /* over the time: how far two times may differ by rounding */

/* The margin of a contact's border, and of a phase's [cycles]. */
static double margin(const march *m, whole g) { return larger(m->slack[g], DBL_MIN); }

/* Place a caller's states, less the whole turns that the clocks have taken up, and find levels and signals. */
static void pose_states(ltcgear_run *run, double time, const double *x) {
  march *m = &run->m;
  memcpy(m->x, x, (size_t)m->n * sizeof *x);
  if (m->angle >= 0) m->x[m->angle] -= TURN * (double)run->turns;
  for (whole i = 0; i < m->n_levels; ++i) m->s[i] = (double)(m->cells[i] & 1);
  for (whole i = 0; i < m->n_signals; ++i) m->s[m->n_levels + i] = m->signals[i] + m->slope[i] * (time - m->base);
}

/* Evaluate the mesh phases, their rates and shares at the states that were placed. */
static void find_now(march *m) {
  for (int i = 0; i < 3; ++i) m->phases.res[i] = m->now + i * m->n_levels;
  call(&m->phases, m->x, m->s, m->p);
}

/* Return a time, or the row of a table just ahead of it: a caller's clock may miss it by rounding. */
static double pass_knots(const ltcgear_run *run, double time) {
  double knot;
  while ((knot = knot_after(run, time)) <= time + SAME * fabs(time)) time = knot;
  return time;
}

/* Begin a leg, on which all loads are linear in time. */
static void begin_at(ltcgear_run *run, double time) {
  march *m = &run->m;
  m->base = pass_knots(run, time), m->knot = knot_after(run, m->base);
  signals_at(run, m->base, 1, m->signals);
  signal_rates(run, m->base, m->slope);
  for (whole i = 0; i < m->n_signals; ++i) {
    const course *imposed = run->courses + run->model->signal_table[i];
    if (imposed->rows >= 0) continue;
    if (run->model->signal_slope[i]) m->signals[i] = imposed->value[1];
  }
}

/* Go over to the cells of the phases; return how many borders were passed. */
static whole pass_borders(march *m) {
  const double *tau = m->now, *rate = m->now + m->n_levels, *share = m->now + 2 * m->n_levels;
  whole jumps = 0;
  for (whole i = 0; i < m->n_levels; ++i) {
    double half = at_border(tau[i]) / 2;
    if (tau[i] <= upper(m->cells[i], share[i]) + half && tau[i] >= lower(m->cells[i], share[i]) - half) continue;
    whole cell = cell_of(tau[i], rate[i], share[i]);
    jumps += llabs(cell - m->cells[i]);
    m->cells[i] = cell;
    m->s[i] = (double)(cell & 1);
  }
  m->events += jumps;
  return jumps;
}

/* Go over to the sides on which the contacts are; return whether any has changed. */
static int pass_sides(march *m) {
  int any = 0;
  seen(m, m->x, m->s, m->g_now);
  memcpy(m->new_sides, m->sides, (size_t)m->n_holds);
  for (whole g = 0; g < m->n_holds; ++g)
    if (m->g_now[g] < -margin(m, g) / 2) m->new_sides[g] ^= 1, any = 1;
  change_sides(m, m->new_sides);
  return any;
}

int ltcgear_rates(ltcgear_run *run, double time, const double *x, double *xdot) {
  if (!run->started) return NOT_STARTED;
  pose_states(run, time, x);
  run->rhs.res[0] = xdot;
  call(&run->rhs, run->m.x, run->m.s, run->m.p);
  return all_finite(run->m.n, xdot) ? DONE : NOT_FINITE;
}

int ltcgear_outputs(ltcgear_run *run, double time, const double *x, double *y) {
  if (!run->started) return NOT_STARTED;
  pose_states(run, time, x);
  run->output.res[0] = y;
  call(&run->output, run->m.x, run->m.s, run->m.p);
  add_cycles(run, y);
  return all_finite(run->model->n_outputs, y) ? DONE : NOT_FINITE;
}

ltcgear_whole ltcgear_indicator_count(const ltcgear_run *run) { return 2 * run->m.n_levels + run->m.n_holds; }

int ltcgear_indicators(ltcgear_run *run, double time, const double *x, double *z) {
  march *m = &run->m;
  if (!run->started) return NOT_STARTED;
  pose_states(run, time, x);
  find_now(m);
  const double *tau = m->now, *share = m->now + 2 * m->n_levels;
  for (whole i = 0; i < m->n_levels; ++i) {
    double near = at_border(tau[i]);
    z[2 * i] = upper(m->cells[i], share[i]) - tau[i] + near;
    z[2 * i + 1] = tau[i] - lower(m->cells[i], share[i]) + near;
  }
  double *borders = z + 2 * m->n_levels;
  seen(m, m->x, m->s, borders);
  for (whole g = 0; g < m->n_holds; ++g) borders[g] += margin(m, g);
  return all_finite(ltcgear_indicator_count(run), z) ? DONE : NOT_FINITE;
}

int ltcgear_update(ltcgear_run *run, double time, const double *x, int *changed) {
  march *m = &run->m;
  if (!run->started) return NOT_STARTED;
  begin_at(run, time);
  if (!all_finite(m->n, x)) return NOT_FINITE;
  pose_states(run, time, x);
  find_now(m);
  int any = pass_borders(m) > 0;
  for (int round = 0; round < ROUNDS && pass_sides(m); ++round) any = 1;
  if (changed) *changed = any;
  return DONE;
}

double ltcgear_next_knot(const ltcgear_run *run, double time) { return knot_after(run, pass_knots(run, time)); }

int ltcgear_impose(ltcgear_run *run, ltcgear_whole which, double value, double slope) {
  if (which < 0 || which >= run->model->n_tables) return NO_SUCH;
  if (!isfinite(value) || !isfinite(slope)) return NOT_A_NUMBER;
  course *c = run->courses + which;
  c->rows = -1; /* no rows at all: what reads tables finds the value, and no knot */
  c->value[0] = value, c->value[1] = slope;
  for (whole i = 0; i < run->m.n_signals; ++i) {
    if (run->model->signal_table[i] != which) continue;
    run->m.signals[i] = run->model->signal_slope[i] ? slope : value;
    run->m.slope[i] = 0;
  }
  return DONE;
}

ltcgear_whole ltcgear_regimes(const ltcgear_run *run) { return run->m.regimes; }

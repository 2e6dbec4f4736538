/* Clocks: whole turns are taken off the reference angle, and whole periods off all that follows it. Speed ratios of
 * gears are ratios of whole numbers, so nothing is lost. */

static double reference_angle(const march *m) {
  return m->angle < 0 ? 0 : m->origin[m->angle] + m->scale[m->angle] * m->z[m->angle];
}

/* Let a clock go on, or back, by one turn; return the whole cycles taken off it. */
static whole turn_clock(const ltcgear_clock *clock, whole *rest, int back) {
  whole gone = clock->cycles;
  if (back) {
    *rest -= clock->step;
    if (*rest < 0) *rest += clock->modulus, gone += clock->period;
    return -gone;
  }
  *rest += clock->step;
  if (*rest >= clock->modulus) *rest -= clock->modulus, gone += clock->period;
  return gone;
}

/* Put what the clocks have left into the parameters. */
static void set_clocks(ltcgear_run *run) {
  const ltcgear_clock *clock = run->model->clocks;
  for (whole c = 0; c < run->model->n_clocks; ++c) run->m.p[clock[c].start] = run->parameters[clock[c].start];
  for (whole c = 0; c < run->model->n_clocks; ++c)
    run->m.p[clock[c].start] += clock[c].unit * ((double)run->rest[c] / (double)clock[c].below);
}

/* Add the cycles that were taken off to the phases that are told. */
static void add_cycles(const ltcgear_run *run, double *y) {
  for (whole c = 0; c < run->model->n_clocks; ++c) {
    const ltcgear_clock *clock = run->model->clocks + c;
    if (clock->mesh_phase >= 0) y[clock->mesh_phase] += (double)run->cycles[c];
    if (clock->gear_phase >= 0) y[clock->gear_phase] += (double)run->cycles[c];
  }
}

static void take_turns_off(ltcgear_run *run) {
  march *m = &run->m;
  whole more = (whole)(reference_angle(m) / TURN * (1 + 4 * DBL_EPSILON));
  if (!more) return;
  for (whole c = 0; c < run->model->n_clocks; ++c) {
    const ltcgear_clock *clock = run->model->clocks + c;
    whole gone = 0;
    for (whole turn = 0; turn < llabs(more); ++turn) gone += turn_clock(clock, run->rest + c, more < 0);
    run->cycles[c] += gone;
    if (clock->level >= 0) m->cells[clock->level] -= 2 * gone, m->last_turn[clock->level] -= 2 * gone;
  }
  m->z[m->angle] -= TURN * (double)more / m->scale[m->angle];
  run->turns += more;
  set_clocks(run);
  hold(m);
}

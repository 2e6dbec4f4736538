/* A run under way: from knot to knot of the loads and from turn to turn of the reference. */

#define CAPACITY 512 /* samples that wait to be taken; no segment holds more than half of them */
#define PARTS 64     /* segments of a span whose weights fall to zero at its ends, at least */

/* Who takes samples, where, and what a march may go back to: the run as it was before the samples that wait. */
typedef struct {
  ltcgear_taker take;
  void *to;
  double *x;
  unsigned char *before;
} taker;

static int all_finite(whole count, const double *values) {
  for (whole i = 0; i < count; ++i)
    if (!isfinite(values[i])) return 0;
  return 1;
}

/* Tell the march how the loads run up to their next knot, or to a time before it. */
static void begin_leg(ltcgear_run *run, double until) {
  march *m = &run->m;
  take_turns_off(run);
  m->base = m->time, m->knot = smaller(knot_after(run, m->time), until);
  signals_at(run, m->base, 1, m->signals);
  signal_rates(run, m->base, m->slope);
  signals_at(run, m->knot, 0, m->signals_knot);
}

/* Evaluate the outputs of a state, whose angle lacks the turns taken off; the state decides on which sides contacts are. */
static int read_outputs(ltcgear_run *run, double time, const double *x, const double *levels, double *y) {
  const ltcgear_model *model = run->model;
  march *m = &run->m;
  memcpy(m->s_now, levels, (size_t)m->n_levels * sizeof *levels);
  signals_at(run, time, 1, m->s_now + m->n_levels);
  for (whole g = 0; g < m->n_holds; ++g) m->p[m->hold_index[g]] = 0;
  run->output.res[0] = y;
  call(&run->output, x, m->s_now, m->p);
  hold(m);
  add_cycles(run, y);
  return all_finite(model->n_outputs, y) ? DONE : NOT_FINITE;
}

/* Hand on the samples that wait; where that ends, ``last`` is the time of the sample. */
static int hand_on(ltcgear_run *run, const taker *t, double *last) {
  march *m = &run->m;
  for (whole k = 0; k < m->filled; ++k) {
    *last = m->sample_time[k];
    memcpy(t->x, m->sample_x + k * m->n, (size_t)m->n * sizeof *t->x);
    int fault = read_outputs(run, m->sample_time[k], t->x, m->sample_levels + k * m->n_levels, run->y);
    if (m->angle >= 0) t->x[m->angle] += TURN * (double)run->turns;
    if (fault) return fault;
    fault = t->take(t->to, m->sample_time[k], t->x, run->y);
    if (fault) return fault > 0 ? -fault : fault; /* no status of ours is negative */
  }
  m->filled = 0;
  return DONE;
}

/* Where a switching has ended an arc just before a time, by no more than samples are taken late, the arc has ended there;
 * what is missing is made up for with the next one. */
static void meet(march *m, double until) {
  double missing = until - m->time;
  if (!(missing > 0) || missing > lateness(m)) return;
  m->time = until, m->unpassed -= missing;
}

static int go_on(ltcgear_run *run, double until, const taker *t);

/* Go to a sample that was read off the way that the run has come: none after it is passed over. */
static void go_back(ltcgear_run *run, const taker *t, double sample) {
  pass_run(run, &(passage){t->before, 0, RESTORING});
  stop_sampling(&run->m);
  go_on(run, sample, 0);
}

/* Set how long segments may be: they hold no more samples than there is room for, and weights hardly change in one. Return
 * where the next one ends at the latest: where a span of weights begins, if it is so short that this counts. */
static double limit_segment(ltcgear_run *run, double until, const taker *t) {
  march *m = &run->m;
  const double part = m->summed == TAPERED ? (m->span_to - m->span_from) / PARTS : INFINITY;
  m->widest = LONGEST * TURNED / larger(run->quickest, SLOWEST);
  if (t) m->widest = smaller(m->widest, CAPACITY / 2 / m->sampling);
  if (m->time >= m->span_from) m->widest = smaller(m->widest, part);
  m->longest = smaller(m->longest, m->widest), m->first = smaller(m->first, m->widest);
  return m->time < m->span_from && m->longest > part ? m->span_from : until;
}

/* March to a time. */
static int go_on(ltcgear_run *run, double until, const taker *t) {
  march *m = &run->m;
  if (!run->started) return NOT_STARTED;
  if (!isfinite(until)) return NOT_A_NUMBER;
  if (until < m->time) return NOT_AHEAD;
  while (m->time < until) {
    double last, stop = limit_segment(run, until, t);
    if (t) pass_run(run, &(passage){t->before, 0, SAVING});
    begin_leg(run, stop);
    int fault = ltcgear_march(m, t ? LLONG_MAX : 1, INFINITY), taken = t ? hand_on(run, t, &last) : DONE;
    if (taken) go_back(run, t, last);
    if (taken || fault) return taken ? taken : fault;
    meet(m, stop);
  }
  return DONE;
}

int ltcgear_advance(ltcgear_run *run, double until) { return go_on(run, until, 0); }

int ltcgear_record(ltcgear_run *run, double until, double rate, ltcgear_taker take, void *to) {
  march *m = &run->m;
  const whole n = m->n;
  if (!run->started) return NOT_STARTED;
  if (!(rate > 0) || !isfinite(rate)) return NOT_AHEAD;
  const whole reals = CAPACITY * (n + m->n_levels + 2) + n;
  double *samples = malloc((size_t)reals * sizeof *samples + ltcgear_size(run));
  if (!samples) return NO_MEMORY;
  m->sample_x = samples + n, m->sample_levels = m->sample_x + CAPACITY * n;
  m->sample_time = m->sample_levels + CAPACITY * m->n_levels, m->sample_steps = m->sample_time + CAPACITY;
  m->capacity = CAPACITY, m->last = LLONG_MAX, m->sampling = rate, m->filled = 0;
  m->done = (whole)floor(m->time * rate * (1 + 1e-12)) + 1;
  int fault = go_on(run, until, &(taker){take, to, samples, (unsigned char *)(samples + reals)});
  stop_sampling(m);
  free(samples);
  return fault;
}

double ltcgear_time(const ltcgear_run *run) { return run->m.time; }

void ltcgear_state(const ltcgear_run *run, double *x) {
  const march *m = &run->m;
  for (whole i = 0; i < m->n; ++i) x[i] = m->origin[i] + m->scale[i] * m->z[i];
  if (m->angle >= 0) x[m->angle] += TURN * (double)run->turns;
}

int ltcgear_read(ltcgear_run *run, double *y) {
  march *m = &run->m;
  if (!run->started) return NOT_STARTED;
  place(m, m->z);
  for (whole i = 0; i < m->n_levels; ++i) m->gain[i] = (double)(m->arc_cells[i] & 1);
  return read_outputs(run, m->time, m->x, m->gain, y);
}

ltcgear_whole ltcgear_steps(const ltcgear_run *run) { return run->m.steps; }
ltcgear_whole ltcgear_switchings(const ltcgear_run *run) { return run->m.events; }

double ltcgear_expected_steps(const ltcgear_run *run, double seconds) { return seconds * run->quickest / REACH; }

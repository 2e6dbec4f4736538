/* Statistics of the mesh forces over a span of time: their sums along the motion (sums.c), and their extremes. */

/* Say whether a span lies ahead, and whether its instants can be told apart where that counts. */
static int fault_of_span(const ltcgear_run *run, double from, double until, int summed) {
  if (!run->started) return NOT_STARTED;
  if (!isfinite(from) || !isfinite(until)) return NOT_A_NUMBER;
  const double least = summed == TAPERED ? PARTS * DBL_EPSILON * larger(fabs(from), fabs(until)) : 0;
  return from >= run->m.time && until - from > least ? DONE : NOT_AHEAD;
}

/* March to the end of a span, and sum up over it. */
static int sum_up(ltcgear_run *run, double from, double until, int summed) {
  march *m = &run->m;
  memset(m->sums, 0, (size_t)(1 + 2 * m->n_forces) * sizeof *m->sums);
  for (whole i = 0; i < 2 * m->n_forces; ++i) m->steady[i] = NAN;
  m->span_from = from, m->span_to = until, m->summed = summed;
  int fault = go_on(run, until, 0);
  m->span_from = INFINITY, m->summed = NONE;
  return fault;
}

static int measure(ltcgear_run *run, double from, double until, int summed, ltcgear_statistics *of) {
  const march *m = &run->m;
  int fault = fault_of_span(run, from, until, summed);
  if (!fault) fault = sum_up(run, from, until, summed);
  for (whole i = 0; !fault && i < m->n_forces; ++i) {
    of[i].mean = m->sums[1 + i] / m->sums[0];
    of[i].rms = sqrt(larger(0.0, m->sums[1 + m->n_forces + i] / m->sums[0]));
    of[i].least = m->steady[i] + 0.0, of[i].most = m->steady[m->n_forces + i] + 0.0; /* no -0 */
  }
  return fault;
}

int ltcgear_measure(ltcgear_run *run, double until, ltcgear_statistics *of) {
  return measure(run, run->m.time, until, ALIKE, of);
}

int ltcgear_measure_steady(ltcgear_run *run, double from, double until, ltcgear_statistics *of) {
  return measure(run, from, until, TAPERED, of);
}

/* Sums of the mesh forces over a span of time, by the quadrature of the explicit method itself, as the work is: the forces
 * at its stages are there anyway. Momentum changes by the same sum, so a mean is as accurate as the motion. */

enum { NONE, ALIKE, TAPERED }; /* ``summed``: which instants of the span count, all alike or under weights */

/* The weight of an instant: 1, or sin(pi s)^4 as in averages.py. */
static double weight_at(const march *m, double time) {
  if (m->summed == ALIKE) return 1.0;
  double part = (time - m->span_from) / (m->span_to - m->span_from), root = sin(TURN / 2 * part);
  return part > 0 && part < 1 ? root * root * root * root : 0.0;
}

/* The forces where a step begins are those where the one before has ended. */
static void begin_step(march *m) { memcpy(m->stage_forces, m->forces, (size_t)m->n_forces * sizeof *m->forces); }

/* Begin an arc: its sums count only once it is sure that the motion goes along it. */
static void begin_sums(march *m) {
  memset(m->arc_sums, 0, (size_t)(1 + 2 * m->n_forces) * sizeof *m->arc_sums);
  begin_step(m);
}

/* Add a step, with the nodes and shares of the method, to the sums of weights, of the forces and of their squares. */
static void add_step(march *m, double start, double h, const double *node, const double *share) {
  const whole count = m->n_forces;
  double weight[STAGES], *restrict one = m->arc_sums + 1, *restrict two = one + count;
  for (int j = 0; j < STAGES - 1; ++j) {
    weight[j] = h * share[j] * weight_at(m, m->time + start + node[j] * h);
    m->arc_sums[0] += weight[j];
  }
  for (whole i = 0; i < count; ++i) {
    double sum = 0, square = 0;
    for (int j = 0; j < STAGES - 1; ++j) {
      double force = m->stage_forces[j * count + i], part = weight[j] * force;
      sum += part;
      square += part * force;
    }
    one[i] += sum, two[i] += square;
  }
  begin_step(m);
}

/* Keep what an arc has added. */
static void keep_sums(march *m) {
  for (whole i = 0; m->summed && i < 1 + 2 * m->n_forces; ++i) m->sums[i] += m->arc_sums[i];
}

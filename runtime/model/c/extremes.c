/* The smallest and largest mesh forces of a run, at the integrator's own points, both sides of every jump included. */

/* Begin an arc: its extremes count only once it is sure that the motion goes along it. */
static void begin_extremes(march *m) {
  m->seen = 0;
  for (whole i = 0; i < m->n_forces; ++i) {
    m->arc_lowest[i] = INFINITY;
    m->arc_steady[i] = m->arc_steady[m->n_forces + i] = NAN;
  }
}

static void note(march *m, whole i, double force, int steady) {
  m->arc_lowest[i] = fmin(m->arc_lowest[i], force);
  if (!steady) return;
  m->arc_steady[i] = fmin(m->arc_steady[i], force);
  m->arc_steady[m->n_forces + i] = fmax(m->arc_steady[m->n_forces + i], force);
}

/* The vertex of the parabola through three points, the middle one of which is the highest or lowest. */
static double vertex(const double *t, double one, double two, double three) {
  double before = t[1] - t[0], after = t[2] - t[1], left = (two - one) / before, right = (three - two) / after;
  double bend = (right - left) / (before + after), slope = (left * after + right * before) / (before + after);
  return bend != 0 ? two - slope * slope / (4 * bend) : two;
}

/* Take in the forces at a time after the arc's start, and the peak before them, if the last ones stood out. */
static void note_forces(march *m, double time) {
  const whole count = m->n_forces;
  double *t = m->seen_time, *one = m->seen_forces, *two = one + count;
  if (m->time + time > m->end * (1 + 1e-12)) return;
  t[2] = time;
  for (whole i = 0; i < count; ++i) {
    double force = m->forces[i];
    note(m, i, force, m->time + time >= m->span_from);
    if (m->seen >= 2 && (two[i] - one[i]) * (force - two[i]) < 0)
      note(m, i, vertex(t, one[i], two[i], force), m->time + t[1] >= m->span_from);
    one[i] = two[i], two[i] = force;
  }
  t[0] = t[1], t[1] = time;
  m->seen += 1;
}

/* Take in the forces at the nodes of an arc that an engine of Python's has integrated. */
static int note_nodes(march *m) {
  double power;
  begin_extremes(m);
  m->motion.res[0] = m->rate;
  m->motion.res[1] = &power;
  m->motion.res[2] = m->forces;
  for (whole j = 0; j < m->n_nodes; ++j) {
    find_signals(m, m->points[j] * m->reached, m->s_now);
    place(m, m->path + j * m->n);
    if (call(&m->motion, m->x, m->s_now, m->p)) return NOT_FINITE;
    note_forces(m, m->points[j] * m->reached);
  }
  return DONE;
}

/* Keep what an arc has shown. */
static void keep_extremes(march *m) {
  const whole count = m->n_forces;
  for (whole i = 0; i < count; ++i) {
    m->lowest[i] = fmin(m->lowest[i], m->arc_lowest[i]);
    m->steady[i] = fmin(m->steady[i], m->arc_steady[i]);
    m->steady[count + i] = fmax(m->steady[count + i], m->arc_steady[count + i]);
  }
}

/* One segment: to the next switching instant, border or knot; what it costs in energy; and its samples. */

#define TRIALS 30      /* how often a segment may be cut before it ends on a border */
#define STANDING 1e-6  /* speed over the largest of an arc below which a free train stands still */
#define FAR 1e12       /* times the size of vibrations: kilometres, for gears */

/* Put in the reference angle, which a held speed makes known: no tolerance then moves a switching. */
static void keep_on_course(march *m) {
  if (m->speed < 0 && !m->held) return;
  double *angle = m->path + m->angle;
  for (whole j = 0; j < m->n_nodes; ++j) {
    double t = m->points[j] * m->reached, turned = m->held_speed * t;
    if (!m->held) turned = m->s[m->n_levels + m->speed] * t + m->slope[m->speed] * t * t / 2;
    angle[j * m->n] = m->path[m->angle] + turned / m->scale[m->angle];
  }
}

/* Let an engine of Python's integrate. What breaks in before its first line leaves no answer that could be trusted, only
 * a duration that was not reached. */
static int ask(march *m, double duration) {
  m->reached = 0;
  m->advance(duration);
  return m->reached > 0 ? DONE : STOPPED;
}

/* Integrate for a duration with levels and sides held. */
static int integrate(march *m, double duration) {
  int fault = m->advance ? ask(m, duration) : advance_erk(m, duration);
  if (fault) return fault;
  m->segments += 1;
  keep_on_course(m);
  const double *end = m->path + (m->n_nodes - 1) * m->n;
  for (whole i = 0; i < m->n; ++i)
    if (!(fabs(end[i]) < FAR)) return UNBOUNDED;
  return m->advance ? note_nodes(m) : DONE;
}

/* Say whether a segment's nodes resolve its motion to the tolerance; longer and shorter ones follow from it. What a
 * polynomial through the nodes leaves out is about as large as its last terms. */
static int resolves(march *m) {
  const whole n = m->n, nodes = m->n_nodes;
  double error = 0, *one = m->trial, *two = m->y, *most = m->y_after;
  if (m->uniform) return 1;
  for (whole i = 0; i < n; ++i) one[i] = two[i] = 0, most[i] = 1.0;
  for (whole j = 0; j < nodes; ++j) {
    const double *z = m->path + j * n, before_last = m->last_terms[j], last = m->last_terms[nodes + j];
    for (whole i = 0; i < n; ++i) {
      one[i] += before_last * z[i];
      two[i] += last * z[i];
      most[i] = larger(most[i], fabs(z[i]));
    }
  }
  for (whole i = 0; i < n; ++i) error = larger(error, larger(fabs(one[i]), fabs(two[i])) / most[i]);
  error /= m->unresolved;
  double factor = smaller(larger(pow(0.1 / larger(error, 1e-12), 1 / (double)nodes), 0.25), 4.0);
  int resolved = error <= 1.0 || m->reached <= m->shortest;
  if (!resolved) factor = smaller(factor, 0.5);
  if (!resolved || m->reached > 0.99 * m->longest) {
    m->longest = smaller(larger(factor * m->reached, m->shortest), m->widest);
    if (m->fresh) m->first = m->longest;
  }
  return resolved;
}

/* The part of an arc before a free train turns back, so that it comes and goes in arcs of their own. */
static double standstill(const march *m) {
  if (m->free < 0 || !m->n_levels) return 1.0;
  double origin = m->origin[m->free], scale = m->scale[m->free], most = 0, before = 0;
  const double *z = m->path + m->free;
  for (whole j = 0; j < m->n_nodes; ++j) most = larger(most, fabs(origin + scale * z[j * m->n]));
  double still = larger(STANDING * most, m->rtol * scale), start = origin + scale * z[0];
  if (fabs(start) <= still) return 1.0;
  before = start;
  for (whole j = 1; j < m->n_nodes; ++j) {
    double speed = origin + scale * z[j * m->n], low = m->points[j - 1], high = m->points[j];
    if (start * speed < 0 && fabs(speed) > still) return low + (high - low) * before / (before - speed);
    before = speed;
  }
  return 1.0;
}

/* Integrate for a duration, or to the first border if that comes before, but never for longer than the most; cells after
 * it go to ``changed``, sides to ``new_sides``. */
static int go_to_border(march *m, double duration, double most) {
  int aimed = 0, at_once, fault;
  whole aims = 0;
  double first, correction;
  for (int trial = 0; trial < TRIALS; ++trial) {
    if ((fault = integrate(m, duration))) return fault;
    if (!resolves(m)) {
      duration = m->longest, aimed = 0;
      continue;
    }
    int met = duration == m->knot - m->time && m->reached == duration;
    for (whole i = 0; i < m->n_signals; ++i)
      m->signals_end[i] = met ? m->signals_knot[i] : m->s[m->n_levels + i] + m->slope[i] * m->reached;
    find_phases(m, m->path + (m->n_nodes - 1) * m->n, m->signals_end, m->after);
    double part = ltcgear_crossed(m->n_levels, m->cells, m->now, m->after, m->changed);
    if (aimed) {
      if ((fault = look_at_end(m, aims++, &correction))) return fault;
      if (correction == 0) return DONE;
      duration *= 1 + correction;
      if (duration > most) duration = most, aimed = 0; /* no knot may lie within an arc, and there is room for so much */
      continue;
    }
    part = smaller(part, standstill(m));
    if ((fault = cross(m, &first, &at_once))) return fault;
    if (at_once) {
      change_sides(m, m->new_sides);
      continue;
    }
    if (smaller(part, first) == 1.0) {
      if (m->reached < duration) return look_at_end(m, TRIALS, &correction); /* the engine has met a border */
      memcpy(m->new_sides, m->sides, (size_t)m->n_holds);
      return DONE;
    }
    aimed = first < part;
    duration = m->reached * smaller(part, first); /* go back to the segment's start with a shorter one */
  }
  return NOT_LOCATED;
}

/* Let time pass; what a late time rounds off is kept for the next (Kahan's sum), a knot is met exactly. */
EXPORTED void ltcgear_pass(march *m, double duration, double knot) {
  double before = m->time, due = duration + m->unpassed;
  int met = duration == knot - before;
  m->time = met ? knot : before + due;
  m->unpassed = met ? 0.0 : due - (m->time - before);
}

/* How late [s] after an arc's end a sample still is of the arc: by what rounding, and what counts as being at a border,
 * make of the instant of a jump. A sample that falls on a jump is then the one before it, on any processor. */
static double lateness(const march *m) {
  double rate = 0;
  for (whole i = 0; i < m->n_levels; ++i) rate = larger(rate, fabs(m->after[m->n_levels + i]));
  return smaller(2 * AT_BORDER * smaller(1 / rate, m->widest), 1e-3 * m->reached);
}

/* Read the samples that lie in the arc, its end included; steps are counted as if they were equally long in it. */
static int take_samples(march *m, double start) {
  double end = start + m->reached + lateness(m);
  for (; m->done <= m->last && (double)m->done / m->sampling <= end; ++m->done, ++m->filled) {
    double time = (double)m->done / m->sampling, *x = m->sample_x + m->filled * m->n;
    if (read_path(m, (time - start) / m->reached, x)) return BESIDE;
    for (whole i = 0; i < m->n; ++i) x[i] = m->origin[i] + m->scale[i] * x[i];
    m->sample_time[m->filled] = time;
    m->sample_steps[m->filled] = (double)m->began + (double)(m->steps - m->began) * (time - start) / m->reached;
    memcpy(m->sample_levels + m->filled * m->n_levels, m->s, (size_t)m->n_levels * sizeof *m->s);
  }
  return DONE;
}

/* Go over to the state at the arc's end. */
static int arrive(march *m) {
  const double start = m->time;
  int fault;
  keep_extremes(m);
  keep_sums(m);
  memcpy(m->arc_cells, m->cells, (size_t)m->n_levels * sizeof *m->cells);
  memcpy(m->arc_sides, m->sides, (size_t)m->n_holds);
  change_sides(m, m->new_sides);
  ltcgear_pass(m, m->reached, m->knot);
  m->work += m->node_work[m->n_nodes - 1];
  m->fresh = 0;
  memcpy(m->z, m->path + (m->n_nodes - 1) * m->n, (size_t)m->n * sizeof *m->z);
  find_signals(m, m->reached, m->s_end);
  if ((fault = take_samples(m, start)) || (fault = take_points(m, start))) return fault;
  change_cells(m, m->changed, m->s_end + m->n_levels);
  return DONE;
}

/* Integrate to the next switching instant or knot, to the end of the run at most. Where nothing switches or bends, the
 * last block of samples is finished even beyond the end. */
static int segment(march *m) {
  const whole count = m->n_levels;
  double *signals = m->s + count, most = m->longest;
  for (whole i = 0; i < m->n_signals; ++i) signals[i] = m->signals[i] + m->slope[i] * (m->time - m->base);
  find_phases(m, m->z, signals, m->now);
  most = smaller(most, m->knot - m->time);
  if (!m->uniform) most = smaller(most, m->end - m->time);
  turn_back(m, m->now);
  memset(m->gain, 0, (size_t)count * sizeof *m->gain);
  if (m->speed >= 0) {
    for (whole i = 0; i < m->n_signals; ++i) m->signals_end[i] = signals[i] + m->slope[i] * most;
    find_phases(m, m->z, m->signals_end, m->after);
    for (whole i = 0; i < count; ++i) m->gain[i] = (m->after[count + i] - m->now[count + i]) / most;
    stand(m, m->now, m->gain, signals);
  }
  for (whole i = 0; i < count; ++i) m->s[i] = (double)(m->cells[i] & 1);
  double duration = most;
  if (!m->finds_borders) duration = smaller(ltcgear_time_to_border(count, m->cells, m->now, m->gain), most);
  if (!(duration > 0)) return TOGETHER;
  m->began = m->steps;
  int fault = settle(m);
  if (!fault) fault = go_to_border(m, duration, most);
  return fault ? fault : arrive(m);
}

static double clock_now(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Say whether there is room for what another segment may leave. */
static int has_room(const march *m) { return 2 * m->filled + 4 <= m->capacity && 2 * m->pointed <= m->point_room; }

/* March on until the samples are complete or fill their block, the leg is over (a knot is met, the reference has turned
 * once), ``segments`` are done or the seconds are up. Returns DONE or a fault. */
EXPORTED int ltcgear_march(march *m, whole segments, double seconds) {
  double start = clock_now();
  for (whole i = 0; i < segments && m->done <= m->last && has_room(m); ++i) {
    int fault = segment(m);
    if (fault) return fault;
    double angle = m->angle < 0 ? 0 : m->origin[m->angle] + m->scale[m->angle] * m->z[m->angle];
    int over = m->time >= m->knot || fabs(angle) >= TURN * (1 - 4 * DBL_EPSILON);
    if (over || clock_now() - start > seconds) return DONE;
  }
  return DONE;
}

/* The explicit Runge-Kutta pair 5(4) of Tsitouras (Computers and Mathematics with Applications 62, 2011), with its dense
 * output of order 4, and the step control of Gustafsson (ACM Transactions on Mathematical Software 17, 1991). */

#define SMALLEST 1e-14 /* step over segment below which it gives up */

static const double NODE[STAGES] = {0.0, 0.161, 0.327, 0.9, 0.9800255409045097, 1.0, 1.0};
static const double A[STAGES][STAGES - 1] = {
    {0},
    {0.161},
    {-0.008480655492356989, 0.335480655492357},
    {2.8971530571054935, -6.359448489975075, 4.3622954328695815},
    {5.325864828439257, -11.748883564062828, 7.4955393428898365, -0.09249506636175525},
    {5.86145544294642, -12.92096931784711, 8.159367898576159, -0.071584973281401, -0.028269050394068383},
    {0.09646076681806523, 0.01, 0.4798896504144996, 1.379008574103742, -3.290069515436081, 2.324710524099774},
};
static const double WEIGHT[STAGES] = {
    0.09646076681806523, 0.01, 0.4798896504144996, 1.379008574103742, -3.290069515436081, 2.324710524099774, 0.0};
static const double MISS[STAGES] = {-0.001780011052225777, -0.0008164344596567469, 0.007880878010261995,
    -0.1447110071732629, 0.5823571654525552, -0.45808210592918697, 0.015151515151515152};
/* Rows: stages; columns: powers 1 to 4 of the part of a step. */
static const double DENSE[STAGES][4] = {
    {0.9999999999999999, -2.763706197274826, 2.9132554618219126, -1.0530884977290216},
    {0.0, 0.13169999999999998, -0.2234, 0.1017},
    {0.0, 3.930296236894751, -5.941033872131505, 2.490627285651253},
    {-0.0, -12.411077166933676, 30.33818863028232, -16.548102889244902},
    {0.0, 37.50931341651104, -88.1789048947664, 47.37952196281928},
    {-0.0, -27.896526289197286, 65.09189467479368, -34.87065786149661},
    {0.0, 1.5, -4.0, 2.5},
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
  if (m->summed) begin_sums(m);
  double step = m->step > 0 ? m->step : first_step(m, duration, y);
  int rejected = 0;
  while (t < duration) {
    double left = duration - t, parts = ceil(left / step - 1e-3), h = left / larger(parts, 1);
    int last = parts <= 1;
    if (!(h > SMALLEST * duration)) return TOO_SMALL;
    if (++steps > m->most_steps) return TOO_MANY;
    for (int j = 1; j < STAGES; ++j) {
      double *at = j == STAGES - 1 ? after : m->trial, *forces = m->summed ? m->stage_forces + j * m->n_forces : 0;
      if (j == STAGES - 1) forces = m->forces;
      combine(m, j, A[j], h, y, at);
      if (motion_at(m, t + NODE[j] * h, at, k + j * n, power + j, forces)) return NOT_FINITE;
    }
    combine(m, STAGES, MISS, h, m->zeros, m->trial);
    double gained = h * added(WEIGHT, power), missed = h * added(MISS, power);
    double error = larger(fabs(missed) / (m->rtol * (1 + fabs(work + gained))), size_of(m, m->trial, y, after));
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
    double factor = 0.9 * pow(larger(error, 1e-10), -0.7 / 5) * pow(before, 0.4 / 5);
    factor = smaller(rejected ? 1.0 : 5.0, larger(0.2, factor));
    before = larger(error, 1e-4);
    rejected = 0;
    /* A step that was shortened to divide what was left says nothing against the longer one. */
    step = h * factor < step && factor >= 1 ? step : h * factor;
    work += gained;
    if (m->summed) add_step(m, t, h, NODE, WEIGHT);
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

/* Regimes as discrete states: which side of every border holds, and where within an arc one is crossed. A border is a
 * zero of a generated indicator g (teeth that come to push, a race that is reached). While an arc is integrated its
 * sides are held, so that nothing bends within it; the first border that it crosses ends it. */

#define PATIENCE 6  /* trials after which an arc ends as near to its border as the integrator's errors allow */
#define AT_ONCE 1e-12 /* part of an arc that counts as its start */
#define NEAR 100.0  /* how far an indicator may be off where an integrator starts again, over its error */
#define SPLIT 16    /* parts of two fine intervals in which a crossing is bracketed */

/* Write the indicators of an unscaled state, positive on the side that holds. */
static void seen(march *m, const double *x, const double *s, double *out) {
  m->borders.res[0] = out;
  call(&m->borders, x, s, m->p);
  for (whole g = 0; g < m->n_holds; ++g) out[g] = m->sides[g] ? out[g] : -out[g];
}

static void inside(march *m, const double *z, const double *s, double *out) {
  place(m, z);
  seen(m, m->x, s, out);
}

/* Put the sides into the parameters. */
static void hold(march *m) {
  for (whole g = 0; g < m->n_holds; ++g) m->p[m->hold_index[g]] = m->sides[g] ? m->held_value : -m->held_value;
}

/* Go over to other sides of borders. */
static void change_sides(march *m, const unsigned char *sides) {
  for (whole g = 0; g < m->n_holds; ++g) {
    m->regimes += sides[g] != m->sides[g];
    m->sides[g] = sides[g];
  }
  hold(m);
}

/* Write how far indicators may be off by the errors of an integrator that starts again, at displacements z. */
static void find_noise(march *m, const double *z, double *out) {
  for (whole g = 0; g < m->n_holds; ++g) {
    double most = 0;
    for (whole i = 0; i < m->n; ++i) most = larger(most, m->error[i * m->n_holds + g] * larger(fabs(z[i]), 1.0));
    out[g] = NEAR * most;
  }
}

/* Write the rates of the signed indicators from a state on, by a difference over a short time. */
static int find_slopes(march *m, const double *z, const double *s, double *out) {
  double power, brief = INFINITY, *rate = m->rate;
  hold(m);
  place(m, z);
  m->motion.res[0] = rate;
  m->motion.res[1] = &power;
  m->motion.res[2] = 0;
  if (call(&m->motion, m->x, s, m->p)) return NOT_FINITE;
  for (whole i = 0; i < m->n; ++i) {
    rate[i] /= m->scale[i];
    brief = smaller(brief, larger(fabs(z[i]), 1.0) / larger(fabs(rate[i]), 1e-300));
  }
  double step = 1e-6 * brief;
  inside(m, z, s, m->g_now);
  for (whole i = 0; i < m->n; ++i) m->z_near[i] = z[i] + step * rate[i];
  inside(m, m->z_near, s, out);
  for (whole g = 0; g < m->n_holds; ++g) out[g] = (out[g] - m->g_now[g]) / step;
  return DONE;
}

/* Take the sides of the present state: those it has, unless it lies beyond a border, as after a jump. */
static int settle(march *m) {
  if (!m->n_holds) return DONE;
  int beyond = 0;
  inside(m, m->z, m->s, m->g_start);
  for (whole g = 0; g < m->n_holds; ++g) beyond |= m->g_start[g] < -m->slack[g];
  memcpy(m->new_sides, m->sides, (size_t)m->n_holds);
  if (beyond) {
    if (find_slopes(m, m->z, m->s, m->g_slope)) return NOT_FINITE;
    find_noise(m, m->z, m->g_noise);
    for (whole g = 0; g < m->n_holds; ++g) {
      double at = m->g_start[g];
      m->new_sides[g] ^= at < -m->slack[g] && (at < -m->g_noise[g] || m->g_slope[g] < 0);
    }
  }
  change_sides(m, m->new_sides);
  return DONE;
}

/* The signed indicator of one border at a part of the arc. */
static double distance_at(march *m, whole g, double part) {
  read_path(m, part, m->z_near);
  find_signals(m, part * m->reached, m->s_now);
  inside(m, m->z_near, m->s_now, m->g_now);
  return m->g_now[g];
}

/* Write the signed indicators at the fine points, lowest points between included, shape (FINE + 1, n_holds). */
static void find_distances(march *m) {
  const whole count = m->n_holds, nodes = m->n_nodes;
  double *fine = m->fine_values;
  for (whole j = 0; j < nodes; ++j) {
    find_signals(m, m->points[j] * m->reached, m->s_now);
    inside(m, m->path + j * m->n, m->s_now, m->node_values + j * count);
  }
  for (whole r = 0; r <= FINE; ++r)
    for (whole g = 0; g < count; ++g) {
      double sum = 0;
      for (whole j = 0; j < nodes; ++j) sum += m->fine[r * nodes + j] * m->node_values[j * count + g];
      fine[r * count + g] = sum;
    }
  for (whole g = 0; g < count; ++g) {
    double before = fine[g];
    for (whole r = 1; r < FINE; ++r) {
      double middle = fine[r * count + g], after = fine[(r + 1) * count + g];
      double bend = after - 2 * middle + before, slope = (after - before) / 2;
      if (bend > 0 && fabs(slope) <= bend / 2) fine[r * count + g] = middle - slope * slope / (2 * bend);
      before = middle;
    }
  }
}

/* A zero between two parts of the arc at which a border's distance has two signs: bisection with secants (Illinois). */
static double zero_between(march *m, whole g, double low, double high, double one, double two) {
  for (int trial = 0; trial < 200 && high - low > 1e-15 + 1e-14 * low; ++trial) {
    double middle = trial % 3 == 2 ? (low + high) / 2 : (low * two - high * one) / (two - one);
    middle = smaller(larger(middle, low), high);
    double value = distance_at(m, g, middle);
    if (value >= 0) {
      if (middle == low) break;
      low = middle, one = value, two /= 2;
    } else {
      if (middle == high) break;
      high = middle, two = value, one /= 2;
    }
  }
  return low;
}

/* The lowest point of a border's distance between two parts of the arc, by golden sections. */
static double lowest_between(march *m, whole g, double low, double high) {
  const double golden = 0.6180339887498949;
  double one = high - golden * (high - low), two = low + golden * (high - low);
  double at_one = distance_at(m, g, one), at_two = distance_at(m, g, two);
  for (int trial = 0; trial < 30; ++trial) {
    if (at_one < at_two) {
      high = two, two = one, at_two = at_one;
      one = high - golden * (high - low), at_one = distance_at(m, g, one);
    } else {
      low = one, one = two, at_one = at_two;
      two = low + golden * (high - low), at_two = distance_at(m, g, two);
    }
  }
  return (low + high) / 2;
}

/* The first zero before a row of the fine points, at whose dip the distance seems to be negative; beyond the arc (2)
 * where it is not: a motion that only grazes a border does not cross it. */
static double first_zero(march *m, whole g, whole row) {
  double part[SPLIT + 1], value[SPLIT + 1];
  int lowest = 0;
  for (int i = 0; i <= SPLIT; ++i) {
    part[i] = smaller(larger(((double)(row - 1) + i * 2.0 / SPLIT) / FINE, 0.0), 1.0);
    value[i] = distance_at(m, g, part[i]);
    if (value[i] < value[lowest]) lowest = i;
  }
  for (int i = 0; i < SPLIT; ++i)
    if (value[i] >= 0 && value[i + 1] < 0) return zero_between(m, g, part[i], part[i + 1], value[i], value[i + 1]);
  if (value[0] < 0) return part[0];
  double before = part[lowest > 0 ? lowest - 1 : 0], after = part[lowest < SPLIT ? lowest + 1 : SPLIT];
  double dip = lowest_between(m, g, before, after), depth = distance_at(m, g, dip);
  return depth < -m->slack[g] ? zero_between(m, g, before, dip, distance_at(m, g, before), depth) : 2.0;
}

/* Look where an arc crosses borders, once their distances are found: return the part before the first crossing. What
 * begins on a border and goes beyond is written to ``new_sides``. */
static double first_crossing(march *m, int *at_once) {
  const whole count = m->n_holds;
  double first = 1.0;
  for (whole g = 0; g < count; ++g) {
    int near = m->fine_values[g] <= m->slack[g], left = 0;
    double part = 2.0;
    for (whole r = 0; r <= FINE && part > 1; ++r) {
      double distance = m->fine_values[r * count + g];
      /* What has just crossed may seem to return by the errors of the path between the integrator's steps. */
      left |= fabs(distance) > m->g_noise[g];
      if (distance < -m->slack[g] && (!near || left)) part = first_zero(m, g, r);
    }
    first = smaller(first, part);
    /* From a border on which it rested, a motion may leave so slowly that no slope tells. */
    if (near && part <= AT_ONCE) m->new_sides[g] ^= 1, *at_once = 1;
  }
  return first;
}

/* Look for the first border that an arc crosses: write the part of the arc before it, 1 where none is crossed, and to
 * ``new_sides`` the sides at its start, others than those held where it begins on a border and goes beyond. */
static int cross(march *m, double *part, int *at_once) {
  const whole count = m->n_holds;
  int beyond = 0;
  *part = 1.0, *at_once = 0;
  if (!count) return DONE;
  memcpy(m->new_sides, m->sides, (size_t)count);
  find_distances(m);
  for (whole i = 0; i < (FINE + 1) * count; ++i) beyond |= m->fine_values[i] < -m->slack[i % count];
  if (!beyond) return DONE;
  if (find_slopes(m, m->path, m->s, m->g_slope)) return NOT_FINITE;
  for (whole g = 0; g < count; ++g) {
    int falls = m->fine_values[g] <= m->slack[g] && m->g_slope[g] < 0, crosses = 0;
    for (whole r = 0; falls && r <= FINE; ++r) crosses |= m->fine_values[r * count + g] < -m->slack[g];
    if (crosses) m->new_sides[g] ^= 1, *at_once = 1;
  }
  if (*at_once) return DONE;
  for (whole i = 0; i < m->n; ++i) {
    m->z_far[i] = 0;
    for (whole j = 0; j < m->n_nodes; ++j) m->z_far[i] = larger(m->z_far[i], fabs(m->path[j * m->n + i]));
  }
  find_noise(m, m->z_far, m->g_noise);
  *part = first_crossing(m, at_once);
  return DONE;
}

/* Look at the end of an arc that shall end on a border, as nearly as this trial asks for. Write by what part of the arc
 * it is too short (negative where it is too long), and to ``new_sides`` the sides after it: all borders change sides at
 * which it ends and towards which it goes. */
static int look_at_end(march *m, whole trial, double *correction) {
  const whole count = m->n_holds;
  double *z = m->path + (m->n_nodes - 1) * m->n, least = INFINITY;
  whole which = -1;
  *correction = 0;
  memcpy(m->new_sides, m->sides, (size_t)count);
  if (!count) return DONE;
  find_signals(m, m->reached, m->s_end);
  inside(m, z, m->s_end, m->g_start);
  if (find_slopes(m, z, m->s_end, m->g_slope)) return NOT_FINITE;
  for (whole g = 0; g < count; ++g) {
    double reach = fabs(m->g_start[g]) / m->slack[g];
    if (m->g_slope[g] < 0 && (reach < least || which < 0)) least = reach, which = g;
  }
  if (which < 0) return DONE;
  find_noise(m, z, m->g_noise);
  for (whole g = 0; g < count; ++g) {
    double noise = larger(m->g_noise[g] / m->slack[g], 1.0);
    m->g_noise[g] = m->slack[g] * pow(noise, smaller((double)trial / PATIENCE, 1.0));
  }
  if (fabs(m->g_start[which]) > m->g_noise[which]) {
    *correction = smaller(larger(-m->g_start[which] / m->g_slope[which] / m->reached, -0.1), 0.1);
    return DONE;
  }
  for (whole g = 0; g < count; ++g) m->new_sides[g] ^= m->g_slope[g] < 0 && fabs(m->g_start[g]) <= m->g_noise[g];
  return DONE;
}

/* The integration of a gearbox that ltcgear has turned into C, see ltcgear.h; the same for all scenes. */
#define EXPORTED static
#ifndef _POSIX_C_SOURCE
#define _POSIX_C_SOURCE 199309L /* a clock that nobody sets */
#endif
#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#ifndef EXPORTED
#define EXPORTED __attribute__((visibility("default")))
#endif
#define STAGES 7
#define FINE 64
#define AT_BORDER 1e-09 /* how close to a border [cycles] counts as being there, besides rounding */

typedef long long whole;
typedef int (*generated)(const double **arg, double **res, whole *iw, double *w, int mem);
typedef struct {
  generated run;
  const double **arg;
  double **res;
  whole *iw;
  double *w;
} function;

typedef struct {
  whole n;
  whole n_levels;
  whole n_signals;
  whole n_holds;
  whole n_nodes;
  whole n_forces;
  whole angle;
  whole speed;
  whole free;
  whole held;
  whole uniform;
  whole finds_borders;
  whole last;
  whole capacity;
  whole most_steps;
  whole most_points;
  whole point_room;
  whole summed;
  double rtol;
  double shortest;
  double widest;
  double unresolved;
  double held_speed;
  double held_value;
  double end;
  double sampling;
  double turning;
  double passing;
  double span_from;
  double span_to;
  double *origin;
  double *scale;
  double *points;
  double *last_terms;
  double *weights;
  double *fine;
  double *error;
  double *slack;
  double *zeros;
  double *rule_at;
  double *rule_weight;
  double *rule_motion;
  double *rule_filter;
  whole *hold_index;
  function motion;
  function phases;
  function borders;
  function energy;
  void (*advance)(double);
  double knot;
  double base;
  double *signals;
  double *signals_knot;
  double *slope;
  whole fresh;
  whole expected;
  whole steps;
  whole rhs;
  whole jacobian;
  whole rejected;
  whole segments;
  whole events;
  whole regimes;
  double time;
  double unpassed;
  double work;
  double jump_energy;
  double longest;
  double first;
  double step;
  double *z;
  double *p;
  double *heading;
  double *lowest;
  double *steady;
  whole *cells;
  whole *last_turn;
  unsigned char *sides;
  whole done;
  whole filled;
  whole pointed;
  whole seen;
  whole began;
  double reached;
  double *sample_x;
  double *sample_time;
  double *sample_levels;
  double *sample_steps;
  double *s;
  double *path;
  double *node_work;
  double *x;
  double *y;
  double *y_after;
  double *trial;
  double *point_x;
  double *point_time;
  double *point_weight;
  double *point_levels;
  double *stages;
  double *power;
  double *rate;
  double *balance;
  double *forces;
  double *seen_time;
  double *seen_forces;
  double *arc_lowest;
  double *arc_steady;
  double *stage_forces;
  double *arc_sums;
  double *sums;
  double *now;
  double *after;
  double *ahead;
  double *gain;
  double *s_now;
  double *s_end;
  double *signals_end;
  double *z_near;
  double *z_far;
  double *g_now;
  double *g_start;
  double *g_slope;
  double *g_noise;
  double *node_values;
  double *fine_values;
  whole *changed;
  whole *arc_cells;
  unsigned char *new_sides;
  unsigned char *arc_sides;
} march;

/* The march: an integration under way, segment by segment of smooth motion between switching instants. This text is
 * compiled once; all that belongs to a model comes by pointers. The structure ``march`` stands before it, written from
 * the one list of its fields. */

#define TURN 6.283185307179586

enum { DONE, NOT_FINITE, TOO_SMALL, TOO_MANY, TOGETHER, NOT_LOCATED, BESIDE, UNBOUNDED, STOPPED };

/* The larger and the smaller of two; the second one where either is no number. */
static double larger(double one, double two) { return one > two ? one : two; }

static double smaller(double one, double two) { return one < two ? one : two; }

static double sign(double value) { return (double)((value > 0) - (value < 0)); }

/* Evaluate a generated function of (x, s, p) into the results it is bound to. */
static int call(function *f, const double *x, const double *s, const double *p) {
  f->arg[0] = x, f->arg[1] = s, f->arg[2] = p;
  return f->run(f->arg, f->res, f->iw, f->w, 0);
}

/* Write the state at displacements z. */
static void place(march *m, const double *z) {
  for (whole i = 0; i < m->n; ++i) m->x[i] = m->origin[i] + m->scale[i] * z[i];
}

/* Read the path at a part of its duration, by barycentric interpolation through its nodes (Berrut and Trefethen 2004).
 * Where nodes are samples, nothing lies between them. */
static int read_path(const march *m, double part, double *z) {
  double sum = 0;
  memset(z, 0, (size_t)m->n * sizeof *z);
  for (whole j = 0; j < m->n_nodes; ++j) {
    double gap = part - m->points[j];
    if (fabs(gap) < (m->uniform ? 1e-6 / (double)(m->n_nodes - 1) : 1e-14)) {
      memcpy(z, m->path + j * m->n, (size_t)m->n * sizeof *z);
      return DONE;
    }
    double weight = m->uniform ? 0.0 : m->weights[j] / gap;
    sum += weight;
    for (whole i = 0; i < m->n; ++i) z[i] += weight * m->path[j * m->n + i];
  }
  if (m->uniform) return BESIDE;
  for (whole i = 0; i < m->n; ++i) z[i] /= sum;
  return DONE;
}

/* Write levels and signals at a time after the segment's start. */
static void find_signals(march *m, double time, double *out) {
  for (whole i = 0; i < m->n_levels; ++i) out[i] = m->s[i];
  for (whole i = 0; i < m->n_signals; ++i) out[m->n_levels + i] = m->s[m->n_levels + i] + m->slope[i] * time;
}

/* Mesh levels as discrete states: a phase tau is in cell 2 n while n <= tau < n + share (single contact, level 0) and
 * in cell 2 n + 1 until n + 1 (double contact, level 1), eqs 9-11. Phases are three rows: tau, rate, share. */

static double at_border(double tau) { return AT_BORDER + 16 * DBL_EPSILON * fabs(tau); }

static double lower(whole cell, double share) {
  whole odd = cell & 1;
  return (double)((cell - odd) / 2) + (odd ? share : 0.0);
}

static double upper(whole cell, double share) { return lower(cell + 1, share); }

/* The cell of a phase; at a border, the cell it is entering. */
static whole cell_of(double tau, double rate, double share) {
  double near = at_border(tau), base = floor(tau + near);
  whole cell = 2 * (whole)base + (tau - base >= share - near);
  return cell - (rate < 0 && fabs(tau - lower(cell, share)) <= near);
}

/* The time [s] to the next border, infinite where none is reached; the rates change by gain [1/s^2]. Borders are looked
 * for in the present direction, from a standstill in that of the gain: what turns back on its way is to be looked at
 * again from where it turns. */
EXPORTED double ltcgear_time_to_border(whole count, const whole *cells, const double *now, const double *gain) {
  const double *tau = now, *rate = now + count, *share = now + 2 * count;
  double first = INFINITY;
  for (whole i = 0; i < count; ++i) {
    double towards = sign(rate[i] != 0 ? rate[i] : gain[i]);
    double border = towards > 0 ? upper(cells[i], share[i]) : lower(cells[i], share[i]);
    double ahead = towards * (border - tau[i]), speed = towards * rate[i];
    double square = speed * speed + 2 * towards * gain[i] * ahead;
    if (towards != 0 && square >= 0) first = smaller(first, 2 * ahead / (speed + sqrt(square)));
  }
  return larger(first, 0.0);
}

/* Write the cells after a step, and return the part of the step in which the first border is reached: 1 unless a phase
 * has gone beyond its border, by linear interpolation then. All phases that stand at a border together (planets in
 * phase) switch together. */
EXPORTED double ltcgear_crossed(
    whole count, const whole *cells, const double *before, const double *after, whole *changed) {
  const double *tau = after, *rate = after + count, *share = after + 2 * count;
  double part = 1.0;
  for (whole i = 0; i < count; ++i) {
    double near = at_border(tau[i]), top = upper(cells[i], share[i]), bottom = lower(cells[i], share[i]);
    changed[i] = cells[i] + (tau[i] >= top - near && rate[i] > 0) - (tau[i] <= bottom + near && rate[i] < 0);
    if (tau[i] > top + near || tau[i] < bottom - near) {
      double border = tau[i] > top ? top : bottom;
      part = smaller(part, smaller(larger((border - before[i]) / (tau[i] - before[i]), 0.01), 0.999999999));
    }
  }
  if (part < 1.0) memcpy(changed, cells, (size_t)count * sizeof *cells);
  return part;
}

/* Evaluate the phases of a state under some load signals. */
static void find_phases(march *m, const double *z, const double *signals, double *out) {
  whole count = m->n_levels;
  place(m, z);
  for (whole i = 0; i < count; ++i) m->s_now[i] = 0.0;
  for (whole i = 0; i < m->n_signals; ++i) m->s_now[count + i] = signals[i];
  for (int i = 0; i < 3; ++i) m->phases.res[i] = out + i * count;
  call(&m->phases, m->x, m->s_now, m->p);
}

/* Return the cell of a mesh by kinematics; on a border that of the march, whether or not it has left its last one. */
static whole counted(const march *m, const double *now, whole i) {
  whole count = m->n_levels, cell = m->cells[i];
  double tau = now[i], rate = now[count + i], share = now[2 * count + i];
  double beside = smaller(fabs(tau - lower(cell, share)), fabs(tau - upper(cell, share)));
  return (rate == 0 || m->free >= 0) && beside <= at_border(tau) ? cell : cell_of(tau, rate, share);
}

/* Book the switchings that kinematics calls for since the last standstill, and begin to count anew from here. */
static void take_stock(march *m, const double *now) {
  for (whole i = 0; i < m->n_levels; ++i) {
    whole cell = counted(m, now, i);
    m->expected += llabs(cell - m->last_turn[i]);
    m->last_turn[i] = cell;
  }
}

/* Note the cells where a free train has turned back. */
static void turn_back(march *m, const double *now) {
  const double *rate = now + m->n_levels;
  int turned = 0;
  for (whole i = 0; i < m->n_levels; ++i) turned |= sign(rate[i]) * m->heading[i] < 0;
  if (m->free >= 0 && turned) take_stock(m, now);
  for (whole i = 0; i < m->n_levels; ++i) m->heading[i] = rate[i] == 0 ? m->heading[i] : sign(rate[i]);
}

/* The energy [J], weight included, of a state with some cells. */
static double energy_of(march *m, const double *z, const whole *cells, const double *signals) {
  whole count = m->n_levels;
  place(m, z);
  for (whole i = 0; i < count; ++i) m->s_now[i] = (double)(cells[i] & 1);
  for (whole i = 0; i < m->n_signals; ++i) m->s_now[count + i] = signals[i];
  call(&m->energy, m->x, m->s_now, m->p);
  return m->balance[0] + m->balance[1] + m->balance[2];
}

/* Go over to other cells, and book what the stiffness jumps put in. */
static void change_cells(march *m, const whole *cells, const double *signals) {
  whole jumps = 0;
  for (whole i = 0; i < m->n_levels; ++i) jumps += llabs(cells[i] - m->cells[i]);
  if (!jumps) return;
  m->jump_energy += energy_of(m, m->z, cells, signals) - energy_of(m, m->z, m->cells, signals);
  m->events += jumps;
  memcpy(m->cells, cells, (size_t)m->n_levels * sizeof *cells);
  m->longest = smaller(m->first, m->longest);
  m->fresh = 1;
}

/* At a standstill, note the cells, and leave those at whose border it stands in the direction ahead. */
static void stand(march *m, double *now, const double *gain, const double *signals) {
  whole count = m->n_levels;
  for (whole i = 0; i < count; ++i)
    if (now[count + i] != 0) return;
  take_stock(m, now);
  memcpy(m->ahead, now, (size_t)(3 * count) * sizeof *now);
  memcpy(m->ahead + count, gain, (size_t)count * sizeof *gain);
  ltcgear_crossed(count, m->cells, m->ahead, m->ahead, m->changed);
  for (whole i = 0; i < count; ++i) {
    m->expected += llabs(m->changed[i] - m->cells[i]);
    m->last_turn[i] += m->changed[i] - m->cells[i];
  }
  change_cells(m, m->changed, signals);
}

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

/* Points of an arc at which its outputs are read, with the weights of Lobatto's rule: sums over them are integrals over
 * time of the motion itself, jumps included, whatever the sampling rate. */

/* Write the state at a part of an arc, and note its time and weight. */
static int take_point(march *m, double start, double part, double weight) {
  double *x = m->point_x + m->pointed * m->n;
  if (read_path(m, part, x)) return BESIDE;
  for (whole i = 0; i < m->n; ++i) x[i] = m->origin[i] + m->scale[i] * x[i];
  m->point_time[m->pointed] = start + part * m->reached;
  m->point_weight[m->pointed] = weight * m->reached;
  memcpy(m->point_levels + m->pointed * m->n_levels, m->s, (size_t)m->n_levels * sizeof *m->s);
  m->pointed += 1;
  return DONE;
}

/* Take the nodes of a block as points: nothing bends in it, and the trapezoidal rule serves. */
static int take_nodes(march *m, double start) {
  const whole last = m->n_nodes - 1;
  const double room = (m->end - start) * (1 + 1e-12);
  for (whole j = 0; j <= last && m->points[j] * m->reached <= room; ++j) {
    int inner = j > 0 && j < last && m->points[j + 1] * m->reached <= room;
    if (take_point(m, start, m->points[j], (inner ? 1.0 : 0.5) / (double)last)) return BESIDE;
  }
  return DONE;
}

/* Take the points of an arc, its ends included. Each panel of it has the fewest that resolve both the motion, to a
 * millionth, and the motion under the filter, to a thousandth: ``rule_motion`` and ``rule_filter`` are the largest angles
 * by which the fastest of both may turn in half a panel, by number of points from two on. */
static int take_points(march *m, double start) {
  const whole most = m->most_points;
  if (!most) return DONE;
  if (m->uniform) return take_nodes(m, start);
  double motion = smaller(m->turning * m->reached, (double)m->n_nodes) / 2, filter = motion + m->passing * m->reached / 2;
  double panels = ceil(larger(1.0, larger(motion / m->rule_motion[most - 2], filter / m->rule_filter[most - 2])));
  whole count = 2;
  while (count < most && larger(motion / m->rule_motion[count - 2], filter / m->rule_filter[count - 2]) > panels) ++count;
  const whole first = count * (count - 1) / 2 - 1;
  for (double panel = 0; panel < panels; ++panel)
    for (whole k = first; k < first + count; ++k)
      if (take_point(m, start, (panel + m->rule_at[k]) / panels, m->rule_weight[k] / panels)) return BESIDE;
  return DONE;
}

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

#include "ltcgear.h"

#define SHORTEST 0.015625
#define LONGEST 4096.0
#define FINEST 1e-09
#define MOST_STEPS 1000000.0
#define SLACK 0.1
#define HELD 1e+30
#define LOADED 1e-09
#define UNLOADED 1e-06
#define ROUNDED 1e-08
#define SETTLED 1e-14
#define LOOSENESS 8.881784197001252e-16
#define OPENNESS 1e-09
#define FIRST_PART 0.25
#define SMALLEST_PART 1e-10
#define PART_GROWTH 4.0
#define REACH 3.5
#define KEPT_NUMBERS(X) X(fresh) X(expected) X(steps) X(rhs) X(jacobian) X(rejected) X(segments) X(events) X(regimes) X(time) X(unpassed) X(work) X(jump_energy) X(longest) X(first) X(step)
static const char *const FAULT[] = {
    "",
    "a value is not finite",
    "the step size fell below what the time can tell apart",
    "too many steps in a segment",
    "two switching instants of one mesh fall together; check its contact ratio",
    "a switching instant could not be located",
    "samples lie beside the nodes of a block that was cut",
    "the motion grows without bound",
    "an engine stopped",
};

/* A run: the march of one simulation with all its memory, in one block. */

#define COUNT 16   /* intervals between the nodes of a segment */
#define TURNED 8.0 /* angle [rad] by which the fastest mode may turn in a first segment */
#define SLOWEST 1e-6 /* how fast it swings at least [1/s] */

/* What may go wrong besides the faults of a march, in the order of their texts. */
enum {
  NOT_STARTED = STOPPED + 1, HAS_STARTED, NO_SUCH, FIXED, NOT_A_NUMBER, NOT_POSITIVE, NEGATIVE, NO_SHARE, NOT_AHEAD,
  NO_MEMORY, NO_FREEDOM, LOOSE, OVERLAPPING, UNSETTLED, FOREIGN, DAMAGED, STATUSES
};
static const char *const REASON[] = {
    "the run has not been started",
    "the run has been started; parameters are set before that",
    "there is no such parameter or table",
    "this parameter follows from the structure of the gearbox: change the scene and generate its C again",
    "the value is not finite",
    "a mass or an inertia must be positive",
    "a stiffness or a damping must not be negative",
    "a share must lie between 0 and 1",
    "the time lies behind, or there is no time or sample up to it",
    "there is no memory left",
    "nothing can vibrate: every freedom of the scene is held",
    "no equilibrium: nothing holds a member against the loads",
    "no equilibrium: a centre distance falls below the base circles' sum",
    "no equilibrium was found; check parameters and loads",
    "these are not the bytes of a run of this model",
    "the bytes of the run are damaged",
};

/* A table that is steered: its own rows. */
typedef struct {
  double time[3], value[3];
  whole rows; /* 0: the model's */
} course;

struct ltcgear_run {
  const ltcgear_model *model;
  march m;
  function rhs, jacobian, output;
  double *parameters;              /* the user's, at reference angle 0 */
  course *courses;
  whole *rest, *cycles;            /* of each clock: what is left of its advance, and whole cycles taken off it */
  whole turns, started;            /* turns taken off the reference angle */
  double quickest;                 /* how fast the fastest mode swings [1/s] */
  double *y;
};

/* Room that is given away from front to back; only counted where there is none. */
typedef struct {
  char *front;
  size_t used;
} room;

static void *take(room *r, whole count, size_t size) {
  void *place = r->front ? r->front + r->used : 0;
  r->used += ((size_t)count * size + 7) / 8 * 8;
  return place;
}

static double *reals(room *r, whole count) { return take(r, count, sizeof(double)); }
static whole *wholes(room *r, whole count) { return take(r, count, sizeof(whole)); }
static unsigned char *bytes(room *r, whole count) { return take(r, count, 1); }

#define EACH(type, give, count, ...) \
  do { \
    type **const list[] = {__VA_ARGS__}; \
    for (size_t each = 0; each < sizeof list / sizeof *list; ++each) *list[each] = give(r, count); \
  } while (0)

static void bind(room *r, function *f, const ltcgear_code *code) {
  whole arg = 0, res = 0, iw = 0, w = 0;
  code->room(&arg, &res, &iw, &w);
  f->run = code->run;
  f->arg = take(r, arg, sizeof *f->arg);
  f->res = take(r, res, sizeof *f->res);
  f->iw = wholes(r, iw);
  f->w = reals(r, w);
}

/* Give all arrays of a run their places. */
static void lay_out(ltcgear_run *run, room *r) {
  const ltcgear_model *model = run->model;
  const whole n = model->n_states, meshes = model->n_levels, loads = model->n_signals, holds = model->n_holds;
  const whole nodes = COUNT + 1, forces = model->n_forces;
  march *m = &run->m;
  EACH(double, reals, n, &m->z, &m->origin, &m->scale, &m->zeros, &m->x, &m->y, &m->y_after, &m->trial, &m->rate);
  EACH(double, reals, n, &m->z_near, &m->z_far);
  EACH(double, reals, nodes, &m->points, &m->weights, &m->node_work);
  EACH(double, reals, 3 * meshes, &m->now, &m->after, &m->ahead);
  EACH(double, reals, meshes, &m->gain, &m->heading);
  EACH(double, reals, meshes + loads, &m->s, &m->s_now, &m->s_end);
  EACH(double, reals, loads, &m->signals, &m->signals_knot, &m->slope, &m->signals_end);
  EACH(double, reals, holds, &m->slack, &m->g_now, &m->g_start, &m->g_slope, &m->g_noise);
  EACH(double, reals, forces, &m->forces, &m->lowest, &m->arc_lowest);
  EACH(double, reals, 2 * forces, &m->steady, &m->arc_steady, &m->seen_forces);
  EACH(double, reals, model->n_parameters, &m->p, &run->parameters);
  m->last_terms = reals(r, 2 * nodes), m->path = reals(r, nodes * n), m->stages = reals(r, STAGES * n);
  m->fine = reals(r, holds ? (FINE + 1) * nodes : 0), m->fine_values = reals(r, (FINE + 1) * holds);
  m->error = reals(r, n * holds), m->node_values = reals(r, nodes * holds);
  m->power = reals(r, STAGES), m->balance = reals(r, 5), m->seen_time = reals(r, 3);
  m->stage_forces = reals(r, STAGES * forces), m->sums = reals(r, 1 + 2 * forces), m->arc_sums = reals(r, 1 + 2 * forces);
  run->y = reals(r, model->n_outputs);
  EACH(whole, wholes, meshes, &m->cells, &m->last_turn, &m->changed, &m->arc_cells);
  EACH(whole, wholes, model->n_clocks, &run->rest, &run->cycles);
  EACH(unsigned char, bytes, holds, &m->sides, &m->new_sides, &m->arc_sides);
  run->courses = take(r, model->n_tables, sizeof *run->courses);
  bind(r, &m->motion, &model->motion), bind(r, &m->phases, &model->phases), bind(r, &m->borders, &model->borders);
  bind(r, &m->energy, &model->energy), bind(r, &run->rhs, &model->rhs), bind(r, &run->jacobian, &model->jacobian);
  bind(r, &run->output, &model->output);
  if (r->front) m->energy.res[0] = m->balance;
}

/* Set the nodes of a segment: Chebyshev points, the weights of Berrut and Trefethen (2004), what takes values to their
 * last two coefficients, and to values at fine points. */
static void set_nodes(march *m) {
  const whole nodes = COUNT + 1;
  m->n_nodes = nodes;
  for (whole j = 0; j < nodes; ++j) {
    int end = j == 0 || j == COUNT;
    double turned = TURN / 2 * (double)j / COUNT;
    m->points[j] = (1 - cos(turned)) / 2;
    m->weights[j] = (j % 2 ? -1.0 : 1.0) / (end ? 2 : 1);
    m->last_terms[j] = cos((COUNT - 1) * turned) * (2.0 / COUNT) / (end ? 2 : 1);
    m->last_terms[nodes + j] = cos(COUNT * turned) * (1.0 / COUNT) / (end ? 2 : 1);
  }
  for (whole r = 0; m->n_holds && r <= FINE; ++r) {
    double part = (double)r / FINE, sum = 0, *row = m->fine + r * nodes;
    whole hit = -1;
    for (whole j = 0; j < nodes; ++j)
      if (fabs(part - m->points[j]) < 1e-14) hit = j;
    for (whole j = 0; j < nodes; ++j) {
      row[j] = hit < 0 ? m->weights[j] / (part - m->points[j]) : j == hit;
      sum += row[j];
    }
    for (whole j = 0; j < nodes; ++j) row[j] /= sum;
  }
}

/* Take no samples: the next one lies beyond all times. */
static void stop_sampling(march *m) { m->capacity = 8, m->filled = 0, m->last = m->done = 1, m->sampling = DBL_MIN; }

/* Set sizes, places, and what no parameter changes. */
static void set_sizes(ltcgear_run *run, double rtol) {
  const ltcgear_model *model = run->model;
  march *m = &run->m;
  m->n = model->n_states, m->n_levels = model->n_levels, m->n_signals = model->n_signals, m->n_holds = model->n_holds;
  m->n_forces = model->n_forces, m->angle = model->angle, m->free = model->free_speed;
  m->speed = model->speed_signal, m->held = model->speed_held;
  m->hold_index = (whole *)model->holds; /* which is only read */
  m->end = m->span_from = INFINITY;
  stop_sampling(m);
  m->rtol = rtol, m->unresolved = larger(rtol, FINEST);
  m->held_value = HELD, m->most_steps = MOST_STEPS;
  set_nodes(m);
}

ltcgear_run *ltcgear_create(const ltcgear_model *model, double rtol) {
  ltcgear_run counted = {.model = model}, *run;
  room count = {0, (sizeof *run + 7) / 8 * 8};
  if (!(rtol >= 1e-13 && rtol <= 0.1)) return 0;
  lay_out(&counted, &count);
  run = calloc(1, count.used);
  if (!run) return 0;
  run->model = model;
  lay_out(run, &(room){(char *)run, (sizeof *run + 7) / 8 * 8});
  set_sizes(run, rtol);
  memcpy(run->parameters, model->parameter_values, (size_t)model->n_parameters * sizeof(double));
  return run;
}

void ltcgear_destroy(ltcgear_run *run) { free(run); }

/* What is wrong with a parameter's value. */
static int fault_of(const ltcgear_model *model, whole parameter, double value) {
  const double least = model->parameter_least[parameter], most = model->parameter_most[parameter];
  if (!isfinite(value)) return NOT_A_NUMBER;
  if (value >= least && value <= most) return DONE;
  if (most < 1) return NO_SHARE;
  return least > 0 ? NOT_POSITIVE : NEGATIVE;
}

int ltcgear_set(ltcgear_run *run, ltcgear_whole parameter, double value) {
  const ltcgear_model *model = run->model;
  if (run->started) return HAS_STARTED;
  if (parameter < 0 || parameter >= model->n_parameters) return NO_SUCH;
  if (model->parameter_fixed[parameter]) return FIXED;
  int fault = fault_of(model, parameter, value);
  if (!fault) run->parameters[parameter] = value;
  return fault;
}

double ltcgear_get(const ltcgear_run *run, ltcgear_whole parameter) {
  return parameter < 0 || parameter >= run->model->n_parameters ? NAN : run->parameters[parameter];
}

const char *ltcgear_reason(int status) {
  const int faults = (int)(sizeof FAULT / sizeof *FAULT);
  if (status == DONE) return "done";
  if (status > 0 && status < faults) return FAULT[status];
  return status >= faults && status < STATUSES ? REASON[status - faults] : "stopped by who takes the samples";
}

/* Loads over time: the tables of a model, or what they are steered along. */

typedef struct {
  const double *time, *value;
  whole rows;
} table;

static table table_of(const ltcgear_run *run, whole which) {
  const course *steered = run->courses + which;
  const ltcgear_table *given = run->model->tables + which;
  if (steered->rows) return (table){steered->time, steered->value, steered->rows};
  return (table){given->time, given->value, given->rows};
}

/* The number of rows that lie before a time, or up to it. */
static whole rows_before(const table *t, double time, int up_to) {
  whole low = 0, high = t->rows;
  while (low < high) {
    whole middle = (low + high) / 2;
    if (t->time[middle] < time || (up_to && t->time[middle] == time)) low = middle + 1;
    else high = middle;
  }
  return low;
}

/* The slope after a time, or before it; zero beyond the ends. */
static double slope_at(const table *t, double time, int after) {
  whole i = rows_before(t, time, after);
  if (i == 0 || i == t->rows) return 0;
  return (t->value[i] - t->value[i - 1]) / (t->time[i] - t->time[i - 1]);
}

static double value_at(const table *t, double time) {
  whole i = rows_before(t, time, 1);
  if (i == 0) return t->value[0];
  if (i == t->rows) return t->value[i - 1];
  return t->value[i - 1] + slope_at(t, time, 1) * (time - t->time[i - 1]);
}

/* Write the load signals at a time, slopes those after it or before it. */
static void signals_at(const ltcgear_run *run, double time, int after, double *out) {
  for (whole i = 0; i < run->model->n_signals; ++i) {
    table t = table_of(run, run->model->signal_table[i]);
    out[i] = run->model->signal_slope[i] ? slope_at(&t, time, after) : value_at(&t, time);
  }
}

/* Write their rates after a time; that of a slope is zero between knots. */
static void signal_rates(const ltcgear_run *run, double time, double *out) {
  for (whole i = 0; i < run->model->n_signals; ++i) {
    table t = table_of(run, run->model->signal_table[i]);
    out[i] = run->model->signal_slope[i] ? 0.0 : slope_at(&t, time, 1);
  }
}

/* The first row of any table after a time, infinite where none is left. */
static double knot_after(const ltcgear_run *run, double time) {
  double first = INFINITY;
  for (whole i = 0; i < run->model->n_tables; ++i) {
    table t = table_of(run, i);
    whole row = rows_before(&t, time, 1);
    if (row < t.rows) first = smaller(first, t.time[row]);
  }
  return first;
}

int ltcgear_steer(ltcgear_run *run, ltcgear_whole which, double from, double to, double until) {
  const double now = run->m.time;
  if (which < 0 || which >= run->model->n_tables) return NO_SUCH;
  if (!isfinite(from) || !isfinite(to) || !isfinite(until)) return NOT_A_NUMBER;
  course *c = run->courses + which;
  c->rows = 0;
  if (until > now) c->time[c->rows] = now, c->value[c->rows++] = from;
  if (until > now && from * to < 0) { /* no speed may turn back within an arc */
    double zero = now + (until - now) * (from / (from - to));
    if (now < zero && zero < until) c->time[c->rows] = zero, c->value[c->rows++] = 0;
  }
  c->time[c->rows] = until, c->value[c->rows++] = to;
  return DONE;
}

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

/* Linear equations of which some motions may meet no stiffness: Gaussian elimination with complete pivoting. */

/* Equations a x = b of a size, and how their rows and columns were exchanged; ``rank`` pivots differ from rounding. */
typedef struct {
  whole size, rank;
  double *a, *b, *x, *bound, *combination;
  whole *row, *column;
} equations;

static double *entry(const equations *e, whole i, whole j) { return e->a + e->row[i] * e->size + e->column[j]; }

static void exchange(whole *list, whole i, whole j) {
  whole kept = list[i];
  list[i] = list[j], list[j] = kept;
}

/* Eliminate in place: multipliers below the pivots, what is left above. */
static void eliminate(equations *e) {
  const whole n = e->size;
  double first = 0;
  for (whole i = 0; i < n; ++i) e->row[i] = e->column[i] = i;
  for (e->rank = 0; e->rank < n; ++e->rank) {
    const whole k = e->rank;
    whole at = k, to = k;
    for (whole i = k; i < n; ++i)
      for (whole j = k; j < n; ++j)
        if (fabs(*entry(e, i, j)) > fabs(*entry(e, at, to))) at = i, to = j;
    exchange(e->row, k, at), exchange(e->column, k, to);
    const double pivot = *entry(e, k, k);
    if (k == 0) first = fabs(pivot);
    if (!(fabs(pivot) > LOOSENESS * (double)n * first)) return;
    for (whole i = k + 1; i < n; ++i) {
      double part = *entry(e, i, k) /= pivot;
      if (part != 0)
        for (whole j = k + 1; j < n; ++j) *entry(e, i, j) -= part * *entry(e, k, j);
    }
  }
}

/* Say whether b pushes along a loose motion by more than the bounds of its entries allow. */
static int pushes(const equations *e) {
  for (whole loose = e->rank; loose < e->size; ++loose) {
    double push = e->b[e->row[loose]], bound = e->bound[e->row[loose]];
    for (whole i = e->rank - 1; i >= 0; --i) {
      double sum = *entry(e, loose, i);
      for (whole j = i + 1; j < e->rank; ++j) sum += e->combination[j] * *entry(e, j, i);
      e->combination[i] = -sum;
      push += e->combination[i] * e->b[e->row[i]];
      bound += fabs(e->combination[i]) * e->bound[e->row[i]];
    }
    if (fabs(push) > bound) return 1;
  }
  return 0;
}

/* Find x from the pivots' equations, the loose entries of x given. */
static void substitute(const equations *e, double *x) {
  for (whole i = e->rank - 1; i >= 0; --i) {
    double sum = x[e->column[i]];
    for (whole j = i + 1; j < e->size; ++j) sum -= *entry(e, i, j) * x[e->column[j]];
    x[e->column[i]] = sum / *entry(e, i, i);
  }
}

static double product(whole n, const double *one, const double *two) {
  double sum = 0;
  for (whole i = 0; i < n; ++i) sum += one[i] * two[i];
  return sum;
}

/* Take from a vector its part along another one. */
static void take_part(whole n, double *from, const double *along) {
  double part = product(n, from, along) / product(n, along, along);
  for (whole i = 0; i < n; ++i) from[i] -= part * along[i];
}

/* Solve, with the smallest x where motions are loose. ``basis`` has room for one vector per loose motion. */
static void solve(equations *e, double *basis) {
  const whole n = e->size, loose = n - e->rank;
  for (whole i = 0; i < e->rank; ++i) {
    double sum = e->b[e->row[i]];
    for (whole j = 0; j < i; ++j) sum -= *entry(e, i, j) * e->x[e->column[j]];
    e->x[e->column[i]] = sum;
  }
  for (whole i = e->rank; i < n; ++i) e->x[e->column[i]] = 0;
  substitute(e, e->x);
  for (whole k = 0; k < loose; ++k) {
    double *motion = basis + k * n;
    for (whole i = 0; i < n; ++i) motion[i] = 0;
    motion[e->column[e->rank + k]] = 1;
    substitute(e, motion);
    for (whole j = 0; j < k; ++j) take_part(n, motion, basis + j * n);
    take_part(n, e->x, motion);
  }
}

/* The loaded equilibrium: Newton's method on the generated Jacobian, from that of the scene as it was generated. */

#define NEWTON 60 /* steps after which it is given up */
#define HALVINGS 40

/* What is followed from 1 to 0: how far numbers and loads are the scene's, clearances closed, teeth able to pull. */
enum { BLENDING, OPENING, RELEASING };

/* What a search has: parameters, levels and signals it holds for, and room. */
typedef struct {
  ltcgear_run *run;
  double *p, *s, *x, *trial, *nonzeros, *xdot, *force, *load, *size, *scale, *guess, *slope, *basis;
  equations e;
  int way;
} balance;

static void lay_out_balance(balance *b, room *r) {
  const ltcgear_model *model = b->run->model;
  const whole n = model->n_states, f = model->n_freedoms;
  EACH(double, reals, n, &b->x, &b->trial, &b->xdot, &b->guess, &b->slope);
  EACH(double, reals, f, &b->force, &b->load, &b->size, &b->scale, &b->e.b, &b->e.x, &b->e.bound, &b->e.combination);
  EACH(double, reals, f * f, &b->basis, &b->e.a);
  EACH(whole, wholes, f, &b->e.row, &b->e.column);
  b->p = reals(r, model->n_parameters), b->s = reals(r, model->n_levels + model->n_signals);
  b->nonzeros = reals(r, model->jacobian_colind[n]);
  b->e.size = f;
}

/* Write the state of the rigid motion. */
static void place_rigid(const balance *b, double *x) {
  const ltcgear_model *model = b->run->model;
  for (whole i = 0; i < model->n_states; ++i) x[i] = 0;
  if (model->free_speed >= 0) x[model->free_speed] = b->run->parameters[model->speed];
}

static void put(double *p, whole place, double value) {
  if (place >= 0) p[place] = value;
}

/* Write the mean levels of the meshes: their share of double contact. */
static void find_levels(balance *b) {
  ltcgear_run *run = b->run;
  march *m = &run->m;
  place_rigid(b, m->x);
  memset(m->s_now, 0, (size_t)(m->n_levels + m->n_signals) * sizeof *m->s_now);
  for (int i = 0; i < 3; ++i) m->phases.res[i] = m->now + i * m->n_levels;
  call(&m->phases, m->x, m->s_now, b->p);
  for (whole i = 0; i < m->n_levels; ++i) b->s[i] = 1 - m->now[2 * m->n_levels + i];
}

/* Set parameters and loads: a part of them the scene's, the rest the run's; with teeth that pull with a share of their
 * stiffness, and a part of the clearances closed. What varies with the mesh phase is at its mean. */
static void pose(balance *b, double scene, double pull, double closing) {
  const ltcgear_run *run = b->run;
  const ltcgear_model *model = run->model;
  for (whole i = 0; i < model->n_parameters; ++i) {
    double now = run->parameters[i], then = model->parameter_values[i];
    b->p[i] = now + scene * (then - now);
  }
  put(b->p, model->pull, pull), put(b->p, model->varying, 0), put(b->p, model->closing, closing);
  find_levels(b);
  signals_at(run, run->m.time, 0, b->s + model->n_levels);
  for (whole i = 0; scene > 0 && i < model->n_signals; ++i) {
    const ltcgear_table *given = model->tables + model->signal_table[i];
    table t = {given->time, given->value, given->rows};
    double now = b->s[model->n_levels + i], then = model->signal_slope[i] ? slope_at(&t, 0, 0) : value_at(&t, 0);
    b->s[model->n_levels + i] = now + scene * (then - now);
  }
}

/* Write the forces [N], [N m] out of balance. */
static int find_forces(balance *b, const double *x, double *force) {
  const ltcgear_model *model = b->run->model;
  b->run->rhs.res[0] = b->xdot;
  if (call(&b->run->rhs, x, b->s, b->p)) return NOT_FINITE;
  int finite = 1;
  for (whole i = 0; i < model->n_states; ++i) finite &= isfinite(b->xdot[i]);
  for (whole i = 0; i < model->n_freedoms; ++i)
    force[i] = b->xdot[model->freedoms[i].rate] * b->p[model->freedoms[i].inertia];
  return finite ? DONE : OVERLAPPING;
}

static int find_jacobian(ltcgear_run *run, const double *x, const double *s, const double *p, double *nonzeros) {
  run->jacobian.res[0] = nonzeros;
  if (call(&run->jacobian, x, s, p)) return NOT_FINITE;
  for (whole k = 0; k < run->model->jacobian_colind[run->model->n_states]; ++k)
    if (!isfinite(nonzeros[k])) return OVERLAPPING;
  return DONE;
}

/* One entry of d xdot / d x. */
static double nonzero(const ltcgear_model *model, const double *nonzeros, whole row, whole column) {
  for (whole k = model->jacobian_colind[column]; k < model->jacobian_colind[column + 1]; ++k)
    if (model->jacobian_row[k] == row) return nonzeros[k];
  return 0;
}

/* Write the stiffness matrix. */
static int find_stiffness(balance *b) {
  const ltcgear_model *model = b->run->model;
  const whole f = model->n_freedoms;
  int fault = find_jacobian(b->run, b->x, b->s, b->p, b->nonzeros);
  for (whole i = 0; i < f; ++i)
    for (whole j = 0; j < f; ++j)
      b->e.a[i * f + j] = -nonzero(model, b->nonzeros, model->freedoms[i].rate, model->freedoms[j].position) *
                          b->p[model->freedoms[i].inertia];
  return fault;
}

/* Return the largest force out of balance over the size of what is in balance there. A freedom at which nothing acts is
 * measured by the largest of its kind. */
static double find_residual(balance *b) {
  const ltcgear_model *model = b->run->model;
  const whole f = model->n_freedoms;
  double largest[2] = {0, 0}, residual = 0;
  for (whole i = 0; i < f; ++i) {
    double size = b->load[i];
    for (whole j = 0; j < f; ++j) size += fabs(b->e.a[i * f + j]) * (fabs(b->x[model->freedoms[j].position]) + ROUNDED);
    b->size[i] = size;
    largest[model->freedoms[i].turns] = larger(largest[model->freedoms[i].turns], size);
  }
  for (whole i = 0; i < f; ++i) {
    double size = larger(b->size[i], 1e-3 * largest[model->freedoms[i].turns]);
    if (b->force[i] != 0) residual = larger(residual, fabs(b->force[i]) / size);
  }
  return residual;
}

/* Bring the stiffness of every freedom to 1, so that stiff and soft ones can be compared; set the bounds within which
 * forces along loose motions must balance. */
static void weigh(balance *b) {
  const ltcgear_model *model = b->run->model;
  const whole f = model->n_freedoms;
  double largest[2] = {0, 0};
  for (whole i = 0; i < f; ++i) {
    unsigned char turns = model->freedoms[i].turns;
    largest[turns] = larger(largest[turns], fabs(b->e.a[i * f + i]));
  }
  for (whole i = 0; i < f; ++i) {
    double stiffness = larger(fabs(b->e.a[i * f + i]), DBL_EPSILON * largest[model->freedoms[i].turns]);
    b->scale[i] = 1 / sqrt(stiffness > 0 ? stiffness : 1.0);
  }
  for (whole i = 0; i < f; ++i) {
    double springs = 0;
    for (whole j = 0; j < f; ++j) {
      double *a = b->e.a + i * f + j;
      springs += fabs(*a) * (OPENNESS * ROUNDED + 1e-14 * fabs(b->x[model->freedoms[j].position]));
      *a *= b->scale[i] * b->scale[j];
    }
    b->e.bound[i] = (OPENNESS * b->load[i] + springs) * b->scale[i];
    b->e.b[i] = b->force[i] * b->scale[i];
  }
}

/* Take a step, halved until the gears still reach each other; write its largest change. */
static int step(balance *b, double *largest, double *farthest) {
  const ltcgear_model *model = b->run->model;
  const whole f = model->n_freedoms;
  *largest = *farthest = 0;
  for (whole i = 0; i < f; ++i) {
    *largest = larger(*largest, fabs(b->scale[i] * b->e.x[i]));
    *farthest = larger(*farthest, fabs(b->x[model->freedoms[i].position]));
  }
  double part = 1;
  for (int trial = 0; trial < HALVINGS; ++trial, part /= 2) {
    memcpy(b->trial, b->x, (size_t)model->n_states * sizeof *b->x);
    for (whole i = 0; i < f; ++i) b->trial[model->freedoms[i].position] += part * b->scale[i] * b->e.x[i];
    if (!find_forces(b, b->trial, b->size)) return DONE;
  }
  return OVERLAPPING;
}

/* Iterate from x until the forces balance to rounding. */
static int iterate(balance *b) {
  const ltcgear_model *model = b->run->model;
  double best = INFINITY, largest, farthest;
  int fault;
  place_rigid(b, b->trial);
  find_forces(b, b->trial, b->load);
  for (whole i = 0; i < model->n_freedoms; ++i) b->load[i] = fabs(b->load[i]);
  for (int trial = 0; trial < NEWTON; ++trial) {
    if ((fault = find_forces(b, b->x, b->force)) || (fault = find_stiffness(b))) return fault;
    double residual = find_residual(b);
    weigh(b);
    eliminate(&b->e);
    if (pushes(&b->e)) return LOOSE;
    solve(&b->e, b->basis);
    if ((fault = step(b, &largest, &farthest)) && !(residual < 1e-13)) return fault;
    int settled = largest <= 1e-7 * farthest + SETTLED;
    if (residual < 1e-13 || (settled && residual < 1e-8 && residual > 0.3 * best)) return DONE;
    best = smaller(best, residual);
    memcpy(b->x, b->trial, (size_t)model->n_states * sizeof *b->x);
  }
  return UNSETTLED;
}

/* Pose the problem at a part of the way that is followed. */
static void pose_part(balance *b, double part) {
  switch (b->way) {
    case BLENDING: pose(b, part, 0, 0); break;
    case OPENING: pose(b, 0, 1, part); break;
    default: pose(b, 0, part, 0);
  }
}

/* Follow the equilibrium from part 1, where it is found from x, to part 0, by secants and steps that adapt. */
static int follow(balance *b) {
  const size_t all = (size_t)b->run->model->n_states * sizeof *b->x;
  double at = 1, length = FIRST_PART;
  pose_part(b, 1);
  int fault = iterate(b);
  memset(b->slope, 0, all);
  memcpy(b->guess, b->x, all);
  while (!fault && at > 0) {
    double there = larger(at - length, 0);
    memcpy(b->x, b->guess, all);
    for (whole i = 0; i < b->run->model->n_states; ++i) b->x[i] += b->slope[i] * (there - at);
    pose_part(b, there);
    int missed = iterate(b);
    if (missed) {
      length /= PART_GROWTH;
      if (length < SMALLEST_PART) fault = missed;
      continue;
    }
    for (whole i = 0; i < b->run->model->n_states; ++i) b->slope[i] = (b->x[i] - b->guess[i]) / (there - at);
    memcpy(b->guess, b->x, all);
    at = there, length *= PART_GROWTH;
  }
  return fault;
}

/* From the rigid motion, close what a load has to close first: bearings without clearance, and teeth that pull too. Then
 * let clearances open, and teeth pull less and less. */
static int close_first(balance *b) {
  const ltcgear_model *model = b->run->model;
  int fault = DONE;
  place_rigid(b, b->x);
  if (model->closing >= 0) b->way = OPENING, fault = follow(b);
  if (!fault && model->pull >= 0) b->way = RELEASING, fault = follow(b);
  if (fault) return fault;
  pose(b, 0, 0, 0);
  return iterate(b);
}

/* Find the equilibrium for a run's parameters and loads. */
static int find_equilibrium(balance *b) {
  const ltcgear_model *model = b->run->model;
  const size_t all = (size_t)model->n_states * sizeof *b->x;
  if (!model->n_freedoms) return NO_FREEDOM;
  for (int followed = 0; followed < 2; ++followed) {
    memcpy(b->x, model->start, all);
    if (model->free_speed >= 0) b->x[model->free_speed] = b->run->parameters[model->speed];
    b->way = BLENDING;
    pose_part(b, 0);
    if (!(followed ? follow(b) : iterate(b))) return DONE;
  }
  return close_first(b);
}

/* Sizes of vibrations, to which tolerances refer, and the fastest motion of the linearised model. */

#define SQUARINGS 10

/* Write d xdot / d x at the equilibrium, with teeth that pull; all contacts closed too, if that is asked for. */
static int linearise(balance *b, double *matrix, int closed) {
  const ltcgear_model *model = b->run->model;
  const whole n = model->n_states;
  pose(b, 0, 1, closed);
  for (whole g = 0; closed && g < model->n_holds; ++g)
    if (model->hold_closes[g]) b->p[model->holds[g]] = HELD;
  int fault = find_jacobian(b->run, b->x, b->s, b->p, b->nonzeros);
  memset(matrix, 0, (size_t)(n * n) * sizeof *matrix);
  for (whole j = 0; j < n; ++j)
    for (whole k = model->jacobian_colind[j]; k < model->jacobian_colind[j + 1]; ++k)
      matrix[model->jacobian_row[k] * n + j] = b->nonzeros[k];
  return fault;
}

/* Write a size for every state: the motion in which it alone stores one small energy, 1e-4 of the mean strain energy per
 * freedom, so that coordinates of all kinds weigh alike. */
static void find_scale(balance *b, const double *matrix) {
  const ltcgear_model *model = b->run->model;
  const whole n = model->n_states, f = model->n_freedoms;
  march *m = &b->run->m;
  call(&m->energy, b->x, b->s, m->p);
  double strain = m->balance[1], energy = strain > LOADED ? 1e-4 * strain / (double)f : UNLOADED, stiffest = 0;
  for (whole i = 0; i < n; ++i) m->scale[i] = 1;
  for (whole i = 0; i < f; ++i)
    stiffest = larger(stiffest, -matrix[model->freedoms[i].rate * n + model->freedoms[i].position]);
  for (whole i = 0; i < f; ++i) {
    const ltcgear_freedom *freedom = model->freedoms + i;
    double mass = m->p[freedom->inertia], stiffness = -matrix[freedom->rate * n + freedom->position] * mass;
    double floor = (stiffest > 0 ? 1e-8 * stiffest : 1.0) * mass; /* where nothing holds anything, 1 rad/s */
    m->scale[freedom->position] = sqrt(2 * energy / larger(stiffness, floor));
    m->scale[freedom->rate] = sqrt(2 * energy / mass);
  }
}

/* Return the largest modulus of an eigenvalue: the limit of |A^k|^(1/k) (Gelfand 1941), k = 2^SQUARINGS. */
static double spectral_radius(whole n, double *a, double *square) {
  double logarithm = 0, power = 1;
  for (int k = 0;; ++k) {
    double size = 0;
    for (whole i = 0; i < n * n; ++i) size += a[i] * a[i];
    size = sqrt(size);
    if (!(size > 0) || !isfinite(size)) return 0;
    logarithm += log(size) / power;
    if (k == SQUARINGS) return exp(logarithm);
    for (whole i = 0; i < n * n; ++i) a[i] /= size, square[i] = 0;
    for (whole i = 0; i < n; ++i)
      for (whole l = 0; l < n; ++l) {
        const double part = a[i * n + l];
        if (part != 0)
          for (whole j = 0; j < n; ++j) square[i * n + j] += part * a[l * n + j];
      }
    memcpy(a, square, (size_t)(n * n) * sizeof *a);
    power *= 2;
  }
}

/* Set the scale of all states, and how fast the fastest mode swings with all contacts closed. */
static int set_scale(balance *b, double *matrix, double *square) {
  const whole n = b->run->model->n_states;
  const double *scale = b->run->m.scale;
  int fault;
  pose(b, 0, 0, 0);
  if ((fault = linearise(b, matrix, 0))) return fault;
  find_scale(b, matrix);
  if ((fault = linearise(b, matrix, 1))) return fault;
  for (whole i = 0; i < n; ++i)
    for (whole j = 0; j < n; ++j) matrix[i * n + j] *= scale[j] / scale[i];
  b->run->quickest = spectral_radius(n, matrix, square);
  return DONE;
}

/* The start of a run: its equilibrium, scale, cells and sides there. */

/* Write the indicators of borders at displacements z. */
static void borders_at(march *m, const double *z, double *out) {
  place(m, z);
  m->borders.res[0] = out;
  call(&m->borders, m->x, m->s_now, m->p);
}

/* Set the sides of all borders, and what the tolerance of each state lets their indicators be off. */
static void set_sides(ltcgear_run *run) {
  march *m = &run->m;
  const int known = m->angle >= 0 && m->free < 0;
  for (whole i = 0; i < m->n_levels; ++i) m->s_now[i] = (double)(m->cells[i] & 1);
  memcpy(m->s_now + m->n_levels, m->signals, (size_t)m->n_signals * sizeof *m->signals);
  borders_at(m, m->zeros, m->g_start);
  for (whole g = 0; g < m->n_holds; ++g) m->sides[g] = m->g_start[g] > 0, m->slack[g] = 0;
  memset(m->z_near, 0, (size_t)m->n * sizeof *m->z_near);
  for (whole i = 0; m->n_holds && i < m->n; ++i) {
    m->z_near[i] = 1;
    borders_at(m, m->z_near, m->g_now);
    m->z_near[i] = 0;
    for (whole g = 0; g < m->n_holds; ++g) {
      double off = known && i == m->angle ? 0 : SLACK * m->rtol * fabs(m->g_now[g] - m->g_start[g]);
      m->error[i * m->n_holds + g] = off;
      m->slack[g] = larger(m->slack[g], off);
    }
  }
  hold(m);
}

/* Set the cells of all meshes. */
static void set_cells(march *m) {
  const whole count = m->n_levels;
  find_phases(m, m->zeros, m->signals, m->now);
  for (whole i = 0; i < count; ++i)
    m->cells[i] = m->last_turn[i] = m->arc_cells[i] = cell_of(m->now[i], m->now[count + i], m->now[2 * count + i]);
}

/* Find equilibrium and scale, in room that is freed again. */
static int find_start(ltcgear_run *run) {
  const whole n = run->model->n_states;
  balance b = {.run = run};
  double *matrix, *square;
  room r = {0, 0};
  for (int counted = 0; counted < 2; ++counted) {
    if (counted) r = (room){calloc(1, r.used), 0};
    if (counted && !r.front) return NO_MEMORY;
    lay_out_balance(&b, &r);
    matrix = reals(&r, n * n), square = reals(&r, n * n);
  }
  int fault = find_equilibrium(&b);
  if (!fault) fault = set_scale(&b, matrix, square);
  memcpy(run->m.origin, b.x, (size_t)n * sizeof *b.x);
  free(r.front);
  return fault;
}

int ltcgear_start(ltcgear_run *run, double time) {
  const ltcgear_model *model = run->model;
  march *m = &run->m;
  int fault;
  if (run->started) return HAS_STARTED;
  if (!isfinite(time)) return NOT_A_NUMBER;
  m->time = time;
  memcpy(m->p, run->parameters, (size_t)model->n_parameters * sizeof *m->p);
  m->held_speed = model->speed_held ? m->p[model->speed] : 0;
  if ((fault = find_start(run))) return fault;
  m->first = m->longest = m->widest = TURNED / larger(run->quickest, SLOWEST);
  m->shortest = SHORTEST * m->longest, m->fresh = 1;
  signals_at(run, time, 1, m->signals);
  set_cells(m);
  set_sides(run);
  for (whole i = 0; i < m->n_forces; ++i) m->lowest[i] = INFINITY;
  run->started = 1;
  return DONE;
}

/* Saved runs: all that a run needs to go on as if it had not stopped. */

enum { COUNTING, SAVING, RESTORING };

/* Bytes that are counted, written or read, from front to back. */
typedef struct {
  unsigned char *front;
  size_t used;
  int way;
} passage;

static void pass(passage *all, void *value, size_t size) {
  if (all->way == SAVING) memcpy(all->front + all->used, value, size);
  if (all->way == RESTORING) memcpy(value, all->front + all->used, size);
  all->used += size;
}

static void pass_reals(passage *all, double *values, whole count) { pass(all, values, (size_t)count * sizeof *values); }
static void pass_wholes(passage *all, whole *values, whole count) { pass(all, values, (size_t)count * sizeof *values); }

#define PASS(name) pass(all, &run->m.name, sizeof run->m.name);
static void pass_run(ltcgear_run *run, passage *all) {
  const ltcgear_model *model = run->model;
  march *m = &run->m;
  const whole n = m->n, meshes = m->n_levels, holds = m->n_holds;
  KEPT_NUMBERS(PASS)
  PASS(base) PASS(rtol) PASS(unresolved) PASS(held_speed) PASS(shortest)
  pass(all, &run->turns, sizeof run->turns), pass(all, &run->started, sizeof run->started);
  pass(all, &run->quickest, sizeof run->quickest);
  pass_reals(all, m->z, n), pass_reals(all, m->origin, n), pass_reals(all, m->scale, n);
  pass_reals(all, m->p, model->n_parameters), pass_reals(all, run->parameters, model->n_parameters);
  pass_reals(all, m->signals, m->n_signals), pass_reals(all, m->slope, m->n_signals);
  pass_reals(all, m->heading, meshes), pass_reals(all, m->lowest, m->n_forces);
  pass_reals(all, m->error, n * holds), pass_reals(all, m->slack, holds);
  pass_wholes(all, m->cells, meshes), pass_wholes(all, m->last_turn, meshes);
  pass_wholes(all, m->arc_cells, meshes);
  pass_wholes(all, run->rest, model->n_clocks), pass_wholes(all, run->cycles, model->n_clocks);
  pass(all, m->sides, (size_t)holds), pass(all, run->courses, (size_t)model->n_tables * sizeof *run->courses);
}
#undef PASS

/* The bytes that a saved run begins with: its model's key. */
static size_t key_size(const ltcgear_run *run) { return strlen(run->model->key) + 1; }

/* All bytes but those of the checksum. */
static size_t sealed_size(const ltcgear_run *run) {
  passage all = {0, key_size(run), COUNTING};
  pass_run((ltcgear_run *)run, &all); /* which is only read */
  return all.used;
}

unsigned long long ltcgear_checksum(const void *bytes, size_t size) {
  unsigned long long sum = 0xcbf29ce484222325u;
  for (const unsigned char *c = bytes, *end = c + size; c < end; ++c) sum = (sum ^ *c) * 0x100000001b3u;
  return sum;
}

size_t ltcgear_size(const ltcgear_run *run) { return sealed_size(run) + sizeof(unsigned long long); }

void ltcgear_save(const ltcgear_run *run, void *to) {
  passage all = {to, key_size(run), SAVING};
  memcpy(to, run->model->key, key_size(run));
  pass_run((ltcgear_run *)run, &all); /* which is only read */
  unsigned long long sum = ltcgear_checksum(to, all.used);
  pass(&all, &sum, sizeof sum);
}

int ltcgear_restore(ltcgear_run *run, const void *from) {
  passage all = {(unsigned char *)from, key_size(run), RESTORING}; /* which is only read */
  const size_t size = sealed_size(run);
  unsigned long long sum = ltcgear_checksum(from, size);
  if (memcmp(from, run->model->key, key_size(run))) return FOREIGN;
  if (memcmp(all.front + size, &sum, sizeof sum)) return DAMAGED;
  pass_run(run, &all);
  return DONE;
}

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

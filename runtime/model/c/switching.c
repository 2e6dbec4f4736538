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

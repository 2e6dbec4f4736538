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

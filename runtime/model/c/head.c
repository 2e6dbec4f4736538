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

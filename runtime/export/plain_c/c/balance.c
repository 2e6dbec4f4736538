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

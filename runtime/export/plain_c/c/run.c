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

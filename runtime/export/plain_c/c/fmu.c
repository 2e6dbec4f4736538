/* One instance of the model for importers of FMUs, see fmu.h. */
#include "fmu.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEFAULT_RTOL 1e-6
#define LEAST_RTOL 1e-13
#define MOST_RTOL 0.1
#define MOST_STEPS 1e9 /* of the integrator, in one communication step: from minutes to hours */
#define SAME_TIME 1e-9 /* [s], and over the time: by how much an importer's clock may differ from ours */

/* A kept state: this, then what an instance keeps itself, then its run; the checksum of all that when it is packed. */
typedef struct {
  char token[64];
  size_t size;
  int exchange, mode, started;
  double time, rtol;
} kept;

static const ltcgear_model *const model = &ltcgear_scene;

size_t fmu_count(int kind) { return fmu_scene.first[kind + 1] - fmu_scene.first[kind]; }

int fmu_refuse(fmu *f, const char *form, ...) {
  va_list rest;
  va_start(rest, form);
  vsnprintf(f->message, sizeof f->message, form, rest);
  va_end(rest);
  for (char *c = f->message; *c; ++c)
    if (*c == '%') *c = '_'; /* FMI 2.0 takes messages for formats */
  return 1;
}

/* Return whether a status of the model's is a fault, with a message that says what was tried. */
static int failed(fmu *f, int status, const char *what) {
  return status && fmu_refuse(f, "%s: %s", what, ltcgear_reason(status));
}

fmu *fmu_make(int exchange) {
  const size_t n = (size_t)model->n_states, n_p = (size_t)model->n_parameters, n_y = (size_t)model->n_outputs;
  const size_t n_u = fmu_count(FMU_INPUT), n_z = fmu_count(FMU_INDICATOR), n_f = fmu_count(FMU_STATISTIC);
  fmu *f = calloc(1, sizeof *f);
  double *room = calloc(2 * n + n_p + n_y + 2 * n_u + n_z + n_f + 1, sizeof *room);
  if (!f || !room) {
    free(f);
    free(room);
    return NULL;
  }
  f->exchange = exchange;
  f->p = room;
  f->u = f->p + n_p;
  f->met = f->u + n_u;
  f->x = f->met + n_u;
  f->forces = (ltcgear_statistics *)(f->x + n);
  f->xdot = f->x + n + n_f;
  f->y = f->xdot + n;
  f->z = f->y + n_y;
  fmu_reset(f);
  return f;
}

void fmu_free(fmu *f) {
  if (!f) return;
  if (f->run) ltcgear_destroy(f->run);
  free(f->p);
  free(f);
}

/* Forget the run, so that the next one begins from parameters and inputs. */
static void forget(fmu *f) {
  if (f->run) ltcgear_destroy(f->run);
  f->run = NULL;
  f->known = 0;
}

void fmu_reset(fmu *f) {
  forget(f);
  f->mode = FMU_MADE;
  f->time = 0;
  f->rtol = DEFAULT_RTOL;
  memcpy(f->p, model->parameter_values, (size_t)model->n_parameters * sizeof *f->p);
  for (size_t i = 0; i < fmu_count(FMU_INPUT); ++i) f->u[i] = fmu_scene.input_start[i];
}

int fmu_begin(fmu *f, double time, double rtol) {
  if (!isfinite(time)) return fmu_refuse(f, "the start time %g is not finite", time);
  forget(f);
  f->time = time;
  f->rtol = rtol > 0 && isfinite(rtol) ? fmin(fmax(rtol, LEAST_RTOL), MOST_RTOL) : DEFAULT_RTOL;
  return 0;
}

void fmu_move(fmu *f) { f->known = 0; }

int fmu_place(fmu *f, const double *x) {
  for (ltcgear_whole i = 0; i < model->n_states; ++i)
    if (!isfinite(x[i])) return fmu_refuse(f, "%s = %g: the state is not finite", model->states[i].name, x[i]);
  memcpy(f->x, x, (size_t)model->n_states * sizeof *x);
  fmu_move(f);
  return 0;
}

/* Let the run see the inputs: in model exchange as they are now, with the slopes that the importer tells. */
static int impose(fmu *f) {
  const size_t count = fmu_count(FMU_INPUT);
  for (size_t i = 0; i < count; ++i) {
    if (fmu_scene.input_slope[i]) continue;
    double slope = i + 1 < count && fmu_scene.input_slope[i + 1] ? f->u[i + 1] : 0.0;
    if (failed(f, ltcgear_impose(f->run, fmu_scene.input_table[i], f->u[i], slope), "the inputs")) return 1;
  }
  return 0;
}

/* Let the statistics be those of a step of no length. */
static int set_statistics(fmu *f) {
  if (!fmu_count(FMU_STATISTIC)) return 0;
  if (fmu_find(f, FMU_OUTPUT)) return 1;
  for (ltcgear_whole i = 0; i < model->n_forces; ++i) {
    double force = f->y[model->forces[i]];
    f->forces[i] = (ltcgear_statistics){force, fabs(force), force, force};
  }
  return 0;
}

int fmu_start(fmu *f) {
  if (f->run) return 0;
  f->run = ltcgear_create(model, f->rtol);
  if (!f->run) return fmu_refuse(f, "there is no memory for a run");
  int status = 0;
  for (ltcgear_whole i = 0; i < model->n_parameters && !status; ++i)
    if (f->p[i] != model->parameter_values[i]) status = ltcgear_set(f->run, i, f->p[i]);
  for (size_t i = 0; i < fmu_count(FMU_INPUT) && !status; ++i)
    if (!fmu_scene.input_slope[i])
      status = ltcgear_steer(f->run, fmu_scene.input_table[i], f->u[i], f->u[i], f->time);
  if (!status) status = ltcgear_start(f->run, f->time);
  if (failed(f, status, "the loaded equilibrium") || (f->exchange && impose(f)) || set_statistics(f)) {
    forget(f);
    return 1;
  }
  memcpy(f->met, f->u, fmu_count(FMU_INPUT) * sizeof *f->u);
  ltcgear_state(f->run, f->x);
  return 0;
}

int fmu_find(fmu *f, int kind) {
  int status = 0;
  if (fmu_start(f)) return 1;
  if (f->known >> kind & 1) return 0;
  if (kind == FMU_STATE && !f->exchange) ltcgear_state(f->run, f->x);
  if (kind == FMU_RATE) status = ltcgear_rates(f->run, f->time, f->x, f->xdot);
  if (kind == FMU_INDICATOR) status = ltcgear_indicators(f->run, f->time, f->x, f->z);
  if (kind == FMU_OUTPUT)
    status = f->exchange ? ltcgear_outputs(f->run, f->time, f->x, f->y) : ltcgear_read(f->run, f->y);
  if (failed(f, status, "the model")) return 1;
  f->known |= 1 << kind;
  return 0;
}

/* Return the kind of a value reference, and its number among its kind. */
static int kind_of(unsigned reference, size_t *place) {
  int kind = 0;
  while (kind < FMU_KINDS && reference >= fmu_scene.first[kind + 1]) ++kind;
  *place = kind < FMU_KINDS ? reference - fmu_scene.first[kind] : 0;
  return kind;
}

static int get_angle(fmu *f, size_t place, double *value) {
  if (fmu_find(f, FMU_OUTPUT) || fmu_find(f, FMU_STATE)) return 1;
  double turned = fmu_scene.reference < 0 ? 0.0 : f->x[fmu_scene.reference];
  *value = fmu_scene.angle_ratio[place] * turned + f->y[fmu_scene.angle_twist[place]];
  return 0;
}

static int get_one(fmu *f, unsigned reference, double *value) {
  size_t i;
  int kind = kind_of(reference, &i);
  switch (kind) {
    case FMU_TIME: return *value = f->time, 0;
    case FMU_PARAMETER:
      if (model->parameter_fixed[i]) break;
      return *value = f->p[i], 0;
    case FMU_INPUT: return *value = f->u[i], 0;
    case FMU_ANGLE: return get_angle(f, i, value);
    case FMU_COUNT:
      if (fmu_start(f)) return 1;
      return *value = (double)(i ? ltcgear_regimes(f->run) : ltcgear_switchings(f->run)), 0;
    case FMU_STATISTIC: return fmu_start(f) || (*value = ((double *)f->forces)[i], 0);
    case FMU_STATE: return fmu_find(f, kind) || (*value = f->x[i], 0);
    case FMU_RATE: return fmu_find(f, kind) || (*value = f->xdot[i], 0);
    case FMU_OUTPUT: return fmu_find(f, kind) || (*value = f->y[i], 0);
    case FMU_INDICATOR: return fmu_find(f, kind) || (*value = f->z[i], 0);
    default: break;
  }
  return fmu_refuse(f, "there is no variable with value reference %u", reference);
}

int fmu_get(fmu *f, const unsigned *reference, size_t count, double *value) {
  for (size_t i = 0; i < count; ++i)
    if (get_one(f, reference[i], value + i)) return 1;
  return 0;
}

static int check_parameter(fmu *f, size_t i, double value) {
  const char *name = model->parameters[i].name;
  const double least = model->parameter_least[i], most = model->parameter_most[i];
  if (f->mode != FMU_MADE && f->mode != FMU_INITIALIZING)
    return fmu_refuse(f, "%s: a parameter is set before the initialization ends; reset the instance first", name);
  if (value < least) return fmu_refuse(f, "%s = %g: must be at least %g", name, value, least);
  if (value > most) return fmu_refuse(f, "%s = %g: must be at most %.17g", name, value, most);
  return 0;
}

static int check_one(fmu *f, unsigned reference, double value) {
  size_t i;
  int kind = kind_of(reference, &i);
  if (kind == FMU_KINDS || (kind == FMU_PARAMETER && model->parameter_fixed[i]))
    return fmu_refuse(f, "there is no variable with value reference %u", reference);
  if (kind != FMU_PARAMETER && kind != FMU_INPUT)
    return fmu_refuse(f, "the variable with value reference %u is calculated and cannot be set", reference);
  if (!isfinite(value)) return fmu_refuse(f, "value reference %u: %g is not finite", reference, value);
  return kind == FMU_PARAMETER && check_parameter(f, i, value);
}

/* Set what has been checked; what changes the start makes the run begin anew. */
static void set_one(fmu *f, unsigned reference, double value) {
  size_t i;
  int is_input = kind_of(reference, &i) == FMU_INPUT;
  double *place = is_input ? f->u + i : f->p + i;
  if (value == *place) return;
  *place = value;
  if (f->mode == FMU_MADE || f->mode == FMU_INITIALIZING) forget(f);
}

int fmu_set(fmu *f, const unsigned *reference, size_t count, const double *value) {
  for (size_t i = 0; i < count; ++i)
    if (check_one(f, reference[i], value[i])) return 1;
  for (size_t i = 0; i < count; ++i) set_one(f, reference[i], value[i]);
  if (f->exchange) f->known = 0;
  return f->exchange && f->run && impose(f);
}

/* Lead the inputs over a step: a torque jumps at its start, a speed runs to its new value. */
static int steer(fmu *f, double until) {
  for (size_t i = 0; i < fmu_count(FMU_INPUT); ++i) {
    if (f->u[i] == f->met[i]) continue;
    double from = fmu_scene.input_ramp[i] ? f->met[i] : f->u[i];
    int status = ltcgear_steer(f->run, fmu_scene.input_table[i], from, f->u[i], until);
    if (failed(f, status, "an input")) return 1;
    f->met[i] = f->u[i];
  }
  return 0;
}

int fmu_step(fmu *f, double from, double step) {
  if (!(step > 0) || !isfinite(step) || !isfinite(from))
    return fmu_refuse(f, "a communication step of %g s from %g s on: steps go forward", step, from);
  if (fabs(from - f->time) > SAME_TIME * (1 + fabs(f->time)))
    return fmu_refuse(f, "a communication step from %.17g s on: the instance is at %.17g s", from, f->time);
  double until = from + step;
  if (fmu_start(f)) return FMU_REFUSED;
  double needed = ltcgear_expected_steps(f->run, step);
  if (needed > MOST_STEPS) {
    fmu_refuse(f, "a step of %g s would take %.0e of the integrator's", step, needed);
    return FMU_STOPPED;
  }
  if (steer(f, until)) return FMU_REFUSED;
  int moves = until > ltcgear_time(f->run); /* by more than its rounding */
  int status = moves ? ltcgear_measure(f->run, until, f->forces) : ltcgear_advance(f->run, until);
  f->time = ltcgear_time(f->run);
  f->known = 0;
  if (!status) return 0;
  fmu_refuse(f, "the integration stopped at %.9g s: %s", f->time, ltcgear_reason(status));
  return FMU_STOPPED;
}

int fmu_update(fmu *f, double *next) {
  int changed;
  if (fmu_start(f)) return 1;
  if (failed(f, ltcgear_update(f->run, f->time, f->x, &changed), "an event")) return 1;
  *next = ltcgear_next_knot(f->run, f->time);
  f->known = 0;
  return 0;
}

/* Bytes of what an instance keeps itself: parameters, inputs as they are and as they were met, states, statistics. */
static size_t own_size(void) {
  size_t n = (size_t)(model->n_parameters + model->n_states) + 2 * fmu_count(FMU_INPUT) + fmu_count(FMU_STATISTIC);
  return n * sizeof(double);
}

static size_t kept_size(const void *state) { return state ? ((const kept *)state)->size : 0; }

int fmu_keep(fmu *f, void **state) {
  size_t size = sizeof(kept) + own_size() + (f->run ? ltcgear_size(f->run) : 0);
  if (!*state || kept_size(*state) != size) {
    free(*state);
    *state = calloc(1, size);
  }
  if (!*state) return fmu_refuse(f, "there is no memory for a state");
  kept *head = *state;
  strncpy(head->token, fmu_scene.token, sizeof head->token - 1);
  head->size = size;
  head->exchange = f->exchange, head->mode = f->mode, head->started = f->run != NULL;
  head->time = f->time, head->rtol = f->rtol;
  char *bytes = (char *)(head + 1);
  memcpy(bytes, f->p, own_size()); /* what it keeps itself lies in one piece, in this order */
  if (f->run) ltcgear_save(f->run, bytes + own_size());
  return 0;
}

/* Make the run of a kept state; NULL with a message where that cannot be. */
static ltcgear_run *make_run(fmu *f, const kept *head) {
  ltcgear_run *run = ltcgear_create(model, head->rtol);
  int status = 0, fits = run && head->size == sizeof *head + own_size() + ltcgear_size(run);
  if (fits) status = ltcgear_restore(run, (const char *)(head + 1) + own_size());
  if (fits && !status) return run;
  fmu_refuse(f, "%s", !run ? "there is no memory for a run" : fits ? ltcgear_reason(status) : "the state is damaged");
  ltcgear_destroy(run);
  return NULL;
}

int fmu_return(fmu *f, const void *state) {
  const kept *head = state;
  if (!head) return fmu_refuse(f, "no state was given");
  ltcgear_run *run = head->started ? make_run(f, head) : NULL;
  if (head->started && !run) return 1;
  forget(f);
  f->run = run;
  memcpy(f->p, head + 1, own_size());
  f->mode = head->mode, f->time = head->time, f->rtol = head->rtol;
  return 0;
}

size_t fmu_packed_size(const void *state) { return state ? kept_size(state) + sizeof(unsigned long long) : 0; }

int fmu_pack(fmu *f, const void *state, void *bytes, size_t size) {
  size_t own = kept_size(state), needed = fmu_packed_size(state);
  if (!state || size < needed) return fmu_refuse(f, "a state of %zu bytes goes not into %zu", needed, size);
  unsigned long long sum = ltcgear_checksum(state, own);
  memcpy(bytes, state, own);
  memcpy((char *)bytes + own, &sum, sizeof sum);
  return 0;
}

/* Say whether some bytes are a packed state that nothing has changed. */
static int is_sound(const void *bytes, size_t size) {
  unsigned long long sum;
  kept head;
  if (size < sizeof head + own_size() + sizeof sum) return 0;
  size -= sizeof sum;
  memcpy(&head, bytes, sizeof head);
  memcpy(&sum, (const char *)bytes + size, sizeof sum);
  return head.size == size && ltcgear_checksum(bytes, size) == sum;
}

int fmu_unpack(fmu *f, const void *bytes, size_t size, void **state) {
  kept head = {.size = 0};
  if (!bytes) return fmu_refuse(f, "no state was given");
  memcpy(&head, bytes, size < sizeof head ? size : sizeof head);
  if (strncmp(head.token, fmu_scene.token, sizeof head.token) || head.exchange != f->exchange)
    return fmu_refuse(f, "the state is that of another model");
  if (!is_sound(bytes, size)) return fmu_refuse(f, "the state is damaged");
  void *made = malloc(head.size);
  if (!made) return fmu_refuse(f, "there is no memory for a state");
  memcpy(made, bytes, head.size);
  free(*state);
  *state = made;
  return 0;
}

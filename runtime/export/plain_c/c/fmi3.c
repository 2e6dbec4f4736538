/* FMI 3.0 Model Exchange: the functions that an importer calls. The others of the standard are there and refuse. */
#include "fmi3types.h"
#include "fmu.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#if defined(__GNUC__)
#pragma GCC visibility push(default) /* the functions of the standard, and these alone, are seen from outside */
#endif

typedef struct {
  fmu *model;
  fmi3InstanceEnvironment environment;
  fmi3LogMessageCallback tell;
} instance;

#define MODE(mode) (1 << (mode))
#define RUNNING (MODE(FMU_EVENT) | MODE(FMU_MOVING))
#define BEFORE (MODE(FMU_MADE) | MODE(FMU_INITIALIZING))
#define ANY (BEFORE | RUNNING | MODE(FMU_ENDED))

static fmi3Status say(const instance *c, fmi3Status status, const char *category, const char *message) {
  if (c->tell) c->tell(c->environment, status, category, message);
  return status;
}

static fmi3Status error(const instance *c) { return say(c, fmi3Error, "logStatusError", c->model->message); }

static fmi3Status answer(const instance *c, int refused) { return refused ? error(c) : fmi3OK; }

/* What cannot be evaluated at the states that the importer tries: it may try others. */
static fmi3Status discard(const instance *c) { return say(c, fmi3Discard, "logStatusDiscard", c->model->message); }

/* Say whether a function may not be called now. */
static int misplaced(instance *c, int modes, const char *function) {
  if (!c) return 1;
  if (modes >> c->model->mode & 1) return 0;
  fmu_refuse(c->model, "%s may not be called now", function);
  error(c);
  return 1;
}

static fmi3Status absent(instance *c, const char *function) {
  if (!c) return fmi3Error;
  fmu_refuse(c->model, "%s is not offered", function);
  return error(c);
}

#define NEEDS(modes) \
  instance *const c = given; \
  if (misplaced(c, modes, __func__)) return fmi3Error
#define NEEDS_SIZE(size, kind) \
  if ((size) != fmu_count(kind)) \
  return answer(c, fmu_refuse(c->model, "%s: %zu values, not %zu", __func__, size, fmu_count(kind)))

const char *fmi3GetVersion(void) { return "3.0"; }

fmi3Status fmi3SetDebugLogging(fmi3Instance given, fmi3Boolean on, size_t count, const fmi3String categories[]) {
  (void)on, (void)count, (void)categories; /* nothing but refusals and failures is told, and that always */
  return given ? fmi3OK : fmi3Error;
}

void fmi3FreeInstance(fmi3Instance given) {
  instance *c = given;
  if (!c) return;
  fmu_free(c->model);
  free(c);
}

fmi3Instance fmi3InstantiateModelExchange(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback tell) {
  instance *c = calloc(1, sizeof *c);
  const char *reason = NULL;
  (void)resources, (void)visible, (void)logging;
  if (!c) return NULL;
  c->environment = environment, c->tell = tell;
  if (!name || !*name) reason = "the instance needs a name";
  if (!token || strcmp(token, fmu_scene.token)) reason = "the token is that of another model description";
  if (!reason) c->model = fmu_make(1);
  if (!c->model) {
    say(c, fmi3Error, "logStatusError", reason ? reason : "there is no memory for an instance");
    fmi3FreeInstance(c);
    return NULL;
  }
  return c;
}

fmi3Status fmi3EnterInitializationMode(
    fmi3Instance given, fmi3Boolean has_tolerance, fmi3Float64 tolerance, fmi3Float64 start, fmi3Boolean has_stop,
    fmi3Float64 stop) {
  NEEDS(MODE(FMU_MADE));
  (void)has_stop, (void)stop;
  if (fmu_begin(c->model, start, has_tolerance ? tolerance : 0.0)) return error(c);
  c->model->mode = FMU_INITIALIZING;
  return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance given) {
  NEEDS(MODE(FMU_INITIALIZING));
  if (fmu_start(c->model)) return error(c);
  c->model->mode = FMU_EVENT;
  return fmi3OK;
}

fmi3Status fmi3EnterEventMode(fmi3Instance given) {
  NEEDS(MODE(FMU_MOVING));
  c->model->mode = FMU_EVENT;
  return fmi3OK;
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance given) {
  NEEDS(MODE(FMU_EVENT));
  c->model->mode = FMU_MOVING;
  return fmi3OK;
}

fmi3Status fmi3Terminate(fmi3Instance given) {
  NEEDS(RUNNING);
  c->model->mode = FMU_ENDED;
  return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance given) {
  NEEDS(ANY);
  fmu_reset(c->model);
  return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(
    fmi3Instance given, fmi3Boolean *again, fmi3Boolean *end, fmi3Boolean *nominals, fmi3Boolean *values,
    fmi3Boolean *has_next, fmi3Float64 *next) {
  NEEDS(MODE(FMU_EVENT));
  *again = *end = *nominals = *values = *has_next = false;
  if (fmu_update(c->model, next)) return error(c);
  *has_next = isfinite(*next);
  return fmi3OK;
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance given) {
  NEEDS(MODE(FMU_INITIALIZING) | MODE(FMU_EVENT));
  return fmi3OK;
}

fmi3Status fmi3CompletedIntegratorStep(
    fmi3Instance given, fmi3Boolean final, fmi3Boolean *event, fmi3Boolean *end) {
  NEEDS(MODE(FMU_MOVING));
  (void)final;
  *event = *end = false;
  return fmi3OK;
}

fmi3Status fmi3SetTime(fmi3Instance given, fmi3Float64 time) {
  NEEDS(RUNNING);
  if (!isfinite(time)) return answer(c, fmu_refuse(c->model, "the time %g is not finite", time));
  c->model->time = time;
  fmu_move(c->model);
  return fmi3OK;
}

fmi3Status fmi3SetContinuousStates(fmi3Instance given, const fmi3Float64 x[], size_t count) {
  NEEDS(RUNNING);
  NEEDS_SIZE(count, FMU_STATE);
  return answer(c, fmu_place(c->model, x));
}

fmi3Status fmi3GetContinuousStates(fmi3Instance given, fmi3Float64 x[], size_t count) {
  NEEDS(ANY);
  NEEDS_SIZE(count, FMU_STATE);
  if (fmu_start(c->model)) return error(c);
  memcpy(x, c->model->x, count * sizeof *x);
  return fmi3OK;
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance given, fmi3Float64 nominal[], size_t count) {
  NEEDS(ANY);
  NEEDS_SIZE(count, FMU_STATE);
  memcpy(nominal, fmu_scene.nominal, count * sizeof *nominal);
  return fmi3OK;
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance given, fmi3Float64 rates[], size_t count) {
  NEEDS(MODE(FMU_INITIALIZING) | RUNNING | MODE(FMU_ENDED));
  NEEDS_SIZE(count, FMU_RATE);
  if (fmu_find(c->model, FMU_RATE)) return discard(c);
  memcpy(rates, c->model->xdot, count * sizeof *rates);
  return fmi3OK;
}

fmi3Status fmi3GetEventIndicators(fmi3Instance given, fmi3Float64 z[], size_t count) {
  NEEDS(MODE(FMU_INITIALIZING) | RUNNING | MODE(FMU_ENDED));
  NEEDS_SIZE(count, FMU_INDICATOR);
  if (fmu_find(c->model, FMU_INDICATOR)) return discard(c);
  memcpy(z, c->model->z, count * sizeof *z);
  return fmi3OK;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance given, size_t *count) {
  NEEDS(ANY);
  *count = fmu_count(FMU_INDICATOR);
  return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance given, size_t *count) {
  NEEDS(ANY);
  *count = fmu_count(FMU_STATE);
  return fmi3OK;
}

fmi3Status fmi3GetFloat64(
    fmi3Instance given, const fmi3ValueReference vr[], size_t count, fmi3Float64 value[], size_t n_values) {
  NEEDS(ANY);
  if (n_values != count) return answer(c, fmu_refuse(c->model, "%zu values for %zu variables", n_values, count));
  return answer(c, fmu_get(c->model, vr, count, value));
}

fmi3Status fmi3SetFloat64(
    fmi3Instance given, const fmi3ValueReference vr[], size_t count, const fmi3Float64 value[], size_t n_values) {
  NEEDS(BEFORE | RUNNING);
  if (n_values != count) return answer(c, fmu_refuse(c->model, "%zu values for %zu variables", n_values, count));
  return answer(c, fmu_set(c->model, vr, count, value));
}

/* There are no variables of other types, so none is as much as can be got or set. */
#define NONE(NAME, TYPE) \
  fmi3Status NAME(fmi3Instance c, const fmi3ValueReference vr[], size_t count, TYPE value[], size_t n_values) { \
    (void)vr, (void)value, (void)n_values; \
    return c && !count ? fmi3OK : absent(c, #NAME); \
  }
#define NONE_OF(TYPE) NONE(fmi3Get##TYPE, fmi3##TYPE) NONE(fmi3Set##TYPE, const fmi3##TYPE)
NONE_OF(Float32)
NONE_OF(Int8)
NONE_OF(UInt8)
NONE_OF(Int16)
NONE_OF(UInt16)
NONE_OF(Int32)
NONE_OF(UInt32)
NONE_OF(Int64)
NONE_OF(UInt64)
NONE_OF(Boolean)
NONE_OF(String)

fmi3Status fmi3FreeFMUState(fmi3Instance given, fmi3FMUState *state) {
  if (!given) return fmi3Error;
  if (state) free(*state), *state = NULL;
  return fmi3OK;
}

fmi3Status fmi3GetFMUState(fmi3Instance given, fmi3FMUState *state) {
  NEEDS(ANY);
  return answer(c, fmu_keep(c->model, state));
}

fmi3Status fmi3SetFMUState(fmi3Instance given, fmi3FMUState state) {
  NEEDS(ANY);
  return answer(c, fmu_return(c->model, state));
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance given, fmi3FMUState state, size_t *size) {
  NEEDS(ANY);
  *size = fmu_packed_size(state);
  return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance given, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
  NEEDS(ANY);
  return answer(c, fmu_pack(c->model, state, bytes, size));
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance given, const fmi3Byte bytes[], size_t size, fmi3FMUState *state) {
  NEEDS(ANY);
  return answer(c, fmu_unpack(c->model, bytes, size, state));
}

/* What is not offered. */
#define ABSENT(NAME, ...) \
  fmi3Status NAME(fmi3Instance given, __VA_ARGS__) { return absent(given, #NAME); }
#define VARIABLES const fmi3ValueReference vr[], size_t count

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3Boolean events, fmi3Boolean early, const fmi3ValueReference intermediate[], size_t n_intermediate,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback tell, fmi3IntermediateUpdateCallback update) {
  if (tell) tell(environment, fmi3Error, "logStatusError", "this FMU is for model exchange");
  return NULL;
}

fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback tell, fmi3ClockUpdateCallback clock,
    fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock) {
  if (tell) tell(environment, fmi3Error, "logStatusError", "this FMU is for model exchange");
  return NULL;
}

ABSENT(fmi3GetBinary, VARIABLES, size_t sizes[], fmi3Binary value[], size_t n_values)
ABSENT(fmi3SetBinary, VARIABLES, const size_t sizes[], const fmi3Binary value[], size_t n_values)
ABSENT(fmi3GetClock, VARIABLES, fmi3Clock value[])
ABSENT(fmi3SetClock, VARIABLES, const fmi3Clock value[])
ABSENT(fmi3GetNumberOfVariableDependencies, fmi3ValueReference vr, size_t *count)
ABSENT(fmi3GetVariableDependencies, fmi3ValueReference vr, size_t of[], fmi3ValueReference on[], size_t places[],
       fmi3DependencyKind kinds[], size_t count)
ABSENT(fmi3GetDirectionalDerivative, VARIABLES, const fmi3ValueReference known[], size_t n_known,
       const fmi3Float64 seed[], size_t n_seed, fmi3Float64 result[], size_t n_result)
ABSENT(fmi3GetAdjointDerivative, VARIABLES, const fmi3ValueReference known[], size_t n_known,
       const fmi3Float64 seed[], size_t n_seed, fmi3Float64 result[], size_t n_result)
ABSENT(fmi3GetIntervalDecimal, VARIABLES, fmi3Float64 interval[], fmi3IntervalQualifier qualifier[])
ABSENT(fmi3GetIntervalFraction, VARIABLES, fmi3UInt64 counter[], fmi3UInt64 resolution[],
       fmi3IntervalQualifier qualifier[])
ABSENT(fmi3GetShiftDecimal, VARIABLES, fmi3Float64 shift[])
ABSENT(fmi3GetShiftFraction, VARIABLES, fmi3UInt64 counter[], fmi3UInt64 resolution[])
ABSENT(fmi3SetIntervalDecimal, VARIABLES, const fmi3Float64 interval[])
ABSENT(fmi3SetIntervalFraction, VARIABLES, const fmi3UInt64 counter[], const fmi3UInt64 resolution[])
ABSENT(fmi3SetShiftDecimal, VARIABLES, const fmi3Float64 shift[])
ABSENT(fmi3SetShiftFraction, VARIABLES, const fmi3UInt64 counter[], const fmi3UInt64 resolution[])
ABSENT(fmi3GetOutputDerivatives, VARIABLES, const fmi3Int32 order[], fmi3Float64 value[], size_t n_values)
ABSENT(fmi3DoStep, fmi3Float64 from, fmi3Float64 step, fmi3Boolean final, fmi3Boolean *event, fmi3Boolean *end,
       fmi3Boolean *early, fmi3Float64 *reached)
ABSENT(fmi3ActivateModelPartition, fmi3ValueReference clock, fmi3Float64 time)

fmi3Status fmi3EnterConfigurationMode(fmi3Instance given) { return absent(given, __func__); }

fmi3Status fmi3ExitConfigurationMode(fmi3Instance given) { return absent(given, __func__); }

fmi3Status fmi3EnterStepMode(fmi3Instance given) { return absent(given, __func__); }

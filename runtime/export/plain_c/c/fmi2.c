/* FMI 2.0 Co-Simulation: the functions that an importer calls. Functions of Model Exchange are there, as the standard
 * asks for, and refuse. */
#include "fmi2types.h"
#include "fmu.h"

#include <stdlib.h>
#include <string.h>

#if defined(__GNUC__)
#pragma GCC visibility push(default) /* the functions of the standard, and these alone, are seen from outside */
#endif

typedef struct {
  fmu *model;
  fmi2CallbackFunctions told;
  char *name;
  int stopped; /* the last step could not be finished; the time is the last one it reached */
} instance;

#define MODE(mode) (1 << (mode))
#define ANY (MODE(FMU_MADE) | MODE(FMU_INITIALIZING) | MODE(FMU_MOVING) | MODE(FMU_ENDED))
#define BEFORE (MODE(FMU_MADE) | MODE(FMU_INITIALIZING))

static fmi2Status say(const instance *c, fmi2Status status, const char *category, const char *message) {
  if (c->told.logger) c->told.logger(c->told.componentEnvironment, c->name, status, category, message);
  return status;
}

static fmi2Status error(const instance *c) { return say(c, fmi2Error, "logStatusError", c->model->message); }

static fmi2Status answer(const instance *c, int refused) { return refused ? error(c) : fmi2OK; }

/* Say whether a function may not be called now. */
static int misplaced(instance *c, int modes, const char *function) {
  if (!c) return 1;
  if (modes >> c->model->mode & 1) return 0;
  fmu_refuse(c->model, "%s may not be called now", function);
  error(c);
  return 1;
}

static fmi2Status absent(instance *c, const char *function) {
  if (!c) return fmi2Error;
  fmu_refuse(c->model, "%s is not offered", function);
  return error(c);
}

#define NEEDS(modes) \
  instance *const c = component; \
  if (misplaced(c, modes, __func__)) return fmi2Error

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

const char *fmi2GetVersion(void) { return "2.0"; }

fmi2Status fmi2SetDebugLogging(
    fmi2Component component, fmi2Boolean on, size_t count, const fmi2String categories[]) {
  (void)on, (void)count, (void)categories; /* nothing but refusals and failures is told, and that always */
  return component ? fmi2OK : fmi2Error;
}

void fmi2FreeInstance(fmi2Component component) {
  instance *c = component;
  if (!c) return;
  fmu_free(c->model);
  free(c->name);
  free(c);
}

fmi2Component fmi2Instantiate(
    fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources, const fmi2CallbackFunctions *told,
    fmi2Boolean visible, fmi2Boolean logging) {
  instance *c = calloc(1, sizeof *c);
  const char *called = name && *name ? name : fmu_scene.token, *reason = NULL;
  (void)resources, (void)visible, (void)logging;
  if (!c) return NULL;
  if (told) c->told = *told;
  c->name = malloc(strlen(called) + 1);
  if (c->name) strcpy(c->name, called);
  if (!name || !*name) reason = "the instance needs a name";
  if (type != fmi2CoSimulation) reason = "this FMU is for co-simulation";
  if (!guid || strcmp(guid, fmu_scene.token)) reason = "the guid is that of another model description";
  if (!reason && c->name) c->model = fmu_make(0);
  if (!c->model) {
    say(c, fmi2Error, "logStatusError", reason ? reason : "there is no memory for an instance");
    fmi2FreeInstance(c);
    return NULL;
  }
  return c;
}

fmi2Status fmi2SetupExperiment(
    fmi2Component component, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start, fmi2Boolean has_stop,
    fmi2Real stop) {
  NEEDS(MODE(FMU_MADE));
  (void)has_stop, (void)stop;
  return answer(c, fmu_begin(c->model, start, has_tolerance ? tolerance : 0.0));
}

fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
  NEEDS(MODE(FMU_MADE));
  c->model->mode = FMU_INITIALIZING;
  return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
  NEEDS(MODE(FMU_INITIALIZING));
  if (fmu_start(c->model)) return error(c);
  c->model->mode = FMU_MOVING;
  return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component component) {
  NEEDS(MODE(FMU_MOVING));
  c->model->mode = FMU_ENDED;
  return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component component) {
  NEEDS(ANY);
  fmu_reset(c->model);
  c->stopped = 0;
  return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference vr[], size_t count, fmi2Real value[]) {
  NEEDS(ANY);
  return answer(c, fmu_get(c->model, vr, count, value));
}

fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference vr[], size_t count, const fmi2Real value[]) {
  NEEDS(BEFORE | MODE(FMU_MOVING));
  return answer(c, fmu_set(c->model, vr, count, value));
}

/* There are no variables of other types, so none is as much as can be got or set. */
#define NONE(NAME, TYPE) \
  fmi2Status NAME(fmi2Component c, const fmi2ValueReference vr[], size_t count, TYPE value[]) { \
    (void)vr, (void)value; \
    return c && !count ? fmi2OK : absent(c, #NAME); \
  }
NONE(fmi2GetInteger, fmi2Integer)
NONE(fmi2GetBoolean, fmi2Boolean)
NONE(fmi2GetString, fmi2String)
NONE(fmi2SetInteger, const fmi2Integer)
NONE(fmi2SetBoolean, const fmi2Boolean)
NONE(fmi2SetString, const fmi2String)

fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate *state) {
  if (!component) return fmi2Error;
  if (state) free(*state), *state = NULL;
  return fmi2OK;
}

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *state) {
  NEEDS(ANY);
  return answer(c, fmu_keep(c->model, state));
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
  NEEDS(ANY);
  if (fmu_return(c->model, state)) return error(c);
  c->stopped = 0;
  return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t *size) {
  NEEDS(ANY);
  *size = fmu_packed_size(state);
  return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
  NEEDS(ANY);
  return answer(c, fmu_pack(c->model, state, bytes, size));
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
  NEEDS(ANY);
  return answer(c, fmu_unpack(c->model, bytes, size, state));
}

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real from, fmi2Real step, fmi2Boolean final) {
  NEEDS(MODE(FMU_MOVING));
  (void)final;
  int status = fmu_step(c->model, from, step);
  if (status == FMU_REFUSED) return error(c);
  c->stopped = status == FMU_STOPPED;
  return c->stopped ? say(c, fmi2Discard, "logStatusDiscard", c->model->message) : fmi2OK;
}

fmi2Status fmi2GetRealStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Real *value) {
  NEEDS(ANY);
  if (kind != fmi2LastSuccessfulTime) return absent(c, "this status");
  *value = c->model->time;
  return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Boolean *value) {
  NEEDS(ANY);
  if (kind != fmi2Terminated) return absent(c, "this status");
  *value = c->stopped;
  return fmi2OK;
}

/* What is not offered. */
#define ABSENT(NAME, ...) \
  fmi2Status NAME(fmi2Component component, __VA_ARGS__) { return absent(component, #NAME); }

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

ABSENT(fmi2GetDirectionalDerivative, const fmi2ValueReference unknown[], size_t n_unknown,
       const fmi2ValueReference known[], size_t n_known, const fmi2Real seed[], fmi2Real result[])
ABSENT(fmi2SetRealInputDerivatives, const fmi2ValueReference vr[], size_t count, const fmi2Integer order[],
       const fmi2Real value[])
ABSENT(fmi2GetRealOutputDerivatives, const fmi2ValueReference vr[], size_t count, const fmi2Integer order[],
       fmi2Real value[])
ABSENT(fmi2GetStatus, const fmi2StatusKind kind, fmi2Status *value)
ABSENT(fmi2GetIntegerStatus, const fmi2StatusKind kind, fmi2Integer *value)
ABSENT(fmi2GetStringStatus, const fmi2StatusKind kind, fmi2String *value)
ABSENT(fmi2NewDiscreteStates, fmi2EventInfo *info)
ABSENT(fmi2CompletedIntegratorStep, fmi2Boolean final, fmi2Boolean *event, fmi2Boolean *end)
ABSENT(fmi2SetTime, fmi2Real time)
ABSENT(fmi2SetContinuousStates, const fmi2Real x[], size_t count)
ABSENT(fmi2GetDerivatives, fmi2Real rates[], size_t count)
ABSENT(fmi2GetEventIndicators, fmi2Real z[], size_t count)
ABSENT(fmi2GetContinuousStates, fmi2Real x[], size_t count)
ABSENT(fmi2GetNominalsOfContinuousStates, fmi2Real nominal[], size_t count)

fmi2Status fmi2CancelStep(fmi2Component component) { return absent(component, __func__); }

fmi2Status fmi2EnterEventMode(fmi2Component component) { return absent(component, __func__); }

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component component) { return absent(component, __func__); }

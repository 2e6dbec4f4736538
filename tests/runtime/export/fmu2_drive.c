/* An importer of co-simulation that uses all of an instance, wrongly too. Returns the line that failed. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"
#include "fmu.h"

#define CHECK(true) \
  do { \
    if (!(true)) return printf("line %d\n", __LINE__), 1; \
  } while (0)
#define STEP 5e-5

static size_t told; /* letters of messages */

static void hear(void *where, fmi2String name, fmi2Status status, fmi2String category, fmi2String message, ...) {
  char text[1000];
  va_list rest;
  (void)where, (void)status;
  va_start(rest, message);
  vsnprintf(text, sizeof text, message, rest);
  va_end(rest);
  told += strlen(text) + strlen(name) + strlen(category);
}

static const fmi2CallbackFunctions ears = {hear, calloc, free, NULL, NULL};

static fmi2Component make(const char *token) {
  return fmi2Instantiate("gears", fmi2CoSimulation, token, "", &ears, fmi2False, fmi2False);
}

/* Get every variable that there is; return how many there are. */
static unsigned get_all(fmi2Component c) {
  unsigned found = 0;
  fmi2Real value;
  for (fmi2ValueReference vr = 0; vr < fmu_scene.first[FMU_KINDS] + 3; ++vr)
    found += fmi2GetReal(c, &vr, 1, &value) == fmi2OK && isfinite(value);
  return found;
}

static int test_life(void) {
  fmi2Component c = make(fmu_scene.token);
  const fmi2ValueReference input[2] = {fmu_scene.first[FMU_INPUT], fmu_scene.first[FMU_INPUT] + 1};
  fmi2Real start[2];
  CHECK(!make("another") && !make(NULL) && c && fmi2DoStep(c, 0, STEP, fmi2False) == fmi2Error);
  CHECK(!fmi2SetupExperiment(c, fmi2True, 1e-7, 0, fmi2False, 0) && !fmi2EnterInitializationMode(c));
  CHECK(!fmi2GetReal(c, input, 2, start) && fmi2SetReal(c, input, 2, (fmi2Real[]){1, NAN}) == fmi2Error);
  CHECK(!fmi2SetReal(c, input, 2, start) && !fmi2ExitInitializationMode(c) && get_all(c) > 20);
  for (int k = 0; k < 20; ++k) CHECK(!fmi2DoStep(c, k * STEP, STEP, fmi2False));
  CHECK(fmi2DoStep(c, 1, STEP, fmi2False) == fmi2Error && !fmi2SetReal(c, input + 1, 1, (fmi2Real[]){1e300}));
  CHECK(fmi2DoStep(c, 20 * STEP, STEP, fmi2False) == fmi2Discard && get_all(c) > 20);
  CHECK(!fmi2Terminate(c) && get_all(c) > 20 && !fmi2Reset(c) && get_all(c) > 20);
  CHECK(!fmi2EnterInitializationMode(c) && !fmi2ExitInitializationMode(c) && !fmi2DoStep(c, 0, STEP, fmi2False));
  fmi2FreeInstance(c);
  fmi2FreeInstance(NULL);
  return 0;
}

static int test_states(void) {
  fmi2Component c = make(fmu_scene.token);
  fmi2FMUstate early = NULL, kept = NULL, moved = NULL;
  size_t size;
  CHECK(!fmi2GetFMUstate(c, &early) && !fmi2EnterInitializationMode(c) && !fmi2ExitInitializationMode(c));
  CHECK(!fmi2DoStep(c, 0, STEP, fmi2False) && !fmi2GetFMUstate(c, &kept) && !fmi2SerializedFMUstateSize(c, kept, &size));
  fmi2Byte *bytes = malloc(size);
  CHECK(fmi2SerializeFMUstate(c, kept, bytes, size - 1) && !fmi2SerializeFMUstate(c, kept, bytes, size));
  for (size_t i = 0; i < size; ++i) {
    bytes[i] ^= (fmi2Byte)(1 << i % 7);
    CHECK(fmi2DeSerializeFMUstate(c, bytes, size, &moved) == fmi2Error && !moved);
    bytes[i] ^= (fmi2Byte)(1 << i % 7);
  }
  for (size_t less = 0; less < size; less += 97) {
    fmi2Byte *part = malloc(less + 1);
    memcpy(part, bytes, less);
    CHECK(fmi2DeSerializeFMUstate(c, part, less, &moved) == fmi2Error);
    free(part);
  }
  CHECK(!fmi2DeSerializeFMUstate(c, bytes, size, &moved) && !fmi2DeSerializeFMUstate(c, bytes, size, &moved));
  CHECK(!fmi2DoStep(c, STEP, STEP, fmi2False) && !fmi2SetFMUstate(c, moved) && !fmi2DoStep(c, STEP, STEP, fmi2False));
  CHECK(fmi2SetFMUstate(c, NULL) == fmi2Error && !fmi2GetFMUstate(c, &moved) && !fmi2GetFMUstate(c, &early));
  CHECK(!fmi2SetFMUstate(c, early) && get_all(c) > 20);
  CHECK(!fmi2FreeFMUstate(c, &early) && !fmi2FreeFMUstate(c, &kept) && !fmi2FreeFMUstate(c, &moved) && !moved);
  free(bytes);
  fmi2FreeInstance(c);
  return 0;
}

int main(void) { return test_life() || test_states() || !told; }

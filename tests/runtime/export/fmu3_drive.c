/* An importer of model exchange that uses all of an instance, wrongly too. Returns the line that failed. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi3Functions.h"
#include "fmu.h"

#define CHECK(true) \
  do { \
    if (!(true)) return printf("line %d\n", __LINE__), 1; \
  } while (0)

static size_t told; /* letters of messages */

static void hear(fmi3InstanceEnvironment where, fmi3Status status, fmi3String category, fmi3String message) {
  (void)where, (void)status;
  told += strlen(message) + strlen(category);
}

static fmi3Instance make(const char *token) {
  return fmi3InstantiateModelExchange("gears", token, NULL, fmi3False, fmi3False, NULL, hear);
}

/* Get every variable that there is; return how many there are. */
static unsigned get_all(fmi3Instance c) {
  unsigned found = 0;
  fmi3Float64 value;
  for (fmi3ValueReference vr = 0; vr < fmu_scene.first[FMU_KINDS] + 3; ++vr)
    found += fmi3GetFloat64(c, &vr, 1, &value, 1) == fmi3OK && isfinite(value);
  return found;
}

static int update(fmi3Instance c) {
  fmi3Boolean said[5];
  fmi3Float64 next;
  return fmi3UpdateDiscreteStates(c, said, said + 1, said + 2, said + 3, said + 4, &next);
}

static int begin(fmi3Instance c) {
  return fmi3EnterInitializationMode(c, fmi3True, 1e-7, 0, fmi3False, 0) || fmi3ExitInitializationMode(c) ||
         update(c) || fmi3EnterContinuousTimeMode(c);
}

static int test_life(void) {
  fmi3Instance c = make(fmu_scene.token);
  size_t n = fmu_count(FMU_STATE), n_z = fmu_count(FMU_INDICATOR);
  fmi3Float64 *x = malloc(n * sizeof *x), *rates = malloc(n * sizeof *x), *z = malloc(n_z * sizeof *z);
  const fmi3ValueReference input[2] = {fmu_scene.first[FMU_INPUT], fmu_scene.first[FMU_INPUT] + 1};
  CHECK(!make("another") && !make(NULL) && c && fmi3SetTime(c, 0) == fmi3Error && !begin(c) && get_all(c) > 20);
  CHECK(!fmi3GetContinuousStates(c, x, n) && fmi3GetContinuousStates(c, x, n + 1) == fmi3Error);
  for (int k = 0; k < 200; ++k) {
    CHECK(!fmi3SetTime(c, k * 1e-5) && !fmi3SetContinuousStates(c, x, n) && !fmi3GetEventIndicators(c, z, n_z));
    CHECK(!fmi3GetContinuousStateDerivatives(c, rates, n) && get_all(c) > 20);
    for (size_t i = 0; i < n; ++i) x[i] += 1e-5 * rates[i];
    CHECK(k % 20 || (!fmi3EnterEventMode(c) && !update(c) && !fmi3EnterContinuousTimeMode(c)));
  }
  CHECK(fmi3SetFloat64(c, input, 2, (fmi3Float64[]){1, NAN}, 2) == fmi3Error && fmi3SetTime(c, NAN) == fmi3Error);
  x[0] = NAN;
  CHECK(fmi3SetContinuousStates(c, x, n) == fmi3Error && get_all(c) > 20);
  CHECK(!fmi3Terminate(c) && get_all(c) > 20 && !fmi3Reset(c) && get_all(c) > 20 && !begin(c));
  fmi3FreeInstance(c);
  fmi3FreeInstance(NULL);
  free(x), free(rates), free(z);
  return 0;
}

static int test_states(void) {
  fmi3Instance c = make(fmu_scene.token);
  fmi3FMUState early = NULL, kept = NULL, moved = NULL;
  size_t size;
  CHECK(!fmi3GetFMUState(c, &early) && !begin(c) && !fmi3GetFMUState(c, &kept));
  CHECK(!fmi3SerializedFMUStateSize(c, kept, &size));
  fmi3Byte *bytes = malloc(size);
  CHECK(fmi3SerializeFMUState(c, kept, bytes, size - 1) && !fmi3SerializeFMUState(c, kept, bytes, size));
  for (size_t i = 0; i < size; ++i) {
    bytes[i] ^= (fmi3Byte)(1 << i % 8);
    CHECK(fmi3DeserializeFMUState(c, bytes, size, &moved) == fmi3Error && !moved);
    bytes[i] ^= (fmi3Byte)(1 << i % 8);
  }
  CHECK(!fmi3DeserializeFMUState(c, bytes, size, &moved) && !fmi3SetFMUState(c, moved) && get_all(c) > 20);
  CHECK(!fmi3SetFMUState(c, early) && !fmi3GetFMUState(c, &moved) && !begin(c) && get_all(c) > 20);
  CHECK(!fmi3FreeFMUState(c, &early) && !fmi3FreeFMUState(c, &kept) && !fmi3FreeFMUState(c, &moved) && !moved);
  free(bytes);
  fmi3FreeInstance(c);
  return 0;
}

int main(void) { return test_life() || test_states() || !told; }

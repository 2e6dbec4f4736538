/* Runs side by side: each as if it were alone, in threads too; saved, restored, refused. Returns the line that failed. */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ltcgear.h"

#define CHECK(true) \
  do { \
    if (!(true)) return printf("line %d\n", __LINE__), 1; \
  } while (0)
#define END 0.02

static const ltcgear_model *const model = &ltcgear_scene;

/* What the states add up to, each with a weight of its own. */
static double fingerprint(const ltcgear_run *run) {
  double *x = malloc((size_t)model->n_states * sizeof *x), sum = 0;
  ltcgear_state(run, x);
  for (ltcgear_whole i = 0; i < model->n_states; ++i) sum += x[i] * (double)(i + 1);
  free(x);
  return sum;
}

static ltcgear_whole loose_parameter(void) {
  ltcgear_whole i = 0;
  while (model->parameter_fixed[i] || !strstr(model->parameters[i].name, "stiffness")) ++i;
  return i;
}

/* One run with a parameter changed by a factor. */
static void *alone(void *factor) {
  double *result = factor;
  ltcgear_run *run = ltcgear_create(model, 1e-6);
  int bad = ltcgear_set(run, loose_parameter(), *result * ltcgear_get(run, loose_parameter()));
  bad |= ltcgear_start(run, 0) | ltcgear_advance(run, END);
  *result = bad ? NAN : fingerprint(run);
  ltcgear_destroy(run);
  return 0;
}

static int test_threads(void) {
  double serial[4] = {1, 1.1, 0.9, 1.2}, parallel[4] = {1, 1.1, 0.9, 1.2};
  pthread_t threads[4];
  for (int i = 0; i < 4; ++i) alone(serial + i);
  for (int i = 0; i < 4; ++i) CHECK(!pthread_create(threads + i, 0, alone, parallel + i));
  for (int i = 0; i < 4; ++i) pthread_join(threads[i], 0);
  for (int i = 0; i < 4; ++i) CHECK(isfinite(serial[i]) && serial[i] == parallel[i]);
  CHECK(serial[0] != serial[1]);
  return 0;
}

static int stop(void *to, double time, const double *x, const double *y) {
  (void)x, (void)y;
  *(double *)to = time;
  return time > END / 2 ? -7 : 0;
}

static int test_saving(void) {
  ltcgear_run *one = ltcgear_create(model, 1e-6), *two = ltcgear_create(model, 1e-4);
  size_t size = ltcgear_size(one);
  unsigned char *kept = malloc(size);
  CHECK(size == ltcgear_size(two));
  CHECK(!ltcgear_start(one, 0) && !ltcgear_advance(one, END / 3));
  ltcgear_save(one, kept);
  CHECK(!ltcgear_advance(one, END));
  CHECK(!ltcgear_restore(two, kept) && ltcgear_time(two) == END / 3 && !ltcgear_advance(two, END));
  CHECK(fingerprint(one) == fingerprint(two) && ltcgear_steps(one) == ltcgear_steps(two));
  CHECK(!ltcgear_restore(one, kept) && !ltcgear_advance(one, END) && fingerprint(one) == fingerprint(two));
  for (size_t i = 0; i < size; ++i) {
    kept[i] ^= (unsigned char)(1 << i % 8);
    CHECK(ltcgear_restore(one, kept) && fingerprint(one) == fingerprint(two));
    kept[i] ^= (unsigned char)(1 << i % 8);
  }
  CHECK(!ltcgear_restore(one, kept) && fingerprint(one) != fingerprint(two));
  ltcgear_destroy(one), ltcgear_destroy(two);
  free(kept);
  return 0;
}

static int count_on(void *to, double time, const double *x, const double *y) {
  double *taken = to;
  (void)x, (void)y;
  if (!taken[0]) taken[1] = time;
  taken[0] += 1, taken[2] = time;
  return taken[0] == 3 ? 1 : 0;
}

/* Who stops taking samples misses none: the run is at the last one. */
static int test_stopping(void) {
  ltcgear_run *one = ltcgear_create(model, 1e-8), *two = ltcgear_create(model, 1e-8);
  double first[3] = {0}, rest[3] = {4};
  CHECK(!ltcgear_start(one, 0) && !ltcgear_start(two, 0) && !ltcgear_record(two, END, 1e4, count_on, rest));
  CHECK(ltcgear_record(one, END, 1e4, count_on, first) == -1 && ltcgear_time(one) == 3e-4 && first[2] == 3e-4);
  CHECK(!strcmp(ltcgear_reason(-1), "stopped by who takes the samples") && ltcgear_steps(one) < ltcgear_steps(two));
  CHECK(!ltcgear_advance(two, END) && rest[0] == 4 + END * 1e4);
  rest[0] = 0;
  CHECK(ltcgear_record(one, END, 1e4, count_on, rest) == -1 && rest[1] == 4e-4 && rest[2] == 6e-4);
  CHECK(!ltcgear_record(one, END, 1e4, count_on, rest) && rest[0] == END * 1e4 - 3 && rest[2] == END);
  CHECK(fabs(fingerprint(one) / fingerprint(two) - 1) < 1e-6);
  ltcgear_destroy(one), ltcgear_destroy(two);
  return 0;
}

/* States that are not finite have neither indicators nor outputs. */
static int test_lost_states(void) {
  ltcgear_run *run = ltcgear_create(model, 1e-6);
  double *x = malloc((size_t)model->n_states * sizeof *x), *y = malloc((size_t)model->n_outputs * sizeof *y);
  double *z = malloc((size_t)ltcgear_indicator_count(run) * sizeof *z);
  CHECK(model->n_levels > 0 && !ltcgear_start(run, 0));
  ltcgear_state(run, x);
  CHECK(!ltcgear_update(run, 0, x, 0) && !ltcgear_indicators(run, 0, x, z) && !ltcgear_outputs(run, 0, x, y));
  const double angle = x[model->angle];
  x[model->angle] = NAN; /* on which the meshes hang, and no contact does */
  CHECK(ltcgear_indicators(run, 0, x, z) && ltcgear_outputs(run, 0, x, y) && ltcgear_update(run, 0, x, 0));
  CHECK(isnan(z[0]) && isfinite(z[2 * model->n_levels]));
  x[model->angle] = angle;
  CHECK(!ltcgear_indicators(run, 0, x, z) && !ltcgear_outputs(run, 0, x, y));
  for (ltcgear_whole i = 0; i < model->n_states; ++i) x[i] = NAN;
  CHECK(ltcgear_indicators(run, 0, x, z) && ltcgear_outputs(run, 0, x, y) && ltcgear_update(run, 0, x, 0));
  ltcgear_destroy(run);
  free(x), free(y), free(z);
  return 0;
}

/* Statistics are the same from the same bytes, and nothing of them is left behind. */
static int test_statistics(void) {
  ltcgear_statistics one[8] = {{0}}, two[8] = {{0}};
  ltcgear_run *run = ltcgear_create(model, 1e-6), *other = ltcgear_create(model, 1e-4);
  unsigned char *kept = malloc(ltcgear_size(run));
  CHECK(model->n_forces <= 8 && ltcgear_measure(run, END, one) && !ltcgear_start(run, 0));
  CHECK(!ltcgear_advance(run, END / 4));
  ltcgear_save(run, kept);
  CHECK(!ltcgear_measure_steady(run, END / 2, END, one) && !ltcgear_measure(run, 1.1 * END, two));
  CHECK(memcmp(one, two, sizeof one) && one[0].least <= one[0].mean && one[0].mean <= one[0].most);
  CHECK(!ltcgear_restore(other, kept) && !ltcgear_measure_steady(other, END / 2, END, two) && !memcmp(one, two, sizeof one));
  CHECK(!ltcgear_restore(run, kept) && !ltcgear_measure(run, END, one));
  CHECK(!ltcgear_restore(other, kept) && !ltcgear_advance(other, END) && fingerprint(run) == fingerprint(other));
  CHECK(ltcgear_measure(run, END, two) && ltcgear_measure(run, NAN, two) && ltcgear_measure(run, INFINITY, two));
  CHECK(ltcgear_measure_steady(run, END / 2, 2 * END, two) && ltcgear_measure_steady(run, 2 * END, 2 * END, two));
  CHECK(ltcgear_measure_steady(run, 3 * END, 2 * END, two) && ltcgear_measure_steady(run, NAN, 2 * END, two));
  CHECK(ltcgear_measure_steady(run, 2 * END * (1 - 1e-15), 2 * END, two) && ltcgear_time(run) == END);
  CHECK(!ltcgear_measure_steady(run, 2 * END * (1 - 1e-12), 2 * END, two) && isfinite(two[0].mean) && isfinite(two[0].rms));
  ltcgear_destroy(run), ltcgear_destroy(other);
  free(kept);
  return 0;
}

static int test_refusals(void) {
  double last = 0, *y = malloc((size_t)model->n_outputs * sizeof *y);
  ltcgear_run *run = ltcgear_create(model, 1e-6);
  CHECK(!ltcgear_create(model, 0) && !ltcgear_create(model, 1) && !ltcgear_create(model, NAN));
  CHECK(ltcgear_advance(run, 1) && ltcgear_read(run, y) && ltcgear_record(run, 1, 100, stop, &last));
  CHECK(ltcgear_set(run, -1, 1) && ltcgear_set(run, model->n_parameters, 1) && isnan(ltcgear_get(run, -1)));
  CHECK(ltcgear_steer(run, model->n_tables, 0, 0, 0) && ltcgear_start(run, INFINITY) && !ltcgear_start(run, 0.5));
  CHECK(ltcgear_start(run, 0) && ltcgear_set(run, loose_parameter(), 1) && ltcgear_advance(run, 0.4));
  CHECK(ltcgear_advance(run, NAN) && ltcgear_record(run, 1, 0, stop, &last) && !ltcgear_read(run, y));
  CHECK(ltcgear_time(run) == 0.5 && !ltcgear_advance(run, 0.5) && ltcgear_time(run) == 0.5);
  ltcgear_destroy(run);
  run = ltcgear_create(model, 1e-6);
  CHECK(!ltcgear_start(run, 0) && ltcgear_record(run, END, 1e5, stop, &last) == -7 && last > END / 2 && last < 0.51 * END);
  for (int status = -9; status < 40; ++status) CHECK(strlen(ltcgear_reason(status)) > 3);
  ltcgear_destroy(run), ltcgear_destroy(0);
  free(y);
  return 0;
}

int main(void) {
  return test_threads() || test_saving() || test_stopping() || test_lost_states() || test_statistics() || test_refusals();
}

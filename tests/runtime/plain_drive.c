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
  kept[0] ^= 1;
  CHECK(ltcgear_restore(one, kept) && fingerprint(one) == fingerprint(two));
  ltcgear_destroy(one), ltcgear_destroy(two);
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

int main(void) { return test_threads() || test_saving() || test_refusals(); }

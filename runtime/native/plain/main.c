/* An example: integrate the scene and print its mesh forces over the second half of the time.
 *
 *     cc -O3 *.c -lm -o gearbox && ./gearbox [T_END] [NAME=VALUE ...]
 *
 * T_END is a time [s], the scene's where left out; NAME=VALUE sets a parameter, in SI units. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "ltcgear.h"

#define MOST_STEPS 1e9

/* What is gathered of every mesh force from a time on. */
typedef struct {
  const ltcgear_model *model;
  double from, samples, *sum, *least, *most;
} gathered;

/* Print what is wrong, and return the exit code of a wrong call. */
static int refuse(const char *what, const char *why) {
  fprintf(stderr, "%s: %s\n", what, why);
  return 2;
}

/* Read a whole text as a number; where it is none, the value stays. */
static int read_number(const char *text, double *value) {
  char *end;
  double found = strtod(text, &end);
  if (end == text || *end || !isfinite(found)) return 0;
  *value = found;
  return 1;
}

static ltcgear_whole find_parameter(const ltcgear_model *model, const char *name, size_t length) {
  for (ltcgear_whole i = 0; i < model->n_parameters; ++i)
    if (strlen(model->parameters[i].name) == length && !strncmp(model->parameters[i].name, name, length)) return i;
  return -1;
}

/* Take one argument: NAME=VALUE. */
static int set_parameter(ltcgear_run *run, const ltcgear_model *model, const char *argument) {
  const char *sign = strchr(argument, '=');
  double value = 0;
  if (!sign) return refuse(argument, "write NAME=VALUE, or a time in seconds first");
  ltcgear_whole parameter = find_parameter(model, argument, (size_t)(sign - argument));
  if (parameter < 0) return refuse(argument, "no such parameter; their names are in data.c");
  if (!read_number(sign + 1, &value)) return refuse(argument, "the value is no finite number");
  int status = ltcgear_set(run, parameter, value);
  return status ? refuse(argument, ltcgear_reason(status)) : 0;
}

/* Take one sample. */
static int gather(void *to, double time, const double *x, const double *y) {
  gathered *g = to;
  (void)x;
  if (time < g->from) return 0;
  g->samples += 1;
  for (ltcgear_whole i = 0; i < g->model->n_forces; ++i) {
    double force = y[g->model->forces[i]];
    g->sum[i] += force;
    g->least[i] = fmin(g->least[i], force);
    g->most[i] = fmax(g->most[i], force);
  }
  return 0;
}

static void print_forces(const gathered *g) {
  printf("%-28s %16s %16s %16s %12s\n", "mesh force [N]", "mean", "least", "most", "load factor");
  for (ltcgear_whole i = 0; i < g->model->n_forces; ++i) {
    const char *name = strchr(g->model->outputs[g->model->forces[i]].name, ':') + 1;
    double mean = g->sum[i] / g->samples, peak = mean < 0 ? g->least[i] : g->most[i];
    printf("%-28s %16.9g %16.9g %16.9g %12.6g\n", name, mean, g->least[i], g->most[i],
           mean != 0 ? peak / mean : NAN);
  }
}

static double seconds(void) {
  struct timespec now;
  timespec_get(&now, TIME_UTC);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Integrate to the end, print what was found; return the exit code. */
static int simulate(ltcgear_run *run, gathered *g, double t_end) {
  double begun = seconds();
  int status = ltcgear_start(run, 0.0);
  double ready = seconds(), steps = ltcgear_expected_steps(run, t_end);
  if (!status && steps > MOST_STEPS) {
    fprintf(stderr, "%s: one motion is so fast that %.0e steps were needed; simulate less time\n", g->model->name, steps);
    return 1;
  }
  if (!status) status = ltcgear_record(run, t_end, g->model->rate, gather, g);
  if (status) fprintf(stderr, "%s, t = %g s: %s\n", g->model->name, ltcgear_time(run), ltcgear_reason(status));
  if (status) return 1;
  printf("%s: %g s simulated in %.4f s (equilibrium %.4f s), %lld steps, %lld switchings\n", g->model->name, t_end,
         seconds() - ready, ready - begun, ltcgear_steps(run), ltcgear_switchings(run));
  if (g->samples > 0) print_forces(g);
  return 0;
}

int main(int count, char **arguments) {
  const ltcgear_model *model = &ltcgear_scene;
  double t_end = model->t_end, *room;
  int first = count > 1 && read_number(arguments[1], &t_end) ? 2 : 1, code = 0;
  if (!(t_end * model->rate >= 1 && t_end < 1e7))
    return refuse(first > 1 ? arguments[1] : model->name, "give a time of one sample to 1e7 s");
  ltcgear_run *run = ltcgear_create(model, 1e-6);
  room = calloc(3 * (size_t)model->n_forces + 1, sizeof *room);
  if (!run || !room) code = refuse(model->name, "there is no memory left");
  for (int i = first; !code && i < count; ++i) code = set_parameter(run, model, arguments[i]);
  t_end = round(t_end * model->rate) / model->rate; /* that of the last sample */
  if (!code) {
    gathered g = {model, t_end / 2, 0, room, room + model->n_forces, room + 2 * model->n_forces};
    for (ltcgear_whole i = 0; i < model->n_forces; ++i) g.least[i] = INFINITY, g.most[i] = -INFINITY;
    code = simulate(run, &g, t_end);
  }
  ltcgear_destroy(run);
  free(room);
  if (fflush(stdout)) {
    fprintf(stderr, "%s: what was found cannot be printed\n", model->name);
    code = 1;
  }
  return code;
}

/* An example: integrate the scene and print the statistics of its mesh forces over the second half of the time.
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

static void print_forces(const ltcgear_model *model, const ltcgear_statistics *of) {
  printf("%-28s %16s %16s %16s %16s %12s\n", "mesh force [N]", "mean", "rms", "least", "most", "load factor");
  for (ltcgear_whole i = 0; i < model->n_forces; ++i) {
    const char *name = strchr(model->outputs[model->forces[i]].name, ':') + 1;
    double peak = of[i].mean < 0 ? of[i].least : of[i].most, factor = of[i].mean != 0 ? peak / of[i].mean : NAN;
    printf("%-28s %16.10g %16.10g %16.10g %16.10g %12.8g\n", name, of[i].mean, of[i].rms, of[i].least, of[i].most, factor);
  }
}

static double seconds(void) {
  struct timespec now;
  timespec_get(&now, TIME_UTC);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Integrate to the end, print what was found; return the exit code. */
static int simulate(ltcgear_run *run, const ltcgear_model *model, double t_end, ltcgear_statistics *of) {
  double begun = seconds();
  int status = ltcgear_start(run, 0.0);
  double ready = seconds(), steps = ltcgear_expected_steps(run, t_end);
  if (!status && steps > MOST_STEPS) {
    fprintf(stderr, "%s: one motion is so fast that %.0e steps were needed; simulate less time\n", model->name, steps);
    return 1;
  }
  if (!status) status = ltcgear_measure_steady(run, t_end / 2, t_end, of);
  if (status) fprintf(stderr, "%s, t = %g s: %s\n", model->name, ltcgear_time(run), ltcgear_reason(status));
  if (status) return 1;
  printf("%s: %g s simulated in %.4f s (equilibrium %.4f s), %lld steps, %lld switchings\n", model->name, t_end,
         seconds() - ready, ready - begun, ltcgear_steps(run), ltcgear_switchings(run));
  print_forces(model, of);
  return 0;
}

int main(int count, char **arguments) {
  const ltcgear_model *model = &ltcgear_scene;
  double t_end = model->t_end;
  int first = count > 1 && read_number(arguments[1], &t_end) ? 2 : 1, code = 0;
  t_end = round(t_end * model->rate) / model->rate; /* that of the last sample */
  if (!(t_end > 0 && t_end < 1e7))
    return refuse(first > 1 ? arguments[1] : model->name, "give a time above 0, and below 1e7 s");
  ltcgear_run *run = ltcgear_create(model, 1e-6);
  ltcgear_statistics *of = calloc((size_t)model->n_forces + 1, sizeof *of);
  if (!run || !of) code = refuse(model->name, "there is no memory left");
  for (int i = first; !code && i < count; ++i) code = set_parameter(run, model, arguments[i]);
  if (!code) code = simulate(run, model, t_end, of);
  ltcgear_destroy(run);
  free(of);
  if (fflush(stdout)) {
    fprintf(stderr, "%s: what was found cannot be printed\n", model->name);
    code = 1;
  }
  return code;
}

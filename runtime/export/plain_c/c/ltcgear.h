/* A gearbox from plain C: simulate a scene that ltcgear has turned into C, with a C compiler and its mathematics only.
 *
 *     cc -O3 *.c -lm
 *
 * model.c has the equations, data.c the scene's numbers and names, ltcgear.c the integration, main.c is an example. All
 * quantities are in SI units. Functions that may fail return a status, 0 where all is done; ltcgear_reason() says what
 * another one means. Nothing is shared between runs: each may be used by one thread at a time, many side by side. */
#ifndef LTCGEAR_H
#define LTCGEAR_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef long long ltcgear_whole;
typedef int (*ltcgear_function)(const double **arg, double **res, ltcgear_whole *iw, double *w, int mem);
typedef int (*ltcgear_room)(ltcgear_whole *arg, ltcgear_whole *res, ltcgear_whole *iw, ltcgear_whole *w);

/* A name and an SI unit. */
typedef struct {
  const char *name, *unit;
} ltcgear_label;

/* A generated function, and what tells the room it needs. */
typedef struct {
  ltcgear_function run;
  ltcgear_room room;
} ltcgear_code;

/* A load over time [s], linear between its rows and constant beyond their ends; where it passes through zero is a row. */
typedef struct {
  const char *name;
  ltcgear_whole rows;
  const double *time, *value;
} ltcgear_table;

/* A freedom: its states (deviation from the rigid motion and rate), the parameter that is its inertia, 1 for an angle. */
typedef struct {
  ltcgear_whole position, rate, inertia;
  unsigned char turns;
} ltcgear_freedom;

/* What follows the reference angle without end, a mesh phase [cycles] or an angle [rad]: in one turn of the reference it
 * goes on by ``cycles`` whole ones and step / below more; whole periods, modulus / below cycles each, are left out of
 * its start (a parameter). Level and phases (outputs) are those of its mesh, -1 where it has none or another clock
 * counts for it. */
typedef struct {
  ltcgear_whole start, level, mesh_phase, gear_phase, step, below, modulus, cycles, period;
  double unit;
} ltcgear_clock;

/* What is constant about a scene's model. Places of what it does not have are -1. */
typedef struct {
  const char *name, *key;
  double t_end, rate;                                 /* the scene's time to simulate [s] and samples a second [Hz] */
  ltcgear_whole n_states, n_levels, n_signals, n_holds, n_parameters, n_outputs, n_tables;
  ltcgear_whole n_freedoms, n_clocks, n_forces;
  const ltcgear_label *states, *parameters, *outputs; /* outputs are called quantity:item */
  const double *parameter_values, *start;             /* the scene's numbers, and its loaded equilibrium (states) */
  const unsigned char *parameter_fixed;               /* 1: follows from structure (teeth, phases): cannot be set */
  const double *parameter_least, *parameter_most;     /* what each may be set to, both included */
  const ltcgear_table *tables;
  const ltcgear_whole *signal_table;                  /* the table of each load signal */
  const unsigned char *signal_slope;                  /* 1: the signal is the table's slope, 0: its value */
  const ltcgear_whole *jacobian_colind, *jacobian_row; /* compressed columns of d xdot / d x */
  ltcgear_code rhs, jacobian, output, phases, borders, energy, motion;
  const ltcgear_freedom *freedoms;
  const ltcgear_clock *clocks;
  const ltcgear_whole *holds;                         /* parameters that hold a contact open or closed */
  const unsigned char *hold_closes;                   /* 1: of a contact that closes, 0: of a friction force's sign */
  const ltcgear_whole *forces;                        /* outputs that are mesh forces */
  ltcgear_whole angle, free_speed;                    /* states: angle of the reference, its speed where that is free */
  ltcgear_whole speed, speed_signal;                  /* parameter and signal: speed of the reference */
  unsigned char speed_held;                           /* 1: that parameter is the speed throughout */
  ltcgear_whole pull, varying, closing;               /* parameters that the search for the equilibrium turns */
} ltcgear_model;

extern const ltcgear_model ltcgear_scene; /* the scene of data.c */

typedef struct ltcgear_run ltcgear_run; /* one simulation */

/* Make a run, with a relative tolerance that refers to vibrations (1e-6 is usual). NULL: no memory, or rtol outside
 * 1e-13..0.1. ltcgear_destroy() frees it. */
ltcgear_run *ltcgear_create(const ltcgear_model *model, double rtol);
void ltcgear_destroy(ltcgear_run *run);

/* Set a parameter (its place in model->parameters) before the start. Refused: what is fixed, what is not finite, and what
 * lies outside parameter_least..parameter_most: a mass or an inertia that is not positive, a negative stiffness or
 * damping, a share (single_share) outside 0..1. */
int ltcgear_set(ltcgear_run *run, ltcgear_whole parameter, double value);
double ltcgear_get(const ltcgear_run *run, ltcgear_whole parameter);

/* Let a table (a load over time) run linearly between two values from now until a time [s], and stay there, instead of
 * its rows. A speed must not jump: begin with the value it has. */
int ltcgear_steer(ltcgear_run *run, ltcgear_whole table, double from, double to, double until);

/* Find the loaded equilibrium for parameters and loads, and begin there at a time [s]. */
int ltcgear_start(ltcgear_run *run, double time);

/* Integrate, with every switching of a mesh or a contact at its own instant, exactly to a time [s]. Where that fails the
 * run stays where it was followed to. */
int ltcgear_advance(ltcgear_run *run, double until);

/* The same, and hand on all samples k / rate that lie after the present time, up to ``until``: states, outputs, and what
 * was given as ``to``. Nothing is integrated to the samples one by one. ``take`` returns 0 to go on. A negative number
 * ends it and is the status (a positive one comes back negative); the run is then at the sample that was taken last, and
 * whatever goes on from there begins with the next one. */
typedef int (*ltcgear_taker)(void *to, double time, const double *x, const double *y);
int ltcgear_record(ltcgear_run *run, double until, double rate, ltcgear_taker take, void *to);

/* Statistics of a mesh force along the motion [N]: mean, root mean square, and the extremes of the integrator's own steps,
 * both sides of every jump included. They are integrals, not means of samples, which hang on the sampling rate. */
typedef struct {
  double mean, rms, least, most;
} ltcgear_statistics;

/* Integrate to a time, and write the statistics of all mesh forces since the present, in the order of model->forces. All
 * instants count alike, so the means of spans that follow each other add up to that of the whole. */
int ltcgear_measure(ltcgear_run *run, double until, ltcgear_statistics *of);

/* The same from a time ahead on, as simulate takes them over the second half of a run: under weights sin(pi s)^4, s from 0
 * to 1 over the span, so that parts of a period at its ends do not count. Where either fails, nothing is written. */
int ltcgear_measure_steady(ltcgear_run *run, double from, double until, ltcgear_statistics *of);

/* Time [s], states, and outputs of the present; whole turns of angles and cycles of mesh phases included. Where a mesh
 * switches just now, outputs are those before it. */
double ltcgear_time(const ltcgear_run *run);
void ltcgear_state(const ltcgear_run *run, double *x);
int ltcgear_read(ltcgear_run *run, double *y);

/* Steps that were made, and mesh switchings, so far. */
ltcgear_whole ltcgear_steps(const ltcgear_run *run);
ltcgear_whole ltcgear_switchings(const ltcgear_run *run);

/* How many steps so many seconds take at least, often there are several times more: the explicit method follows the
 * fastest motion, even one at rest. 1e9 of them take from minutes to hours, by the size of the model. 0 before the
 * start. */
double ltcgear_expected_steps(const ltcgear_run *run, double seconds);

/* Save a run (ltcgear_size() bytes, the same for all runs of a model) and go on from there, in any run of the model.
 * Bytes of another model are refused, and so are damaged ones: the last eight are the checksum of those before. A run
 * that refuses stays as it was. */
size_t ltcgear_size(const ltcgear_run *run);
void ltcgear_save(const ltcgear_run *run, void *to);
int ltcgear_restore(ltcgear_run *run, const void *from);

/* The checksum of some bytes (FNV-1a, 64 bits), which any one wrong byte changes. */
unsigned long long ltcgear_checksum(const void *bytes, size_t size);

/* For integrators of other people. Which tooth pairs carry and which contacts are closed is held until ltcgear_update,
 * so what is integrated between two events is smooth. A run is started and updated first; from then on time and states
 * are the caller's, angles with all their turns.
 *
 * The rates of the states, and all outputs. */
int ltcgear_rates(ltcgear_run *run, double time, const double *x, double *xdot);
int ltcgear_outputs(ltcgear_run *run, double time, const double *x, double *y);

/* Event indicators, positive as long as what is held is right: two for each switched mesh (how far its phase is from
 * where the next tooth pair comes or goes ahead of it, and from that behind it [cycles]), then one for each contact. They
 * pass through zero a little beyond the border itself, and what is held after an update begins at twice that, so that
 * nothing chatters. */
ltcgear_whole ltcgear_indicator_count(const ltcgear_run *run);
int ltcgear_indicators(ltcgear_run *run, double time, const double *x, double *z);

/* After an indicator has passed through zero, and at a time event: go over to what is right at these states. States do
 * not jump. ``changed``, where it is wanted: 1 if anything was held that no longer is. */
int ltcgear_update(ltcgear_run *run, double time, const double *x, int *changed);

/* The next time event after a time [s], a row of a table; infinite if there is none. */
double ltcgear_next_knot(const ltcgear_run *run, double time);

/* Let a table have a value and a slope [1/s] from now on, whatever the time, instead of its rows. */
int ltcgear_impose(ltcgear_run *run, ltcgear_whole table, double value, double slope);

/* How often contacts have opened or closed, and friction forces have turned, so far; ltcgear_switchings() counts meshes. */
ltcgear_whole ltcgear_regimes(const ltcgear_run *run);

/* Say what a status means. */
const char *ltcgear_reason(int status);

#ifdef __cplusplus
}
#endif

#endif

/* What the functions of both FMI versions share: one instance of the model, its variables by value reference, its state
 * as bytes. Nothing here is global that changes, so instances do not know of each other. */
#ifndef LTCGEAR_FMU_H
#define LTCGEAR_FMU_H

#include <stddef.h>

#include "ltcgear.h"

/* Kinds of variables; the value references of a kind follow each other. */
enum {
  FMU_TIME,      /* [s] */
  FMU_STATE,     /* in the order of the model */
  FMU_RATE,      /* of each state */
  FMU_PARAMETER,
  FMU_OUTPUT,
  FMU_ANGLE,     /* of rotors, whole turns included */
  FMU_COUNT,     /* switchings of tooth pairs, and of regimes */
  FMU_STATISTIC, /* of each mesh force over the last communication step, in the order of ltcgear_statistics */
  FMU_INDICATOR,
  FMU_INPUT,
  FMU_KINDS
};

typedef struct {
  const char *token;                /* by which an importer shows that it has read this model's description */
  const unsigned *first;            /* value reference at which each kind begins, and the end; some kinds are empty */
  const double *nominal;            /* size of each state's vibrations */
  const double *angle_ratio;        /* of each angle: the rotor's speed over the reference's, and the output that is */
  const ltcgear_whole *angle_twist; /* its deviation from the rigid motion */
  ltcgear_whole reference;          /* the state that is the reference angle; -1 without one */
  const ltcgear_whole *input_table; /* the table in whose place each input stands */
  const unsigned char *input_slope; /* 1: it is the slope of that table; the input before it is its value */
  const unsigned char *input_ramp;  /* 1: it may not jump (a speed): co-simulation lets it run linearly over a step */
  const double *input_start;
} fmu_variables;

extern const fmu_variables fmu_scene; /* in variables.c */

/* What a step may be besides 0, done: refused, as it was called wrongly; or stopped, somewhere on its way. */
enum { FMU_REFUSED = 1, FMU_STOPPED };

enum { FMU_MADE, FMU_INITIALIZING, FMU_EVENT, FMU_MOVING, FMU_ENDED }; /* modes of an instance */

typedef struct {
  ltcgear_run *run;     /* none until it is wanted for the first time */
  int exchange;         /* model exchange: time, states and inputs are the importer's */
  int mode, known;      /* ``known``: which of xdot, y and z belong to the present time, states and inputs */
  double time, rtol;
  double *p, *u, *met;  /* parameters, inputs, and the inputs that the run has met */
  double *x, *xdot, *y, *z;
  ltcgear_statistics *forces; /* over the last communication step; none in model exchange */
  char message[400];    /* what was refused last, and why */
} fmu;

fmu *fmu_make(int exchange);                   /* NULL: no memory */
void fmu_free(fmu *f);
void fmu_reset(fmu *f);                        /* back to what was made */
void fmu_move(fmu *f);                         /* time or states have changed: nothing is known any more */

/* These return 0, or 1 with a message. */
int fmu_refuse(fmu *f, const char *form, ...);
int fmu_begin(fmu *f, double time, double rtol); /* set the start; an rtol that is not positive: the default */
int fmu_get(fmu *f, const unsigned *reference, size_t count, double *value);
int fmu_set(fmu *f, const unsigned *reference, size_t count, const double *value); /* all of them, or none */
int fmu_start(fmu *f);                         /* find the equilibrium, where that has not been done */
int fmu_step(fmu *f, double from, double step); /* FMU_REFUSED or FMU_STOPPED */
int fmu_find(fmu *f, int kind);                /* evaluate rates, outputs or indicators */
int fmu_update(fmu *f, double *next);          /* events at the present time and states; the next time event [s] */
int fmu_keep(fmu *f, void **state);            /* save all that an instance is, in memory that free() gives back */
int fmu_place(fmu *f, const double *x);          /* take the states of an importer */
int fmu_return(fmu *f, const void *state);     /* where that is refused, the instance stays as it was */
size_t fmu_packed_size(const void *state);     /* bytes that it has when it is packed, a checksum among them */
int fmu_pack(fmu *f, const void *state, void *bytes, size_t size);
int fmu_unpack(fmu *f, const void *bytes, size_t size, void **state);
size_t fmu_count(int kind);                    /* how many variables of a kind there are */

#endif

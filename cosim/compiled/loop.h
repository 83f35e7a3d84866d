/* The structures of the compiled loop, those of layout.py, and the functions of FMI 2.0 and 3.0 that it calls. */
#ifndef LOOP_H
#define LOOP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* a call takes as long as a tenth of a step of a cheap FMU: these are written out where they are called */
#ifdef __GNUC__
#define WRITTEN_OUT static inline __attribute__((always_inline))
#else
#define WRITTEN_OUT static inline
#endif

enum { OK, WARNING, DISCARD };
enum { LAST_SUCCESSFUL_TIME = 2, TERMINATED = 3 }; /* fmi2StatusKind */

/* what a call of ours ended with */
enum { FULL, EARLY, MET, ENDED, STRAY, FAILED };
/* what failed */
enum { SETTING, GETTING, STEPPING, SAVING, RESTORING, CREEPING, NOWHERE };

typedef int (*Set2)(void *, const uint32_t *, size_t, const double *);
typedef int (*Get2)(void *, const uint32_t *, size_t, double *);
typedef int (*Set3)(void *, const uint32_t *, size_t, const double *, size_t);
typedef int (*Get3)(void *, const uint32_t *, size_t, double *, size_t);
typedef int (*Step2)(void *, double, double, int);
typedef int (*Step3)(void *, double, double, bool, bool *, bool *, bool *, double *);
typedef int (*Save)(void *, void **);
typedef int (*Restore)(void *, void *);
typedef int (*Boolean2)(void *, int, int *);
typedef int (*Real2)(void *, int, double *);

typedef void (*Function)(void); /* cast to what it is, by the version of FMI */

typedef struct {
    void *instance;
    Function set, get, step, save, restore, boolean_status, real_status;
    const uint32_t *u_references, *y_references;
    double *u, *y;
    const int64_t *targets, *sources; /* u[targets] = factor * values[sources] + offset */
    const double *factor, *offset;    /* NULL: no wire converts */
    int64_t n_u_references, n_y_references, n_u, n_y, n_wires;
    int64_t fmi, every, rewound;
    int64_t time;            /* ns */
    int64_t kept_time;       /* where it was at the start of the macro step */
    void *state;
    double reached;
    bool event, terminate, early;
} Component;

typedef struct {
    Component *components;
    const int64_t *order;  /* of the steps */
    double *row, *values;  /* what everybody shows, and the part of it that holds the outputs */
    double *kept;          /* the row at the start of the macro step; NULL: nobody is taken back */
    int64_t *announced;    /* who announced an event at the end of the last macro step, in stepping order */
    int64_t *starts, *ends; /* of the macro steps that were told; NULL: they are not told one by one */
    double *walls, *rows;
    int64_t n, n_row, jacobi, locating;
    int64_t start, stop, step; /* ns */
    int64_t k, now;            /* macro steps done, ns */
    int64_t done;              /* by this call */
    int64_t n_announced, terminated; /* -1: nobody */
    int64_t component, what, status; /* of a failure */
    int64_t reached;                 /* ns; where a step ended that was not to end there */
    double time;                     /* s, of a failure */
    double from, to;                 /* s: now, and the end of this macro step */
} Loop;

#endif

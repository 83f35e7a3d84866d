/* What the files of the harness share: the description of a component (generated), an instance of it, and the calls
 * between the files.  Everything is static: all.c makes one translation unit of it, so that only the functions of the
 * standard are visible whatever flags a foreign build uses, and two FMUs linked into one program do not collide.
 */
#ifndef HARNESS_H
#define HARNESS_H

#include <float.h>
#include <locale.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "vectors.h"

/* An equation in the form CasADi generates: arg is t, h, x, u, p, w, k and up to two more. */
typedef int Equation(const double **arg, double **res, long long *iw, double *w, int mem);

typedef struct {
    const char *name;
    int keys;          /* how many rows are looked up at once */
    int columns;
    const char *start; /* its text, rows separated by ';' */
} TableLayout;

/* Values live in one row of slots: time | parameters | inputs | states | outputs | derivatives of the states.
 * A value reference is a slot; those of the tables follow behind the last one. */
typedef struct {
    const char *identifier, *token;
    int p, u, x, y, dx, end;     /* first slot of each kind, and one behind the last */
    int n_p, n_u, n_x, n_y, n_g; /* how many parameters, inputs, states, outputs, event indicators */
    int n_w, n_keys, n_tables;   /* numbers looked up, keys they are looked up by, tables */
    int n_k;                     /* constants: what depends on parameters and step length alone */
    int period;                  /* slot of the sample period, or -1 */
    int micro;                   /* slot of the longest micro step of a flow, or -1 */
    const double *start;         /* of parameters, inputs and states */
    const double *nominal;       /* of the states; up to a multiple of four, like all that is as many as the states */
    const char *const *labels;   /* one per slot */
    const unsigned *extent;      /* scalars of the variable that begins in a slot, 0 inside one */
    const char *const *events;   /* names of the indicators */
    const unsigned char *announced; /* per indicator: does a step return early there */
    const unsigned char *decides;   /* per state: does an indicator depend on it */
    int sync_looks_up;           /* whether sync reads the tables */
    int of_states_alone;         /* whether no indicator depends on anything else but parameters and tables */
    const TableLayout *tables;
    Equation *once, *ode, *out, *sync, *flow, *zero, *jump, *where, *jvp; /* NULL where there is none */
    int n_iw, n_work;            /* work space of the equations */
} Model;

typedef struct {
    char *text;
    double *rows;
    int n_rows;
} Table;

typedef enum { STATUS_OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR, STATUS_FATAL } Status;

typedef enum { INSTANTIATED = 1, INITIALIZATION = 2, EVENT_MODE = 4, STEP_MODE = 8, TERMINATED = 16, FAILED = 32 } Mode;
#define ANY_MODE (INSTANTIATED | INITIALIZATION | EVENT_MODE | STEP_MODE | TERMINATED)

static const double TICKS = 1e9; /* per second: time is a whole number of nanoseconds where it can be */

/* Variables that lie behind each other: their references, and how many scalars they have. */
typedef struct {
    size_t n;
    unsigned values, references[128];
} Run;

typedef struct Instance Instance;
struct Instance {
    double *slot;          /* values; slot[0] is the time */
    Table *tables;
    uint64_t token_hash, tables_hash;
    Mode mode;
    int outputs_valid, derivatives_valid;
    int shown_at_end;      /* `shown` holds what belongs to the end of the step */
    int signs_known;       /* `before` holds the signs of the indicators as they are */
    double tolerance;      /* relative; absolute is this times the state's nominal value */
    double h_next;         /* step size the integrator would try next, 0 before its first step */
    int smooth;            /* whether three stages are likely to be enough for the next one */

    /* work space, allocated once */
    double *memory;        /* the block the pointers below share */
    double *rows, *keys;   /* looked-up rows of the tables, and the keys */
    double *constants[2], constants_for[2]; /* at step length 0 and at another one, NaN until computed */
    int *hint;             /* per key: which row stands there, -1: none does */
    double *k[7], *trial, *dense[5], *probe; /* stages, trial state, dense output: coefficients and a state on it */
    double *ratio;         /* estimated errors of a step over the tolerated ones */
    double *shown;         /* outputs and behind them indicators, where there are any */
    double *indicator, *crossed, *seed, *tangent, *work;
    double *slope[2], *u_now; /* time derivatives of the inputs since the step began, and the inputs at some time */
    signed char *before, *after;     /* signs of the indicators */
    long long *iw;

    int n_slopes;          /* how many of them are in use */
    double since;          /* where the step began */
    void (*ask)(Instance *in, double t); /* has the importer set the inputs to what they are at t; NULL: they are held */
    void (*update)(void);  /* ... by calling this, in FMI 3.0 */

    Run last[2];           /* of inputs and of outputs, those that were asked for last */

    int early_return, event_mode;
    int continuing;        /* the last step ended early and no input was set since: the next one is its rest */
    char *name;
    void *environment;
    void (*send)(Instance *in, Status status, const char *message);
    union { void (*fmi3)(void); const void *fmi2; } callback;
    char message[512];
};

/* How a step ended. */
typedef struct {
    double reached;
    int early;
} Ending;

/* Often it is one number, and of memcpy GCC makes an instruction that takes long to start. */
static inline void copy(double *to, const double *from, size_t n)
{
    if (n == 1)
        *to = *from;
    else
        memmove(to, from, sizeof *to * n);
}

/* messages.c */
static Status report(Instance *in, Status status, const char *format, ...);
static const char *number(char *buffer, size_t size, double value);

/* table.c */
static Status table_set(Instance *in, int table, const char *text);
static void table_rows(Instance *in);

/* evaluate.c */
static void evaluate(Instance *in, Equation *f, double t, double h, const double *x, double *result);
static void accept(Instance *in);
static inline Status check_finite(Instance *in, const double *values, int first_slot, int n, double t, const char *what);
static void show(Instance *in);
static void refresh_outputs(Instance *in);
static void refresh_derivatives(Instance *in);
static void tangent(Instance *in);

/* integrate.c */
static void prepare_dense(Instance *in, double h, const double *x);
static void dense_state(const Instance *in, double at, double *x);
static Status integrate(Instance *in, double t, double stop, Ending *ending);

/* events.c */
static void signs(Instance *in, double t, const double *x, signed char *found);
static int crosses(Instance *in, double t, int last);
static int event_between(Instance *in, double t, double h, double *at);
static Status jump(Instance *in, double t, int *event, int *announced);

/* step.c */
static Status step(Instance *in, double from, double to, Ending *ending);

/* snapshot.c */
static size_t snapshot_size(void);
static void snapshot_write(const Instance *in, unsigned char *bytes);
static Status snapshot_read(Instance *in, const unsigned char *bytes);
static Status snapshot_get(Instance *in, void **state);
static Status snapshot_serialize(Instance *in, const void *state, void *bytes, size_t size);
static Status snapshot_deserialize(Instance *in, const void *bytes, size_t size, void **state);

/* instance.c */
static void forget(Instance *in);
static Instance *instance_new(const char *name);
static void instance_free(Instance *in);
static Status instance_reset(Instance *in);
static Status instance_start(Instance *in, double time, int tolerance_defined, double tolerance);
static Status allowed(Instance *in, int modes, const char *function);
static const double *slot_read(Instance *in, unsigned reference, unsigned n);
static Status slot_write(Instance *in, unsigned reference, unsigned n, const double *values);
static Status derivative_along(Instance *in, const unsigned *unknowns, size_t n_unknowns, const unsigned *knowns,
                               size_t n_knowns, const double *seed, size_t n_seed, double *result, size_t n_result);

#endif

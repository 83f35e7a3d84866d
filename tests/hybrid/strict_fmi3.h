/* The FMI 3.0 functions of small hand-written FMUs with event mode.  They refuse whatever the standard forbids: a discrete
 * variable set or read in step mode, a clocked one while no clock of it ticks, a step that does not begin where the last
 * one ended or goes past an announced time event, a clock that ticks at the wrong time.  The model, included before,
 * gives WAITS (per value reference: 0 continuous, 1 discrete, else a bit 2 << k per clock k of it) and the functions
 * below.  Clock k has the value reference 100 + k.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "fmi3Functions.h"

#define LONGEST 38 /* value reference of the longest step that is not discarded; 0: any is made */

enum { BEFORE = 1, INITIALIZATION = 2, EVENT = 4, STEP = 8 };

typedef struct {
    int mode, early_allowed, event_mode, pending, end;
    double time, next, x[40];        /* next: of a time event, below zero if there is none */
    int ticking;                     /* a bit per clock */
    double due[8];                   /* when each time-based clock ticks, below zero if it does not */
    int ask;                         /* a bit per clock whose interval must be asked for before event mode is left */
    int updates;                     /* of the discrete states, in all */
    fmi3LogMessageCallback log;
    void *environment;
} Thing;

static const int waits[];                              /* per value reference */
static const int based;                                /* a bit per time-based clock */
static void begin(Thing *t);                           /* initialisation has ended */
static void look(Thing *t);                            /* compute outputs, in event mode the output clocks, too */
static double move(Thing *t, double to);               /* go there, or to a state event: sets pending; returns the time */
static int update(Thing *t);                           /* handle the event; returns whether another update is needed */
static double interval(Thing *t, int clock, int *qualifier);

static fmi3Status refuse(Thing *t, const char *what, double number)
{
    char text[200];
    snprintf(text, sizeof text, "%s (%.12g) at t = %.12g in mode %d", what, number, t->time, t->mode);
    t->log(t->environment, fmi3Error, "all", text);
    return fmi3Error;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String path, fmi3Boolean visible, fmi3Boolean logging,
                                         fmi3Boolean event, fmi3Boolean early, const fmi3ValueReference r[], size_t n,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update)
{
    Thing *t = calloc(1, sizeof *t);
    t->mode = BEFORE;
    t->log = log;
    t->environment = environment;
    t->event_mode = event;
    t->early_allowed = early;
    t->next = -1;
    defaults(t->x);
    return t;
}
void fmi3FreeInstance(fmi3Instance i) { free(i); }

#define ALLOWED(modes)                                                                                                 \
    Thing *t = i;                                                                                                      \
    if (!(t->mode & (modes)))                                                                                          \
    return refuse(t, __func__, -1)

fmi3Status fmi3EnterInitializationMode(fmi3Instance i, fmi3Boolean a, fmi3Float64 b, fmi3Float64 start, fmi3Boolean d, fmi3Float64 e)
{
    ALLOWED(BEFORE);
    int k;
    t->time = start;
    for (k = 0; k < 8; k++)
        t->due[k] = -1;
    t->mode = INITIALIZATION;
    return fmi3OK;
}
fmi3Status fmi3ExitInitializationMode(fmi3Instance i)
{
    ALLOWED(INITIALIZATION);
    begin(t);
    t->mode = t->event_mode ? EVENT : STEP;
    return fmi3OK;
}
fmi3Status fmi3EnterEventMode(fmi3Instance i)
{
    ALLOWED(STEP);
    t->mode = EVENT;
    return fmi3OK;
}
fmi3Status fmi3EnterStepMode(fmi3Instance i)
{
    ALLOWED(EVENT);
    if (t->ticking)
        return refuse(t, "event mode is left while a clock ticks", t->ticking);
    if (t->ask)
        return refuse(t, "the interval of clocks was not asked for", t->ask);
    t->mode = STEP;
    return fmi3OK;
}
fmi3Status fmi3Reset(fmi3Instance i)
{
    Thing *t = i, fresh = {BEFORE, t->early_allowed, t->event_mode};
    fresh.next = -1;
    fresh.log = t->log;
    fresh.environment = t->environment;
    defaults(fresh.x);
    *t = fresh;
    return fmi3OK;
}
fmi3Status fmi3Terminate(fmi3Instance i)
{
    ALLOWED(EVENT | STEP);
    t->mode = BEFORE;
    return fmi3OK;
}

static int open_(const Thing *t, fmi3ValueReference r, int set)
{
    if (t->mode == STEP)
        return waits[r] == 0;
    return waits[r] < 2 || (waits[r] >> 1 & t->ticking) != 0 || (set && t->mode == INITIALIZATION);
}
#define TYPE(T)                                                                                                        \
    fmi3Status fmi3Set##T(fmi3Instance i, const fmi3ValueReference r[], size_t n, const fmi3##T v[], size_t m)         \
    {                                                                                                                  \
        size_t j;                                                                                                      \
        ALLOWED(BEFORE | INITIALIZATION | EVENT | STEP);                                                               \
        for (j = 0; j < n; j++) {                                                                                      \
            if (t->mode > INITIALIZATION && !open_(t, r[j], 1))                                                        \
                return refuse(t, "set out of season", r[j]);                                                           \
            t->x[r[j]] = (double)v[j];                                                                                 \
        }                                                                                                              \
        return fmi3OK;                                                                                                 \
    }                                                                                                                  \
    fmi3Status fmi3Get##T(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3##T v[], size_t m)               \
    {                                                                                                                  \
        size_t j;                                                                                                      \
        ALLOWED(INITIALIZATION | EVENT | STEP);                                                                        \
        look(t);                                                                                                       \
        for (j = 0; j < n; j++) {                                                                                      \
            if (!open_(t, r[j], 0))                                                                                    \
                return refuse(t, "read out of season", r[j]);                                                          \
            v[j] = (fmi3##T)t->x[r[j]];                                                                                \
        }                                                                                                              \
        return fmi3OK;                                                                                                 \
    }
TYPE(Float64) TYPE(Int32) TYPE(Boolean)

fmi3Status fmi3SetClock(fmi3Instance i, const fmi3ValueReference r[], size_t n, const fmi3Clock v[])
{
    size_t j;
    ALLOWED(EVENT);
    for (j = 0; j < n; j++) {
        int k = (int)r[j] - 100;
        if (based >> k & 1 && fabs(t->time - t->due[k]) > 1.001e-9)
            return refuse(t, "a clock ticks at the wrong time, it is due at", t->due[k]);
        if (t->ticking >> k & 1)
            return refuse(t, "a clock ticks twice", k);
        t->ticking |= 1 << k;
    }
    return fmi3OK;
}
fmi3Status fmi3GetClock(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3Clock v[])
{
    size_t j;
    ALLOWED(EVENT);
    look(t);
    for (j = 0; j < n; j++)
        v[j] = t->ticking >> (r[j] - 100) & 1;
    return fmi3OK;
}
fmi3Status fmi3GetIntervalDecimal(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3Float64 v[], fmi3IntervalQualifier q[])
{
    int qualifier;
    ALLOWED(INITIALIZATION | EVENT);
    v[0] = interval(t, (int)r[0] - 100, &qualifier);
    q[0] = qualifier;
    t->ask &= ~(1 << (r[0] - 100));
    return fmi3OK;
}
fmi3Status fmi3GetIntervalFraction(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3UInt64 c[], fmi3UInt64 d[], fmi3IntervalQualifier q[])
{
    int qualifier;
    ALLOWED(INITIALIZATION | EVENT);
    d[0] = 3;
    c[0] = (fmi3UInt64)(interval(t, (int)r[0] - 100, &qualifier) * 3 + 0.5);
    q[0] = qualifier;
    t->ask &= ~(1 << (r[0] - 100));
    return fmi3OK;
}
fmi3Status fmi3GetShiftDecimal(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3Float64 v[])
{
    ALLOWED(INITIALIZATION);
    v[0] = 0.05;
    return fmi3OK;
}
fmi3Status fmi3GetShiftFraction(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3UInt64 c[], fmi3UInt64 d[])
{
    ALLOWED(INITIALIZATION);
    c[0] = 0;
    d[0] = 1;
    return fmi3OK;
}
fmi3Status fmi3SetIntervalDecimal(fmi3Instance i, const fmi3ValueReference r[], size_t n, const fmi3Float64 v[])
{
    ALLOWED(INITIALIZATION);
    t->x[39] = v[0];
    return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance i, fmi3Boolean *again, fmi3Boolean *terminate, fmi3Boolean *nominals,
                                    fmi3Boolean *states, fmi3Boolean *defined, fmi3Float64 *next)
{
    ALLOWED(EVENT);
    look(t);
    *nominals = *states = fmi3False;
    *again = update(t) != 0;
    *terminate = t->end;
    t->updates++;
    t->pending = t->ticking = 0;
    *defined = t->next >= 0;
    *next = t->next;
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance i, fmi3Float64 at, fmi3Float64 h, fmi3Boolean no, fmi3Boolean *event, fmi3Boolean *terminate,
                      fmi3Boolean *early, fmi3Float64 *reached)
{
    double to = at + h;
    int k;
    ALLOWED(STEP);
    *event = *terminate = *early = fmi3False;
    if (t->x[LONGEST] > 0 && h > t->x[LONGEST] * (1 + 1e-9)) {
        *reached = at + t->x[LONGEST];
        t->x[3] = t->time = NAN; /* nothing is left of the state that the step began with */
        t->log(t->environment, fmi3Discard, "all", "the step is too long");
        return fmi3Discard;
    }
    if (t->pending)
        return refuse(t, "a step was asked for before an event was handled", 0);
    if (fabs(at - t->time) > 1e-15 * (1 + fabs(at)))
        return refuse(t, "a step begins elsewhere", at);
    if (t->next >= 0 && to > t->next + 1e-15 * (1 + to))
        return refuse(t, "a step goes past a time event", to);
    for (k = 0; k < 8; k++)
        if (based >> k & 1 && t->due[k] >= 0 && to > t->due[k] + 1.001e-9)
            return refuse(t, "a step goes past the tick of a clock", to);
    t->time = move(t, to);
    if (t->pending && t->time < to && !t->early_allowed)
        return refuse(t, "an early return would be needed", to);
    *event = t->pending;
    *early = t->time < to;
    *reached = t->time;
    return fmi3OK;
}

fmi3Status fmi3GetFMUState(fmi3Instance i, fmi3FMUState *s)
{
    if (!*s)
        *s = malloc(sizeof(Thing));
    memcpy(*s, i, sizeof(Thing));
    return fmi3OK;
}
fmi3Status fmi3SetFMUState(fmi3Instance i, fmi3FMUState s)
{
    memcpy(i, s, sizeof(Thing));
    return fmi3OK;
}
fmi3Status fmi3FreeFMUState(fmi3Instance i, fmi3FMUState *s)
{
    free(*s);
    *s = NULL;
    return fmi3OK;
}
fmi3Status fmi3SerializedFMUStateSize(fmi3Instance i, fmi3FMUState s, size_t *n)
{
    *n = sizeof(Thing);
    return fmi3OK;
}
fmi3Status fmi3SerializeFMUState(fmi3Instance i, fmi3FMUState s, fmi3Byte b[], size_t n)
{
    memcpy(b, s, n);
    return fmi3OK;
}
fmi3Status fmi3DeserializeFMUState(fmi3Instance i, const fmi3Byte b[], size_t n, fmi3FMUState *s)
{
    *s = malloc(n);
    memcpy(*s, b, n);
    return fmi3OK;
}

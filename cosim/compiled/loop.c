/* Macro steps of FMUs with a fixed step, Jacobi or Gauss-Seidel: what master.py, attempt.py and algorithms.py do, without
 * Python.  Those are the specification: the same calls in the same order with the same bits.  A macro step in which
 * somebody returns early is taken back and left to them.  Compiled without contraction to fused multiply-add. */

#define _POSIX_C_SOURCE 199309L /* clock_gettime */

#include "loop.h"

#include <string.h>

#ifdef _WIN32
#include <windows.h>
#define EXPORT __declspec(dllexport)
#else
#include <time.h>
#define EXPORT __attribute__((visibility("default")))
#endif

#define NS 1e9
#define NS_SLACK 1e-3 /* of clock.py */
#define CONTINUED 10000 /* early returns in one step that nobody asked for; more are no progress */
#define CLOCK_EVERY 16 /* macro steps between two looks at the clock, where no step is told */

static double clock_now(void)
{
#ifdef _WIN32
    LARGE_INTEGER ticks, per_second;
    QueryPerformanceCounter(&ticks);
    QueryPerformanceFrequency(&per_second);
    return (double)ticks.QuadPart / (double)per_second.QuadPart;
#else
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
#endif
}

static int failed(Loop *loop, int64_t component, int what, int status, double time)
{
    loop->component = component;
    loop->what = what;
    loop->status = status;
    loop->time = time;
    return FAILED;
}

WRITTEN_OUT double seconds(int64_t ns)
{
    return (double)ns / NS;
}

#define NEVER INT64_MIN

/* the first tick at or after a time in seconds; NEVER for what is no time, as NaN */
static int64_t tick_at_or_after(double time)
{
    double tick = time * NS - NS_SLACK;
    int64_t whole = NEVER;
    if (tick > -1e18 && tick < 1e18) {
        whole = (int64_t)tick;
        whole += (double)whole < tick;
    }
    return whole;
}

/* where a component is, in s; a division takes as long as a step of a cheap FMU: mostly it is known */
WRITTEN_OUT double begin(const Loop *loop, const Component *c)
{
    return c->time == loop->now ? loop->from : seconds(c->time);
}

WRITTEN_OUT int feed(Loop *loop, int64_t i)
{
    Component *c = &loop->components[i];
    const double *values = loop->values;
    int64_t j;
    int status;
    if (c->factor)
        for (j = 0; j < c->n_wires; j++)
            c->u[c->targets[j]] = c->factor[j] * values[c->sources[j]] + c->offset[j];
    else
        for (j = 0; j < c->n_wires; j++)
            c->u[c->targets[j]] = values[c->sources[j]];
    if (!c->n_u_references)
        return OK;
    if (c->fmi == 2)
        status = ((Set2)c->set)(c->instance, c->u_references, (size_t)c->n_u_references, c->u);
    else
        status = ((Set3)c->set)(c->instance, c->u_references, (size_t)c->n_u_references, c->u, (size_t)c->n_u);
    return status > WARNING ? failed(loop, i, SETTING, status, seconds(c->time)) : OK;
}

WRITTEN_OUT int collect(Loop *loop, int64_t i)
{
    Component *c = &loop->components[i];
    int status;
    if (!c->n_y_references)
        return OK;
    if (c->fmi == 2)
        status = ((Get2)c->get)(c->instance, c->y_references, (size_t)c->n_y_references, c->y);
    else
        status = ((Get3)c->get)(c->instance, c->y_references, (size_t)c->n_y_references, c->y, (size_t)c->n_y);
    return status > WARNING ? failed(loop, i, GETTING, status, seconds(c->time)) : OK;
}

/* How a step ended: FAILED or OK, and then the tick reached and whether an event or the end of the run was the reason. */
typedef struct {
    int64_t reached;
    bool early, terminated;
} Advance;

WRITTEN_OUT int step2(Loop *loop, int64_t i, Advance *advance)
{
    Component *c = &loop->components[i];
    double t = begin(loop, c), reached = t;
    int status = ((Step2)c->step)(c->instance, t, loop->to - t, 0), terminated = 0;
    if (status <= WARNING)
        return OK;
    if (status != DISCARD)
        return failed(loop, i, STEPPING, status, t);
    if (((Boolean2)c->boolean_status)(c->instance, TERMINATED, &terminated) > WARNING || !terminated)
        return failed(loop, i, STEPPING, status, t);
    ((Real2)c->real_status)(c->instance, LAST_SUCCESSFUL_TIME, &reached);
    advance->reached = tick_at_or_after(reached);
    advance->terminated = true;
    return advance->reached == NEVER ? failed(loop, i, NOWHERE, status, t) : OK;
}

WRITTEN_OUT int step3(Loop *loop, int64_t i, int64_t end, Advance *advance)
{
    Component *c = &loop->components[i];
    double t = begin(loop, c), to = loop->to;
    int tries;
    for (tries = 0; tries < CONTINUED; tries++) {
        int status =
            ((Step3)c->step)(c->instance, t, to - t, false, &c->event, &c->terminate, &c->early, &c->reached);
        if (status > WARNING)
            return failed(loop, i, STEPPING, status, t);
        if (!c->terminate && !c->early)
            return OK;
        if (c->terminate) {
            advance->reached = tick_at_or_after(c->reached);
            advance->terminated = true;
            return advance->reached == NEVER ? failed(loop, i, NOWHERE, status, t) : OK;
        }
        if (loop->locating) {
            int64_t tick = tick_at_or_after(c->reached);
            if (tick == NEVER)
                return failed(loop, i, NOWHERE, status, t);
            if (tick <= c->time)
                tick = c->time + 1;
            advance->reached = tick < end ? tick : end;
            advance->early = true;
            return OK;
        }
        if (c->reached >= to)
            return OK;
        t = c->reached; /* nobody wants to stop here: the rest of the same step */
    }
    return failed(loop, i, CREEPING, OK, t);
}

/* OK, or why the attempt ends: EARLY, ENDED, STRAY, FAILED */
WRITTEN_OUT int step(Loop *loop, int64_t i, int64_t end)
{
    Component *c = &loop->components[i];
    Advance advance = {end, false, false};
    if ((c->fmi == 2 ? step2(loop, i, &advance) : step3(loop, i, end, &advance)) != OK)
        return FAILED;
    if (advance.terminated)
        loop->terminated = i;
    if (advance.reached == end) {
        c->time = end;
        if (advance.early)
            loop->announced[loop->n_announced++] = i;
        return OK;
    }
    loop->component = i;
    loop->reached = advance.reached;
    if (!(advance.terminated || advance.early) || advance.reached < c->time || advance.reached > end)
        return STRAY;
    return advance.terminated ? ENDED : EARLY;
}

WRITTEN_OUT bool is_due(const Loop *loop, int64_t i, int64_t end)
{
    int64_t every = loop->components[i].every; /* a remainder takes as long as a step of a cheap FMU: not where it is 1 */
    return every == 1 || end == loop->stop || (loop->k + 1) % every == 0;
}

/* Each returns OK or why the attempt ended; *stepped* is how many of the order were asked. */

static int jacobi(Loop *loop, int64_t end, int64_t *stepped)
{
    int64_t i;
    int why;
    for (i = 0; i < loop->n; i++)
        if (loop->components[i].time == loop->now && (why = feed(loop, i)) != OK)
            return why;
    for (; *stepped < loop->n; ++*stepped)
        if (is_due(loop, loop->order[*stepped], end) && (why = step(loop, loop->order[*stepped], end)) != OK)
            return why;
    for (i = 0; i < loop->n; i++)
        if (is_due(loop, loop->order[i], end) && (why = collect(loop, loop->order[i])) != OK)
            return why;
    return OK;
}

static int gauss_seidel(Loop *loop, int64_t end, int64_t *stepped)
{
    int why;
    for (; *stepped < loop->n; ++*stepped) {
        int64_t i = loop->order[*stepped];
        if (!is_due(loop, i, end))
            continue;
        if ((why = feed(loop, i)) != OK || (why = step(loop, i, end)) != OK || (why = collect(loop, i)) != OK)
            return why;
    }
    return OK;
}

static int save(Loop *loop)
{
    int64_t i;
    for (i = 0; i < loop->n; i++) {
        Component *c = &loop->components[loop->order[i]];
        int status = c->rewound ? ((Save)c->save)(c->instance, &c->state) : OK;
        if (status > WARNING)
            return failed(loop, loop->order[i], SAVING, status, seconds(c->time));
        c->kept_time = c->time;
    }
    memcpy(loop->kept, loop->row, sizeof(double) * (size_t)loop->n_row);
    return OK;
}

/* Take everybody who stepped in this attempt back; the one who returned early is the last of them. */
static int take_back(Loop *loop, int64_t end, int64_t stepped)
{
    int64_t i;
    for (i = 0; i <= stepped; i++)
        if (is_due(loop, loop->order[i], end) && !loop->components[loop->order[i]].rewound)
            return STRAY; /* it has never said that it might */
    for (i = 0; i <= stepped; i++) {
        Component *c = &loop->components[loop->order[i]];
        int status = is_due(loop, loop->order[i], end) ? ((Restore)c->restore)(c->instance, c->state) : OK;
        if (status > WARNING)
            return failed(loop, loop->order[i], RESTORING, status, seconds(c->time));
    }
    for (i = 0; i <= stepped; i++)
        if (is_due(loop, loop->order[i], end))
            loop->components[loop->order[i]].time = loop->components[loop->order[i]].kept_time;
    memcpy(loop->row, loop->kept, sizeof(double) * (size_t)loop->n_row);
    return EARLY;
}

static void tell(Loop *loop, int64_t end, double wall)
{
    loop->starts[loop->done] = loop->now;
    loop->ends[loop->done] = end;
    loop->walls[loop->done] = wall;
    memcpy(loop->rows + loop->done * loop->n_row, loop->row, sizeof(double) * (size_t)loop->n_row);
}

/* Make up to *most* macro steps, but go on for no longer than *budget* s; *wall* is what the run has taken so far, in s.
 * Returns why it stopped: FULL (the run may be over), EARLY (the next macro step is for the readable loop), MET (the last
 * one ends with events, or ends the run), or within the next one: ENDED (there the run ends), STRAY, FAILED. */
EXPORT int advance(Loop *loop, int64_t most, double wall, double budget)
{
    double began = clock_now(), passed = 0.0;
    loop->done = 0;
    loop->from = seconds(loop->now);
    while (loop->done < most && loop->now < loop->stop && passed < budget) {
        int64_t end = loop->start + (loop->k + 1) * loop->step, stepped = 0;
        int why;
        if (end > loop->stop)
            end = loop->stop;
        loop->to = seconds(end);
        loop->terminated = -1;
        loop->n_announced = 0;
        if (loop->kept && save(loop) != OK)
            return FAILED;
        why = loop->jacobi ? jacobi(loop, end, &stepped) : gauss_seidel(loop, end, &stepped);
        if (why == EARLY)
            return take_back(loop, end, stepped);
        if (why != OK)
            return why;
        if (loop->starts || loop->done % CLOCK_EVERY == 0)
            passed = clock_now() - began;
        if (loop->starts)
            tell(loop, end, wall + passed);
        loop->now = end;
        loop->from = loop->to;
        loop->k++;
        loop->done++;
        if (loop->terminated >= 0 || loop->n_announced)
            return MET;
    }
    return FULL;
}

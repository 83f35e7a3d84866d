/* Small FMUs with event mode; MODEL chooses one. */
#define BALL 1
#define CONTROLLER 2
#define CLOCKS 3
#define STAIR 4
#define RELAY 5
#define SUMMING 6

static void defaults(double *x);
#include "strict_fmi3.h"

#if MODEL == BALL
/* Free fall over a floor, exactly: a = push + kick - g is constant between events.  The bounce is an event of its own;
 * slower than "rest" the ball stays.  1 push, 2 kick (discrete), 3 h, 4 v, 5 bounces (discrete), 6 g, 7 e, 8 h0, 9 rest */
static const int waits[] = {0, 0, 1, 0, 0, 1, 0, 0, 0, 0};
static const int based = 0;
static void defaults(double *x) { x[6] = 9.81; x[7] = 0.8; x[8] = 1; }
static void begin(Thing *t) { t->x[3] = t->x[8]; }
static double acceleration(const Thing *t) { return t->x[10] ? 0 : t->x[1] + t->x[2] - t->x[6]; }
static void fall(Thing *t, double dt)
{
    double a = acceleration(t);
    t->x[3] += dt * (t->x[4] + dt / 2 * a);
    t->x[4] += dt * a;
}
static double move(Thing *t, double to)
{
    double a = acceleration(t), h = t->x[3], v = t->x[4], dt = to - t->time, root = v * v - 2 * a * h, hit;
    if (a < 0 && root >= 0 && (hit = (v + sqrt(root)) / -a) <= dt && hit >= 0 && (v < 0 || hit > 0)) {
        fall(t, hit);
        t->x[3] = 0;
        t->pending = 1;
        return hit == dt ? to : t->time + hit;
    }
    fall(t, dt);
    return to;
}
static void look(Thing *t)
{
    if (t->mode == INITIALIZATION)
        t->x[3] = t->x[8];
    if (t->mode == EVENT && t->pending)
        t->ticking |= 1; /* clock 0 goes with the bounce */
}
static int update(Thing *t)
{
    if (t->pending) {
        t->x[4] *= -t->x[7];
        t->x[5]++;
        if (t->x[4] < t->x[9]) {
            t->x[4] = 0;
            t->x[10] = 1; /* it rests */
        }
    }
    return 0;
}
static double interval(Thing *t, int clock, int *qualifier) { return 0; }

#elif MODEL == CONTROLLER
/* At each tick of clock 0, every "period": sees the input and switches the command between 0 and "strength"; counts the
 * ticks of the triggered clock 1, and keeps the time of the last.  1 seen (clocked), 2 command (clocked), 3 saw (clocked),
 * 4 count (discrete), 5 last (discrete), 6 strength, 7 ticks (discrete) */
static const int waits[] = {0, 2, 2, 2, 1, 1, 0, 1};
static const int based = 1;
static void defaults(double *x) { x[6] = 4; }
static void begin(Thing *t) { t->due[0] = t->time; }
static double move(Thing *t, double to) { return to; }
static void look(Thing *t)
{
    if (t->ticking & 1) {
        t->x[2] = (int)t->x[7] % 2 ? t->x[6] : 0;
        t->x[3] = t->x[1];
    }
}
static int update(Thing *t)
{
    if (t->ticking & 1) {
        t->x[7]++;
        t->due[0] = PERIOD * floor(t->time / PERIOD + 1.5);
    }
    if (t->ticking & 2) {
        t->x[4]++;
        t->x[5] = t->time;
    }
    return 0;
}
static double interval(Thing *t, int clock, int *qualifier) { *qualifier = 1; return PERIOD; }

#elif MODEL == CLOCKS
/* One clock of each kind: 0 constant, a third of a second; 1 fixed, asked for, 0.1 s after 0.05 s; 2 fixed, declared;
 * 3 tunable, 0.2 s, 0.3 s from its fourth tick on; 4 changing, each interval twice the one before, from 0.01 s;
 * 5 countdown, 0.025 s after each tick of clock 1; 6 triggered, counts.  Outputs 1-7: ticks of each; 8: 0.3 if changed */
static const int waits[] = {0, 1, 1, 1, 1, 1, 1, 1, 1};
static const int based = 0x3f;
static void defaults(double *x) { x[39] = 0.25; }
static void begin(Thing *t)
{
    t->due[0] = t->due[2] = t->time;
    t->due[1] = t->due[3] = t->time + 0.05;
    t->due[4] = t->time + 0.01;
}
static double move(Thing *t, double to) { return to; }
static void look(Thing *t) { }
static double interval(Thing *t, int clock, int *qualifier)
{
    double intervals[6] = {1.0 / 3, 0.1, t->x[39], t->x[4] < 4 ? 0.2 : 0.3, 0.01 * pow(2, t->x[5]), 0.025};
    *qualifier = 1;
    if (clock == 3 && (t->mode == INITIALIZATION || t->x[8]))
        *qualifier = 2;
    if (clock == 4 && (t->mode == INITIALIZATION || t->ask >> 4 & 1))
        *qualifier = 2;
    if (clock == 5)
        *qualifier = t->x[9] ? 2 : t->due[5] < 0 ? 0 : 1;
    return intervals[clock];
}
static int update(Thing *t)
{
    int k, unused;
    t->x[8] = 0;
    for (k = 0; k < 7; k++)
        if (t->ticking >> k & 1) {
            t->x[k + 1]++;
            if (k == 3)
                t->x[8] = t->x[4] == 4;
            if (k < 4)
                t->due[k] = k == 3 && t->x[8] ? t->time + 0.3 : t->due[k] + interval(t, k, &unused);
        }
    if (t->ticking >> 4 & 1)
        t->due[4] = t->time + 0.01 * pow(2, t->x[5]);
    if (t->ticking >> 5 & 1)
        t->due[5] = -1;
    t->x[9] = t->ticking >> 1 & 1;
    if (t->x[9])
        t->due[5] = t->time + 0.025;
    t->ask = 1 << 5 | (t->ticking & 1 << 4) | (t->x[8] && t->ticking >> 3 & 1 ? 1 << 3 : 0);
    return 0;
}

#elif MODEL == STAIR
/* Counts time events at every "width"; asks for three updates at each, and for the end of the simulation at the "last".
 * 1 count (discrete), 2 width, 3 updates (discrete), 5 last */
static const int waits[] = {0, 1, 0, 1};
static const int based = 0;
static void defaults(double *x) { x[2] = 0.1; }
static void begin(Thing *t) { t->next = t->time + t->x[2]; }
static double move(Thing *t, double to)
{
    t->pending = t->next - to < 1e-15 * (1 + to);
    return to;
}
static void look(Thing *t)
{
    if (t->mode == EVENT && t->x[6])
        t->ticking |= 1; /* clock 0, in the instant after the last update: nothing else asks for another one */
}
static int update(Thing *t)
{
    t->x[6] = 0;
    if (t->pending)
        t->x[4] = 3;
    t->x[3] = t->updates + 1;
    if (t->x[4] > 0 && --t->x[4] == 0) {
        t->x[1]++;
        t->x[6] = 1;
        t->end = t->x[1] == t->x[5];
        t->next = t->x[2] > 0 ? t->x[2] * (t->x[1] + 1) : t->time;
    }
    return t->x[4] > 0;
}
static double interval(Thing *t, int clock, int *qualifier) { return 0; }

#elif MODEL == RELAY
/* y = 1 - u, from the update on: two in a ring never agree.  1 u, 2 y, 3 speed (continuous, a copy of y when an event
 * began), 4 start.  Clock 0: y changed */
static const int waits[] = {0, 1, 1, 0, 0};
static const int based = 0;
static void defaults(double *x) { x[2] = 1; }
static void begin(Thing *t) { t->x[2] = 1 - t->x[1]; }
static double move(Thing *t, double to) { return to; }
static void look(Thing *t)
{
    if (t->mode == INITIALIZATION)
        t->x[2] = 1 - t->x[1];
}
static int update(Thing *t)
{
    t->x[2] = 1 - t->x[1];
    return 0;
}
static double interval(Thing *t, int clock, int *qualifier) { return 0; }

#elif MODEL == SUMMING
/* y = u + step at once, in event mode: in a ring an algebraic loop without solution.  1 u, 2 y, 3 step */
static const int waits[] = {0, 1, 1, 0};
static const int based = 0;
static void defaults(double *x) { x[3] = 1; }
static void begin(Thing *t) { }
static double move(Thing *t, double to) { return to; }
static void look(Thing *t)
{
    if (t->mode == EVENT)
        t->x[2] = t->x[1] + t->x[3];
}
static int update(Thing *t) { return 0; }
static double interval(Thing *t, int clock, int *qualifier) { return 0; }
#endif

/* One communication step: ticks (new samples, or once at the start), between them the solution of the equations. */

/* The nearest whole nanosecond if *t* means one: a thousandth of a tick off, or what rounding explains. */
static double snapped(double t)
{
    double ns = t * TICKS, whole = floor(ns + 0.5), slack = 4 * DBL_EPSILON * fabs(ns);
    return fabs(ns - whole) <= (slack > 1e-3 ? slack : 1e-3) ? whole / TICKS : t;
}

static Status advance(Instance *in, double t, double stop, Ending *ending)
{
    double *x = in->slot + model.x;
    ending->reached = stop;
    if (model.flow) {
        double n = model.micro < 0 ? 1 : ceil((stop - t) / in->slot[model.micro] - 1e-6), h, i;
        n = n > 1 ? n : 1;
        h = snapped(stop - t) / n; /* the same in every step, so that constants stay */
        for (i = 0; i < n; i++) {
            evaluate(in, model.flow, t + i * h, h, x, in->trial);
            accept(in);
        }
        return STATUS_OK;
    }
    return model.ode && model.n_x ? integrate(in, t, stop, ending) : STATUS_OK;
}

static Status synchronise(Instance *in, double t, double to)
{
    double *x = in->slot + model.x;
    int i;
    evaluate(in, model.sync, t, snapped(to - t), x, in->trial);
    for (i = 0; i < model.n_x && in->signs_known; i++)
        in->signs_known = !model.decides[i] || in->trial[i] == x[i];
    accept(in);
    return check_finite(in, x, model.x, model.n_x, t, "state");
}

/* First tick at or after *from*, in ns, and the distance between ticks; 0 if the period is no positive number of ns. */
static int64_t first_tick(const Instance *in, double from, int64_t *period)
{
    double ns = floor(in->slot[model.period] * TICKS + 0.5);
    if (!(ns >= 1 && ns < 9e18)) {
        *period = 0;
        return 0;
    }
    *period = (int64_t)ns;
    return (int64_t)ceil(ceil(from * TICKS - 1e-3) / ns) * *period;
}

/* Solve from *from* to *to*, with the sync of a component executed at each of its ticks, or first thing in a step; but
 * not again in the rest of a step that ended early. */
static Status solve(Instance *in, double from, double to, int continuing, Ending *ending)
{
    double now = from;
    if (model.sync && model.period < 0) {
        if (!continuing && synchronise(in, from, to) != STATUS_OK)
            return STATUS_ERROR;
    } else if (model.sync) {
        int64_t period, tick = first_tick(in, from, &period);
        char value[32], time[32];
        if (!period)
            return report(in, STATUS_ERROR, "the sample period is %s s at t = %s s, but must be at least 1 ns",
                          number(value, sizeof value, in->slot[model.period]), number(time, sizeof time, from));
        for (; (double)tick / TICKS < to; tick += period) {
            double at = (double)tick / TICKS;
            if (at > now && (advance(in, now, at, ending) != STATUS_OK || ending->early))
                return in->mode == FAILED ? STATUS_ERROR : STATUS_OK;
            now = in->slot[0] = at;
            if (synchronise(in, at, to) != STATUS_OK)
                return STATUS_ERROR;
        }
    }
    return advance(in, now, to, ending);
}

static Status step(Instance *in, double from, double to, Ending *ending)
{
    char now[32], asked[32];
    int continuing = in->continuing;
    in->continuing = 0;
    ending->early = 0;
    ending->reached = in->slot[0];
    from = snapped(from);
    to = snapped(to);
    if (fabs(from - in->slot[0]) > 1e-9 + 8 * DBL_EPSILON * fabs(from))
        return report(in, STATUS_ERROR, "a step was asked for from t = %s s, but the component is at t = %s s",
                      number(asked, sizeof asked, from), number(now, sizeof now, in->slot[0]));
    if (!(to > from))
        return report(in, STATUS_ERROR, "a step was asked for from t = %s s to %s s, but a step must be longer than nothing",
                      number(now, sizeof now, from), number(asked, sizeof asked, to));
    in->outputs_valid = in->derivatives_valid = in->shown_at_end = 0;
    if (check_finite(in, in->slot + model.u, model.u, model.n_u, from, "input") != STATUS_OK)
        return STATUS_ERROR;
    in->slot[0] = in->since = from;
    if (solve(in, from, to, continuing, ending) != STATUS_OK)
        return STATUS_ERROR;
    in->slot[0] = ending->reached;
    if (in->ask)
        in->ask(in, ending->reached); /* what outputs that an input reaches are computed from */
    in->continuing = ending->early && ending->reached < to;
    if (in->shown_at_end)
        show(in);
    return check_finite(in, in->slot + model.x, model.x, model.n_x, ending->reached, "state");
}

/* Events: an indicator changes its sign, zero counting as positive. */

static void signs_of(const double *indicators, signed char *found)
{
    int i;
    for (i = 0; i < model.n_g; i++)
        found[i] = indicators[i] >= 0 ? 1 : -1;
}

static void signs(Instance *in, double t, const double *x, signed char *found)
{
    if (!model.n_g)
        return;
    evaluate(in, model.zero, t, 0.0, x, in->indicator);
    signs_of(in->indicator, found);
}

static int changed(const Instance *in)
{
    return memcmp(in->before, in->after, (size_t)model.n_g) != 0;
}

/* Whether a sign changes on the way to in->trial at t.  Where that is the *last* of a step the outputs are asked for
 * next: they are computed with the indicators, in little more time than these alone. */
static int crosses(Instance *in, double t, int last)
{
    if (!model.n_g)
        return 0;
    if (last) {
        evaluate(in, model.out, t, 0.0, in->trial, in->shown);
        signs_of(in->shown + model.n_y, in->after);
    } else
        signs(in, t, in->trial, in->after);
    in->shown_at_end = last && !changed(in);
    return changed(in);
}

/* Whether a sign changed in the step of length h just taken from t; if so, *at is how far into the step the first
 * change is complete, located on the dense output to 1e-13 s.  Bisection: an event is rare, and this cannot fail. */
static int event_between(Instance *in, double t, double h, double *at)
{
    double low = 0, high = h, width = 4 * DBL_EPSILON * (fabs(t) + h);
    if (!crosses(in, t + h, 0))
        return 0;
    if (width < 1e-13)
        width = 1e-13;
    prepare_dense(in, h, in->slot + model.x);
    while (high - low > width) {
        double middle = low + 0.5 * (high - low);
        dense_state(in, middle / h, in->probe);
        signs(in, t + middle, in->probe, in->after);
        if (changed(in))
            high = middle;
        else
            low = middle;
    }
    *at = high;
    return 1;
}

/* The states are just past an event at t: note who crossed which way and let the component change its states. */
static Status jump(Instance *in, double t, int *event, int *announced)
{
    double *x = in->slot + model.x;
    int i;
    signs(in, t, x, in->after);
    *event = *announced = 0;
    for (i = 0; i < model.n_g; i++) {
        in->crossed[i] = (in->after[i] - in->before[i]) / 2;
        if (in->crossed[i] != 0) {
            *event = i;
            *announced |= model.announced[i];
        }
    }
    if (!model.jump)
        return STATUS_OK;
    evaluate(in, model.jump, t, 0.0, x, in->trial);
    accept(in);
    return check_finite(in, x, model.x, model.n_x, t, "state");
}

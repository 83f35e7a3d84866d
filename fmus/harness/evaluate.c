/* Calling the equations on the values of an instance. */

/* The inputs at t: those set, or a polynomial through them. */
static const double *inputs_at(Instance *in, double t)
{
    const double *u = in->slot + model.u;
    double since = t - in->since;
    int i;
    if (in->ask && in->mode == STEP_MODE)
        in->ask(in, t);
    if (!in->n_slopes)
        return u;
    for (i = 0; i < model.n_u; i++)
        in->u_now[i] = u[i] + since * (in->slope[0][i] + since / 2 * in->slope[1][i]);
    return in->u_now;
}

/* What depends on parameters and the step length alone, computed when they change. */
static const double *constants(Instance *in, double h)
{
    int which = h != 0;
    const double *arg[SZ_ARG];
    double *res[SZ_RES];
    if (in->constants_for[which] == h)
        return in->constants[which];
    memset(arg, 0, sizeof arg);
    arg[1] = &h;
    arg[4] = in->slot + model.p;
    res[0] = in->constants[which];
    model.once(arg, res, in->iw, in->work, 0);
    in->constants_for[which] = h;
    return in->constants[which];
}

static void call(Instance *in, Equation *f, double t, double h, const double *x, const double *more, const double *last, double *result)
{
    const double *arg[SZ_ARG]; /* generated code keeps its own pointers behind those it is given */
    double *res[SZ_RES];
    arg[0] = &t;
    arg[1] = &h;
    arg[2] = x;
    arg[3] = inputs_at(in, t);
    arg[4] = in->slot + model.p;
    arg[5] = in->rows;
    arg[6] = model.once ? constants(in, h) : NULL;
    if (model.where && (f != model.sync || model.sync_looks_up)) {
        res[0] = in->keys;
        model.where(arg, res, in->iw, in->work, 0);
        table_rows(in);
    }
    arg[7] = more; /* not before: where may have used what lies behind its own arguments */
    arg[8] = last;
    res[0] = result;
    f(arg, res, in->iw, in->work, 0);
}

/* Evaluate *f* at a state; *result* must not overlap *x*, since generated code writes before it has read everything. */
static void evaluate(Instance *in, Equation *f, double t, double h, const double *x, double *result)
{
    call(in, f, t, h, x, in->crossed, NULL, result);
}

/* The states are those tried. */
static void accept(Instance *in)
{
    copy(in->slot + model.x, in->trial, (size_t)model.n_x);
}

/* Whether all values are finite: x - x is 0, or no number.  Four sums, since each addition waits for the one before. */
static inline int all_finite(const double *values, int n)
{
    double a = 0, b = 0, c = 0, d = 0;
    int i;
    for (i = 0; i + 4 <= n; i += 4) {
        a += values[i] - values[i];
        b += values[i + 1] - values[i + 1];
        c += values[i + 2] - values[i + 2];
        d += values[i + 3] - values[i + 3];
    }
    for (; i < n; i++)
        a += values[i] - values[i];
    return (a + b) + (c + d) == 0;
}

/* Say which of the values is no finite number. */
static Status not_finite(Instance *in, const double *values, int first_slot, double t, const char *what)
{
    int i = 0;
    char value[32], time[32];
    while (values[i] - values[i] == 0)
        i++;
    return report(in, STATUS_ERROR, "%s %s is %s at t = %s s", what, model.labels[first_slot + i],
                  number(value, sizeof value, values[i]), number(time, sizeof time, t));
}

static inline Status check_finite(Instance *in, const double *values, int first_slot, int n, double t, const char *what)
{
    return all_finite(values, n) ? STATUS_OK : not_finite(in, values, first_slot, t, what);
}

static void show(Instance *in)
{
    copy(in->slot + model.y, in->shown, (size_t)model.n_y);
    in->outputs_valid = 1;
}

static void refresh_outputs(Instance *in)
{
    if (!in->outputs_valid && model.n_y > 0) {
        double *result = model.n_g ? in->shown : in->slot + model.y; /* no room for indicators there */
        evaluate(in, model.out, in->slot[0], 0.0, in->slot + model.x, result);
        if (model.n_g)
            show(in);
    }
    in->outputs_valid = 1;
}

static void refresh_derivatives(Instance *in)
{
    if (!in->derivatives_valid && model.ode)
        evaluate(in, model.ode, in->slot[0], 0.0, in->slot + model.x, in->slot + model.dx);
    in->derivatives_valid = 1;
}

/* Derivatives of the states' derivatives and of the outputs along in->seed (states, then inputs). */
static void tangent(Instance *in)
{
    call(in, model.jvp, in->slot[0], 0.0, in->slot + model.x, in->seed, in->seed + model.n_x, in->tangent);
}

/* Dormand and Prince's Runge-Kutta pair of orders 5 and 4 with Lund-stabilised step control and dense output
 * (Hairer, Norsett, Wanner: Solving Ordinary Differential Equations I, 2nd ed., sections II.4-II.6).
 * The error is measured in the maximum norm, each state by the tolerance times (its nominal value + its size).
 */

static const double C[7] = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1};
static const double A[7][6] = {
    {0},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
static const double E[7] = {71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
static const double D[7] = {-12715105075.0 / 11282082432.0, 0, 87487479700.0 / 32700410799.0, -10690763975.0 / 1880347072.0,
                            701980252875.0 / 199316789632.0, -1453857185.0 / 822651844.0, 69997945.0 / 29380423.0};

static const double SAFETY = 0.9, SHRINK = 0.2, GROW = 10.0, BETA = 0.04, EXPONENT = 0.17; /* 1/5 - 0.75 beta */
/* First step after an event, in s.  The states are a hair past it: they may come back and cross again, which a large step
 * would jump over (a ball leaves the floor and is below it again).  Anything longer than this is seen. */
static const double AFTER_EVENT = 1e-6;
static const int MAX_STEPS = 10000000; /* in one communication step */

/* Bogacki and Shampine's three stages of order 3, with the difference from the second order that the first two have: for
 * steps so short that the other pair's seven are a waste, as between the communication points of a fast exchange.  A step
 * is that short where the difference is a hundredth of the tolerance; the error itself is another order smaller. */
static const double SHORT_C[3] = {0, 1.0 / 2, 3.0 / 4};
static const double SHORT_A[4][3] = {{0}, {1.0 / 2}, {0, 3.0 / 4}, {2.0 / 9, 1.0 / 3, 4.0 / 9}};
static const double SHORT_E[3] = {2.0 / 9, -2.0 / 3, 4.0 / 9};
static const double SHORT = 0.01;
/* The same of the first four stages of the other pair, by which it sees that the next step may be that short: their
 * order 3 less their order 2. */
static const double SMOOTH_E[4] = {55.0 / 72, 0, -11.0 / 9, 11.0 / 24};

static double scale_of(const Instance *in, int i, double a, double b)
{
    double larger = fabs(a) > fabs(b) ? fabs(a) : fabs(b);
    return in->tolerance * (model.nominal[i] + larger);
}

/* to = x + h (weight[0] k[0] + weight[1] k[1] + ...) */
static WIDE void combine(const Instance *in, double *to, const double *x, double h, const double *weight, int stages)
{
    int i, s;
#ifdef WITH_VECTORS
    for (i = 0; i < model.n_x; i += 4) {
        Four sum = SAME(weight[0]) * FROM(in->k[0] + i);
        for (s = 1; s < stages; s++)
            sum += SAME(weight[s]) * FROM(in->k[s] + i);
        TO(to + i) = FROM(x + i) + SAME(h) * sum;
    }
#else
    for (i = 0; i < model.n_x; i++) {
        double sum = weight[0] * in->k[0][i];
        for (s = 1; s < stages; s++)
            sum += weight[s] * in->k[s][i];
        to[i] = x[i] + h * sum;
    }
#endif
}

/* The largest error of the step from x to in->trial in units of the tolerance, NaN if one is not finite; those of all
 * states are in in->ratio. */
static WIDE double largest_error(Instance *in, const double *x, double h, const double *weight, int stages)
{
    double error = 0, strange = 0; /* x - x is 0, or no number */
    int i = 0, s;
#ifdef WITH_VECTORS
    const Four tolerance = SAME(in->tolerance);
    Four most = SAME(0.0), odd = SAME(0.0);
    for (; i + 4 <= model.n_x; i += 4) {
        Four sum = SAME(0.0), a = SIZE(FROM(x + i)), b = SIZE(FROM(in->trial + i)), ratio;
        for (s = 0; s < stages; s++)
            sum += SAME(weight[s]) * FROM(in->k[s] + i);
        ratio = SIZE(SAME(h) * sum) / (tolerance * (FROM(model.nominal + i) + PICK(a > b, a, b)));
        most = PICK(ratio > most, ratio, most);
        odd += ratio - ratio;
        TO(in->ratio + i) = ratio;
    }
    for (s = 0; s < 4; s++) {
        error = most[s] > error ? most[s] : error;
        strange += odd[s];
    }
#endif
    for (; i < model.n_x; i++) {
        double sum = 0;
        for (s = 0; s < stages; s++)
            sum += weight[s] * in->k[s][i];
        in->ratio[i] = fabs(h * sum) / scale_of(in, i, x[i], in->trial[i]);
        error = in->ratio[i] > error ? in->ratio[i] : error;
        strange += in->ratio[i] - in->ratio[i];
    }
    return strange == 0 ? error : NAN;
}

/* The state that has the largest error. */
static int worst_state(const Instance *in)
{
    int i, worst = 0;
    for (i = 1; i < model.n_x; i++)
        if (in->ratio[worst] == in->ratio[worst] && !(in->ratio[i] <= in->ratio[worst]))
            worst = i;
    return worst;
}

/* First step size: one for which an explicit Euler step changes the states by about a hundredth of their scale. */
static double first_step(Instance *in, double t, const double *x, double remaining)
{
    double size = 0, slope = 0, bend = 0, h, by_order;
    int i;
    for (i = 0; i < model.n_x; i++) {
        double scale = scale_of(in, i, x[i], x[i]);
        if (fabs(x[i]) / scale > size)
            size = fabs(x[i]) / scale;
        if (fabs(in->k[0][i]) / scale > slope)
            slope = fabs(in->k[0][i]) / scale;
    }
    h = size < 1e-10 || slope < 1e-10 ? 1e-6 : 0.01 * size / slope;
    h = h < remaining ? h : remaining;
    for (i = 0; i < model.n_x; i++)
        in->trial[i] = x[i] + h * in->k[0][i];
    evaluate(in, model.ode, t + h, 0.0, in->trial, in->k[1]);
    for (i = 0; i < model.n_x; i++) {
        double change = fabs(in->k[1][i] - in->k[0][i]) / scale_of(in, i, x[i], x[i]) / h;
        if (change > bend)
            bend = change;
    }
    bend = bend > slope ? bend : slope;
    by_order = bend <= 1e-15 ? (h * 1e-3 > 1e-6 ? h * 1e-3 : 1e-6) : pow(0.01 / bend, 0.2);
    return 100 * h < by_order ? 100 * h : by_order;
}

/* Three stages from x with k[0] known; returns the error in units of the tolerance. */
static double try_short_step(Instance *in, double t, double h, const double *x)
{
    int s;
    for (s = 1; s < 3; s++) {
        combine(in, in->trial, x, h, SHORT_A[s], s);
        evaluate(in, model.ode, t + SHORT_C[s] * h, 0.0, in->trial, in->k[s]);
    }
    combine(in, in->trial, x, h, SHORT_A[3], 3);
    return largest_error(in, x, h, SHORT_E, 3);
}

/* Take one trial step from x with k[0] known; returns the error in units of the tolerance, NaN if a stage is not
 * finite.  *brief* allows three stages, and says whether these are all. */
static double try_step(Instance *in, double t, double h, const double *x, int *brief)
{
    double error;
    int s;
    *brief = *brief && in->smooth;
    if (*brief && (error = try_short_step(in, t, h, x)) <= SHORT)
        return error;
    *brief = 0;
    for (s = 1; s < 7; s++) {
        combine(in, in->trial, x, h, A[s], s);
        evaluate(in, model.ode, t + C[s] * h, 0.0, in->trial, in->k[s]);
    }
    in->smooth = largest_error(in, x, h, SMOOTH_E, 4) <= SHORT;
    return largest_error(in, x, h, E, 7);
}

/* Prepare the dense output of the step just taken from x to in->trial. */
static void prepare_dense(Instance *in, double h, const double *x)
{
    int i, s;
    for (i = 0; i < model.n_x; i++) {
        double change = in->trial[i] - x[i], bend = h * in->k[0][i] - change, sum = 0;
        for (s = 0; s < 7; s++)
            sum += D[s] * in->k[s][i];
        in->dense[0][i] = x[i];
        in->dense[1][i] = change;
        in->dense[2][i] = bend;
        in->dense[3][i] = change - h * in->k[6][i] - bend;
        in->dense[4][i] = h * sum;
    }
}

/* State at the fraction *at* of the step whose dense output was prepared. */
static void dense_state(const Instance *in, double at, double *x)
{
    int i;
    for (i = 0; i < model.n_x; i++)
        x[i] = in->dense[0][i] + at * (in->dense[1][i] + (1 - at) * (in->dense[2][i] + at * (in->dense[3][i] + (1 - at) * in->dense[4][i])));
}

/* Find one accepted step of at most *remaining* from in->slot's states; gives its length, and by *brief* whether it has
 * only three stages, and so neither a dense output nor the first stage of the next step. */
static Status accepted_step(Instance *in, double t, double remaining, double *previous_error, int *brief, double *taken)
{
    double *x = in->slot + model.x, h, error, factor;
    int rejected = 0, worst, whole;
    char value[32], time[32], length[32];
    if (in->h_next <= 0)
        in->h_next = first_step(in, t, x, remaining);
    h = in->h_next;
    for (;;) {
        whole = 1.01 * h >= remaining;
        if (whole)
            h = remaining;
        error = try_step(in, t, h, x, brief);
        if (error <= 1)
            break;
        rejected = 1;
        if (h <= 16 * DBL_EPSILON * fabs(t) || h < 1e-18) {
            worst = worst_state(in);
            return report(in, STATUS_ERROR, "the integrator cannot go on at t = %s s with %s = %s: its step fell to %s s",
                          number(time, sizeof time, t), model.labels[model.x + worst], number(value, sizeof value, x[worst]),
                          number(length, sizeof length, h));
        }
        factor = error == error ? SAFETY / pow(error, EXPONENT) : SHRINK; /* error != error: a stage was not finite */
        h *= factor > SHRINK ? factor : SHRINK;
    }
    factor = error > 0 && !*brief ? SAFETY * pow(*previous_error, BETA) / pow(error, EXPONENT) : GROW;
    factor = factor < SHRINK ? SHRINK : factor > GROW ? GROW : factor;
    if (rejected && factor > 1)
        factor = 1;
    /* a step cut short by the end of the communication step says nothing against the size it was cut from */
    if (!(whole && !rejected && h * factor < in->h_next))
        in->h_next = h * factor;
    *previous_error = error > 1e-4 && !*brief ? error : 1e-4;
    *taken = whole ? remaining : h;
    return STATUS_OK;
}

/* Where everybody can meet for an event at t: the first tick at or after it, at least one after *begin*. */
static double meeting(double t, double begin)
{
    double tick = ceil(t * TICKS - 1e-3), next = ceil(begin * TICKS - 1e-3) + 1;
    return (tick > next ? tick : next) / TICKS;
}

/* Integrate from t to *stop*, through every event.  Where it is allowed, ends early at an announced one, unless the
 * tick to meet for it is the end anyway: then the ending is early all the same, but complete. */
static Status integrate(Instance *in, double t, double stop, Ending *ending)
{
    double *x = in->slot + model.x, *swap, previous_error = 1e-4, h = 0, at, last_event = t, begin = t;
    int steps = 0, close_events = 0, announced, event, brief;
    char time[32], value[32];
    evaluate(in, model.ode, t, 0.0, x, in->k[0]);
    if (!in->signs_known)
        signs(in, t, x, in->before);
    in->signs_known = 0;
    while (t < stop) {
        brief = 1;
        if (accepted_step(in, t, stop - t, &previous_error, &brief, &h) != STATUS_OK)
            return STATUS_ERROR;
        if (brief && crosses(in, h == stop - t ? stop : t + h, h == stop - t)) {
            brief = 0;
            in->h_next = h; /* no longer than where the change was seen: it may change back */
            if (accepted_step(in, t, stop - t, &previous_error, &brief, &h) != STATUS_OK)
                return STATUS_ERROR;
        }
        if (++steps > MAX_STEPS)
            return report(in, STATUS_ERROR, "the integrator took %d steps and is only at t = %s s, with %s = %s", MAX_STEPS,
                          number(time, sizeof time, t), model.labels[model.x], number(value, sizeof value, x[0]));
        if (brief || !event_between(in, t, h, &at)) {
            accept(in);
            t = h == stop - t ? stop : t + h;
            swap = in->k[0]; /* the last stage is the first of the next step */
            in->k[0] = in->k[6];
            in->k[6] = swap;
            if (brief && t < stop)
                evaluate(in, model.ode, t, 0.0, x, in->k[0]);
            continue;
        }
        dense_state(in, at / h, x);
        if (at == h)
            accept(in);
        t = at == stop - t ? stop : t + at;
        if (jump(in, t, &event, &announced) != STATUS_OK)
            return STATUS_ERROR;
        if (in->h_next > AFTER_EVENT)
            in->h_next = AFTER_EVENT;
        if (in->early_return && announced) {
            ending->early = 1;
            if (meeting(t, begin) < stop) {
                ending->reached = t;
                return STATUS_OK;
            }
        }
        close_events = t - last_event > 1e-9 ? 0 : close_events + 1;
        last_event = t;
        if (close_events > 100)
            return report(in, STATUS_ERROR, "events without end at t = %s s: more than 100 of %s within 1 ns of each other, the last with %s = %s",
                          number(time, sizeof time, t), model.events[event], model.labels[model.x], number(value, sizeof value, x[0]));
        evaluate(in, model.ode, t, 0.0, x, in->k[0]);
        signs(in, t, x, in->before);
        previous_error = 1e-4;
    }
    in->signs_known = model.of_states_alone; /* no sign has changed since they were looked at */
    return STATUS_OK;
}

/* Life of an instance: memory, start values, initialisation, reading and writing slots. */

static double *reserve(double **next, int n)
{
    double *here = *next;
    *next += (n + 3) / 4 * 4; /* whole vectors */
    return here;
}

/* Cut one block of memory into the arrays of an instance. */
static void lay_out(Instance *in)
{
    double *next = in->memory;
    int i;
    in->slot = reserve(&next, model.end);
    in->rows = reserve(&next, model.n_w);
    in->keys = reserve(&next, model.n_keys);
    for (i = 0; i < 2; i++)
        in->constants[i] = reserve(&next, model.n_k);
    for (i = 0; i < 7; i++)
        in->k[i] = reserve(&next, model.n_x);
    for (i = 0; i < 5; i++)
        in->dense[i] = reserve(&next, model.n_x);
    in->trial = reserve(&next, model.n_x);
    in->probe = reserve(&next, model.n_x);
    in->ratio = reserve(&next, model.n_x);
    in->shown = reserve(&next, model.n_y + model.n_g);
    in->indicator = reserve(&next, model.n_g);
    in->crossed = reserve(&next, model.n_g);
    in->seed = reserve(&next, model.n_x + model.n_u);
    in->tangent = reserve(&next, model.n_x + model.n_y);
    in->work = reserve(&next, model.n_work);
    in->slope[0] = reserve(&next, model.n_u);
    in->slope[1] = reserve(&next, model.n_u);
    in->u_now = reserve(&next, model.n_u);
}

/* ... and how much that takes at most: the numbers of each array, and three more. */
static size_t doubles_needed(void)
{
    return (size_t)(model.end + model.n_w + model.n_keys + 2 * model.n_k + 17 * model.n_x + 3 * model.n_g + 4 * model.n_u + 2 * model.n_y + model.n_work + 3 * 32);
}

static Instance *instance_new(const char *name)
{
    Instance *in = calloc(1, sizeof *in);
    if (!in)
        return NULL;
    in->memory = calloc(doubles_needed(), sizeof *in->memory);
    in->tables = calloc((size_t)model.n_tables + 1, sizeof *in->tables);
    in->hint = calloc((size_t)model.n_keys + 1, sizeof *in->hint);
    in->before = calloc((size_t)model.n_g + 1, 1);
    in->after = calloc((size_t)model.n_g + 1, 1);
    in->iw = calloc((size_t)model.n_iw + 1, sizeof *in->iw);
    in->name = malloc(strlen(name) + 1);
    if (!in->memory || !in->tables || !in->hint || !in->before || !in->after || !in->iw || !in->name) {
        instance_free(in);
        return NULL;
    }
    strcpy(in->name, name);
    in->token_hash = hash_token();
    lay_out(in);
    return in;
}

static void instance_free(Instance *in)
{
    int i;
    if (!in)
        return;
    for (i = 0; in->tables && i < model.n_tables; i++) {
        free(in->tables[i].text);
        free(in->tables[i].rows);
    }
    free(in->memory);
    free(in->tables);
    free(in->hint);
    free(in->before);
    free(in->after);
    free(in->iw);
    free(in->name);
    free(in);
}

/* The parameters may have changed. */
static void forget(Instance *in)
{
    in->outputs_valid = in->derivatives_valid = 0;
    in->signs_known = 0;
    in->constants_for[0] = in->constants_for[1] = NAN;
}

/* Back to the start values. */
static Status instance_reset(Instance *in)
{
    int i;
    in->slot[0] = 0;
    memcpy(in->slot + 1, model.start, sizeof(double) * (size_t)(model.n_p + model.n_u + model.n_x));
    in->tolerance = 1e-8;
    in->h_next = 0;
    in->smooth = 0;
    in->continuing = 0;
    in->n_slopes = 0;
    forget(in);
    in->mode = INSTANTIATED;
    for (i = 0; i < model.n_tables; i++)
        if (table_set(in, i, model.tables[i].start) != STATUS_OK)
            return STATUS_ERROR;
    return STATUS_OK;
}

static Status instance_start(Instance *in, double time, int tolerance_defined, double tolerance)
{
    char value[32];
    if (tolerance_defined && !(tolerance > 0 && tolerance < 1))
        return report(in, STATUS_ERROR, "the tolerance is %s, but must be between 0 and 1", number(value, sizeof value, tolerance));
    if (tolerance_defined)
        in->tolerance = tolerance;
    in->slot[0] = snapped(time);
    in->outputs_valid = in->derivatives_valid = 0;
    return STATUS_OK;
}

static const char *mode_name(Mode mode)
{
    switch (mode) {
    case INSTANTIATED: return "is not initialised";
    case INITIALIZATION: return "is in initialisation mode";
    case EVENT_MODE: return "is in event mode";
    case STEP_MODE: return "is in step mode";
    case TERMINATED: return "was terminated";
    default: return "has failed";
    }
}

static Status allowed(Instance *in, int modes, const char *function)
{
    if (in->mode & modes)
        return STATUS_OK;
    return report(in, STATUS_ERROR, "%s was called while the component %s, where it is not allowed", function, mode_name(in->mode));
}

/* Number of scalars behind a value reference: the whole array in FMI 3.0, one in FMI 2.0. */
static unsigned extent(unsigned reference)
{
    return FMI_VERSION == 2 ? 1 : reference < (unsigned)model.end ? model.extent[reference] : 0;
}

/* How many of n variables lie behind each other, inputs or outputs, from the first on; *values is how many scalars these
 * have.  They can be read and written at once.  Mostly these are all inputs or all outputs, as the time before. */
static size_t neighbours(Instance *in, const unsigned *references, size_t n, unsigned *values)
{
    unsigned first = references[0], next = first + extent(first), end = 0;
    int outputs = first >= (unsigned)model.y;
    Run *last = &in->last[outputs];
    size_t i;
    if (n == 1) {
        *values = next - first;
        return 1;
    }
    if (last->n && last->n <= n && !memcmp(references, last->references, sizeof *references * last->n)) {
        *values = last->values;
        return last->n;
    }
    if (first >= (unsigned)model.u && first < (unsigned)model.x)
        end = (unsigned)model.x;
    else if (outputs && first < (unsigned)model.dx)
        end = (unsigned)model.dx;
    for (i = 1; i < n && next < end && references[i] == next; i++)
        next += extent(next);
    *values = next - first;
    last->n = i <= sizeof last->references / sizeof *references ? i : 0;
    last->values = *values;
    memcpy(last->references, references, sizeof *references * last->n);
    return i;
}

/* Where n values of a variable are, computed first if they have to be; NULL after reporting an unknown reference. */
static const double *slot_read(Instance *in, unsigned reference, unsigned n)
{
    if (reference >= (unsigned)model.end || n > (unsigned)model.end - reference || n == 0) {
        report(in, STATUS_ERROR, "no Float64 variable has the value reference %u", reference);
        return NULL;
    }
    if (reference >= (unsigned)model.dx)
        refresh_derivatives(in);
    else if (reference >= (unsigned)model.y)
        refresh_outputs(in);
    return in->slot + reference;
}

static Status slot_write(Instance *in, unsigned reference, unsigned n, const double *values)
{
    int input = reference >= (unsigned)model.u && reference < (unsigned)model.x;
    char time[32];
    if (reference == 0 || reference >= (unsigned)model.y || n > (unsigned)model.y - reference || n == 0)
        return report(in, STATUS_ERROR, reference && reference < (unsigned)model.end ? "%s cannot be set: it is computed" : "the variable %s cannot be set",
                      reference < (unsigned)model.end ? model.labels[reference] : "with an unknown value reference");
    if (!input && !(in->mode & (INSTANTIATED | INITIALIZATION)))
        return report(in, STATUS_ERROR, "%s cannot be set at t = %s s: it is fixed once the initialisation has ended", model.labels[reference],
                      number(time, sizeof time, in->slot[0]));
    copy(in->slot + reference, values, n);
    in->continuing = 0;
    in->outputs_valid = in->derivatives_valid = 0;
    if (!input)
        forget(in);
    return STATUS_OK;
}

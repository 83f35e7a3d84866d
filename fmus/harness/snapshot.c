/* Everything the future depends on, as bytes: the same bytes give the same bits, in this instance or another one of the
 * same FMU with the same tables.  Outputs are computed again from them. */

typedef struct {
    uint64_t token, tables; /* whose snapshot it is */
    double h_next, tolerance, since;
    int64_t mode, continuing, n_slopes, smooth;
} Head;

enum { SLOPES = FMI_VERSION == 2 ? 2 : 0 }; /* derivatives of the inputs that are kept here, and not by the importer */

static uint64_t hash_token(void)
{
    uint64_t hash = 14695981039346656037u;
    const char *c;
    for (c = model.token; *c; c++)
        hash = (hash ^ (unsigned char)*c) * 1099511628211u;
    return hash;
}

/* time, parameters, inputs and states are the first slots */
static size_t n_saved(void)
{
    return (size_t)model.y;
}

static size_t snapshot_size(void)
{
    return sizeof(Head) + sizeof(double) * (SLOPES * (size_t)model.n_u + n_saved());
}

static void snapshot_write(const Instance *in, unsigned char *bytes)
{
    Head head;
    int i;
    head.token = in->token_hash;
    head.tables = in->tables_hash;
    head.h_next = in->h_next;
    head.tolerance = in->tolerance;
    head.mode = in->mode;
    head.continuing = in->continuing;
    head.since = in->since;
    head.n_slopes = in->n_slopes;
    head.smooth = in->smooth;
    memcpy(bytes, &head, sizeof head);
    bytes += sizeof head;
    for (i = 0; i < SLOPES; i++, bytes += sizeof(double) * (size_t)model.n_u)
        memcpy(bytes, in->slope[i], sizeof(double) * (size_t)model.n_u);
    memcpy(bytes, in->slot, sizeof(double) * n_saved());
}

static Status snapshot_read(Instance *in, const unsigned char *bytes)
{
    Head head;
    int i;
    memcpy(&head, bytes, sizeof head);
    if (head.token != in->token_hash)
        return report(in, STATUS_ERROR, "a state was given that another FMU wrote");
    if (head.tables != in->tables_hash)
        return report(in, STATUS_ERROR, "a state was given that was saved with other tables than this instance has");
    in->h_next = head.h_next;
    in->tolerance = head.tolerance;
    in->mode = (Mode)head.mode;
    in->continuing = (int)head.continuing;
    in->since = head.since;
    in->n_slopes = (int)head.n_slopes;
    in->smooth = (int)head.smooth;
    bytes += sizeof head;
    for (i = 0; i < SLOPES; i++, bytes += sizeof(double) * (size_t)model.n_u)
        memcpy(in->slope[i], bytes, sizeof(double) * (size_t)model.n_u);
    if (memcmp(in->slot + model.p, bytes + sizeof(double) * (size_t)model.p, sizeof(double) * (size_t)model.n_p))
        forget(in);
    memcpy(in->slot, bytes, sizeof(double) * n_saved());
    in->outputs_valid = in->derivatives_valid = in->signs_known = 0;
    return STATUS_OK;
}

/* The states that cross the API are these bytes in memory of their own. */

static Status snapshot_room(Instance *in, void **state)
{
    if (!*state && !(*state = malloc(snapshot_size())))
        return report(in, STATUS_ERROR, "out of memory for a state of %lu bytes", (unsigned long)snapshot_size());
    return STATUS_OK;
}

static Status snapshot_get(Instance *in, void **state)
{
    if (snapshot_room(in, state) != STATUS_OK)
        return STATUS_ERROR;
    snapshot_write(in, *state);
    return STATUS_OK;
}

static Status snapshot_fits(Instance *in, size_t size)
{
    if (size != snapshot_size())
        return report(in, STATUS_ERROR, "a state has %lu bytes here, but %lu were given", (unsigned long)snapshot_size(),
                      (unsigned long)size);
    return STATUS_OK;
}

static Status snapshot_serialize(Instance *in, const void *state, void *bytes, size_t size)
{
    if (snapshot_fits(in, size) != STATUS_OK)
        return STATUS_ERROR;
    memcpy(bytes, state, size);
    return STATUS_OK;
}

static Status snapshot_deserialize(Instance *in, const void *bytes, size_t size, void **state)
{
    if (snapshot_fits(in, size) != STATUS_OK || snapshot_room(in, state) != STATUS_OK)
        return STATUS_ERROR;
    memcpy(*state, bytes, size);
    return STATUS_OK;
}

/* Directional derivatives of outputs and of the states' derivatives by inputs and states, all states held. */

static Status derivative_along(Instance *in, const unsigned *unknowns, size_t n_unknowns, const unsigned *knowns,
                               size_t n_knowns, const double *seed, size_t n_seed, double *result, size_t n_result)
{
    size_t i, used = 0;
    unsigned n;
    memset(in->seed, 0, sizeof *in->seed * (size_t)(model.n_x + model.n_u));
    for (i = 0; i < n_knowns; i++, used += n) {
        int input = knowns[i] >= (unsigned)model.u && knowns[i] < (unsigned)model.x;
        n = extent(knowns[i]);
        if (knowns[i] < (unsigned)model.u || knowns[i] >= (unsigned)model.y || used + n > n_seed)
            return report(in, STATUS_ERROR, "directional derivatives are by inputs and states: value reference %u is neither, or the seed is short", knowns[i]);
        memcpy(in->seed + (input ? model.n_x + (int)knowns[i] - model.u : (int)knowns[i] - model.x), seed + used, sizeof *seed * n);
    }
    tangent(in);
    for (i = 0, used = 0; i < n_unknowns; i++, used += n) {
        int derivative = unknowns[i] >= (unsigned)model.dx;
        n = extent(unknowns[i]);
        if (unknowns[i] < (unsigned)model.y || unknowns[i] >= (unsigned)model.end || used + n > n_result)
            return report(in, STATUS_ERROR, "directional derivatives are of outputs and derivatives: value reference %u is neither, or the result is short", unknowns[i]);
        memcpy(result + used, in->tangent + (derivative ? (int)unknowns[i] - model.dx : model.n_x + (int)unknowns[i] - model.y), sizeof *result * n);
    }
    return STATUS_OK;
}

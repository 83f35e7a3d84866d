/* FMI 2.0 co-simulation: a thin layer between the standard's functions and the harness. */
#include "fmi2Functions.h"

static void fmi2_send(Instance *in, Status status, const char *message)
{
    static const char *const category[] = {"logEvents", "logStatusWarning", "logStatusDiscard", "logStatusError", "logStatusFatal"};
    const fmi2CallbackFunctions *functions = in->callback.fmi2;
    functions->logger(in->environment, in->name, (fmi2Status)status, category[status], "%s", message);
}

#define ALLOWED(modes)                                                                                                 \
    Instance *in = c;                                                                                                  \
    if (!in || allowed(in, modes, __func__) != STATUS_OK)                                                              \
    return fmi2Error

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories, const fmi2String categories[])
{
    ALLOWED(ANY_MODE); /* only warnings and errors are logged, and those always */
    (void)loggingOn, (void)nCategories, (void)categories;
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID, fmi2String fmuResourceLocation,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean loggingOn)
{
    Instance *in = instance_new(instanceName ? instanceName : model.identifier);
    (void)fmuResourceLocation, (void)visible, (void)loggingOn;
    if (!in)
        return NULL;
    in->callback.fmi2 = functions;
    in->environment = functions ? functions->componentEnvironment : NULL;
    in->send = functions && functions->logger ? fmi2_send : NULL;
    if (fmuType != fmi2CoSimulation)
        report(in, STATUS_ERROR, "this FMU has no model exchange; use co-simulation");
    else if (!fmuGUID || strcmp(fmuGUID, model.token) != 0)
        report(in, STATUS_ERROR, "the GUID is %s, but this binary was built for %s", fmuGUID ? fmuGUID : "missing", model.token);
    else
        instance_reset(in);
    if (in->mode == FAILED) {
        instance_free(in);
        return NULL;
    }
    return in;
}

void fmi2FreeInstance(fmi2Component c)
{
    instance_free(c);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real startTime,
                               fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
    ALLOWED(INSTANTIATED);
    (void)stopTimeDefined, (void)stopTime;
    return (fmi2Status)instance_start(in, startTime, toleranceDefined, tolerance);
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    ALLOWED(INSTANTIATED);
    in->mode = INITIALIZATION;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    ALLOWED(INITIALIZATION);
    in->mode = STEP_MODE;
    return (fmi2Status)check_finite(in, in->slot + 1, 1, model.y - 1, in->slot[0], "start value");
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    ALLOWED(INITIALIZATION | STEP_MODE | TERMINATED);
    in->mode = TERMINATED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    return c ? (fmi2Status)instance_reset(c) : fmi2Error;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Real value[])
{
    size_t i, next;
    ALLOWED(ANY_MODE);
    for (i = 0; i < nvr; i = next) {
        unsigned n;
        const double *source;
        next = i + neighbours(in, vr + i, nvr - i, &n);
        source = slot_read(in, vr[i], n);
        if (!source)
            return fmi2Error;
        copy(value + i, source, n);
    }
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Real value[])
{
    size_t i, next;
    ALLOWED(ANY_MODE);
    for (i = 0; i < nvr; i = next) {
        unsigned n;
        next = i + neighbours(in, vr + i, nvr - i, &n);
        if (slot_write(in, vr[i], n, value + i) != STATUS_OK)
            return fmi2Error;
    }
    return fmi2OK;
}

/* Until they are set again, the inputs of every step are polynomials with these derivatives at its start. */
fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
                                       const fmi2Real value[])
{
    size_t i;
    int k;
    ALLOWED(ANY_MODE);
    for (i = 0; i < nvr; i++) {
        if (vr[i] < (unsigned)model.u || vr[i] >= (unsigned)model.x || order[i] < 1 || order[i] > 2)
            return (fmi2Status)report(in, STATUS_ERROR, "derivatives of order 1 and 2 are taken, of inputs: value reference %u, order %d", vr[i], (int)order[i]);
        in->slope[order[i] - 1][vr[i] - (unsigned)model.u] = value[i];
    }
    in->n_slopes = 0;
    for (k = 0; k < 2 * model.n_u; k++)
        if (in->slope[k / model.n_u][k % model.n_u] != 0)
            in->n_slopes = 2;
    in->continuing = 0;
    in->outputs_valid = in->derivatives_valid = 0;
    return fmi2OK;
}

static int table_of(Instance *in, fmi2ValueReference reference)
{
    if (reference >= (unsigned)model.end && reference - (unsigned)model.end < (unsigned)model.n_tables)
        return (int)reference - model.end;
    report(in, STATUS_ERROR, "no String variable has the value reference %u", reference);
    return -1;
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2String value[])
{
    size_t i;
    ALLOWED(ANY_MODE);
    for (i = 0; i < nvr; i++) {
        int table = table_of(in, vr[i]);
        if (table < 0)
            return fmi2Error;
        value[i] = in->tables[table].text;
    }
    return fmi2OK;
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2String value[])
{
    size_t i;
    ALLOWED(INSTANTIATED | INITIALIZATION);
    for (i = 0; i < nvr; i++) {
        int table = table_of(in, vr[i]);
        if (table < 0 || table_set(in, table, value[i]) != STATUS_OK)
            return fmi2Error;
    }
    return fmi2OK;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    ALLOWED(ANY_MODE);
    return (fmi2Status)snapshot_get(in, FMUstate);
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate)
{
    ALLOWED(ANY_MODE | FAILED);
    return (fmi2Status)snapshot_read(in, FMUstate);
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    ALLOWED(ANY_MODE | FAILED);
    free(*FMUstate);
    *FMUstate = NULL;
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size)
{
    ALLOWED(ANY_MODE | FAILED);
    (void)FMUstate;
    *size = snapshot_size();
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[], size_t size)
{
    ALLOWED(ANY_MODE | FAILED);
    return (fmi2Status)snapshot_serialize(in, FMUstate, serializedState, size);
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size, fmi2FMUstate *FMUstate)
{
    ALLOWED(ANY_MODE | FAILED);
    return (fmi2Status)snapshot_deserialize(in, serializedState, size, FMUstate);
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference vUnknown_ref[], size_t nUnknown,
                                        const fmi2ValueReference vKnown_ref[], size_t nKnown, const fmi2Real dvKnown[],
                                        fmi2Real dvUnknown[])
{
    ALLOWED(INITIALIZATION | STEP_MODE | TERMINATED);
    return (fmi2Status)derivative_along(in, vUnknown_ref, nUnknown, vKnown_ref, nKnown, dvKnown, nKnown, dvUnknown, nUnknown);
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint, fmi2Real communicationStepSize,
                      fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    Ending ending;
    ALLOWED(STEP_MODE);
    (void)noSetFMUStatePriorToCurrentPoint;
    return (fmi2Status)step(in, currentCommunicationPoint, currentCommunicationPoint + communicationStepSize, &ending);
}

/* A step ends before it returns, so that there is no status to ask for but the time reached. */
fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value)
{
    ALLOWED(ANY_MODE | FAILED);
    if (s != fmi2LastSuccessfulTime)
        return fmi2Discard;
    *value = in->slot[0];
    return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value)
{
    ALLOWED(ANY_MODE | FAILED);
    if (s != fmi2Terminated)
        return fmi2Discard;
    *value = fmi2False;
    return fmi2OK;
}

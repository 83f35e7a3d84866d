/* FMI 3.0 co-simulation: a thin layer between the standard's functions and the harness. */
#include "fmi3Functions.h"

static void fmi3_send(Instance *in, Status status, const char *message)
{
    static const char *const category[] = {"logEvents", "logStatusWarning", "logStatusDiscard", "logStatusError", "logStatusFatal"};
    ((fmi3LogMessageCallback)in->callback.fmi3)(in->environment, (fmi3Status)status, category[status], message);
}

static void fmi3_ask(Instance *in, double t)
{
    fmi3Boolean early = fmi3False;
    fmi3Float64 early_time = 0;
    ((fmi3IntermediateUpdateCallback)in->update)(in->environment, t, fmi3True, fmi3False, fmi3False, fmi3False, &early, &early_time);
}

#define ALLOWED(modes)                                                                                                 \
    Instance *in = instance;                                                                                           \
    if (!in || allowed(in, modes, __func__) != STATUS_OK)                                                              \
    return fmi3Error

const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean loggingOn, size_t nCategories, const fmi3String categories[])
{
    ALLOWED(ANY_MODE); /* only warnings and errors are logged, and those always */
    (void)loggingOn, (void)nCategories, (void)categories;
    return fmi3OK;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath,
                                         fmi3Boolean visible, fmi3Boolean loggingOn, fmi3Boolean eventModeUsed,
                                         fmi3Boolean earlyReturnAllowed, const fmi3ValueReference requiredIntermediateVariables[],
                                         size_t nRequiredIntermediateVariables, fmi3InstanceEnvironment instanceEnvironment,
                                         fmi3LogMessageCallback logMessage, fmi3IntermediateUpdateCallback intermediateUpdate)
{
    Instance *in = instance_new(instanceName ? instanceName : model.identifier);
    (void)resourcePath, (void)visible, (void)loggingOn, (void)requiredIntermediateVariables;
    if (!in)
        return NULL;
    in->environment = instanceEnvironment;
    in->callback.fmi3 = (void (*)(void))logMessage;
    in->send = logMessage ? fmi3_send : NULL;
    in->early_return = earlyReturnAllowed;
    in->event_mode = eventModeUsed;
    in->update = (void (*)(void))intermediateUpdate;
    in->ask = nRequiredIntermediateVariables && intermediateUpdate ? fmi3_ask : NULL;
    if (!instantiationToken || strcmp(instantiationToken, model.token) != 0)
        report(in, STATUS_ERROR, "the instantiation token is %s, but this binary was built for %s",
               instantiationToken ? instantiationToken : "missing", model.token);
    else
        instance_reset(in);
    if (in->mode == FAILED) {
        instance_free(in);
        return NULL;
    }
    return in;
}

void fmi3FreeInstance(fmi3Instance instance)
{
    instance_free(instance);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean toleranceDefined, fmi3Float64 tolerance,
                                       fmi3Float64 startTime, fmi3Boolean stopTimeDefined, fmi3Float64 stopTime)
{
    ALLOWED(INSTANTIATED);
    (void)stopTimeDefined, (void)stopTime;
    if (instance_start(in, startTime, toleranceDefined, tolerance) != STATUS_OK)
        return fmi3Error;
    in->mode = INITIALIZATION;
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    ALLOWED(INITIALIZATION);
    in->mode = in->event_mode ? EVENT_MODE : STEP_MODE;
    return (fmi3Status)check_finite(in, in->slot + 1, 1, model.y - 1, in->slot[0], "start value");
}

fmi3Status fmi3EnterEventMode(fmi3Instance instance)
{
    ALLOWED(STEP_MODE);
    if (!in->event_mode)
        return (fmi3Status)report(in, STATUS_ERROR, "%s was called, but the component was instantiated without event mode", __func__);
    in->mode = EVENT_MODE;
    return fmi3OK;
}

/* Events are handled where they happen, inside fmi3DoStep: nothing is left to do in event mode but to set inputs. */
fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *discreteStatesNeedUpdate, fmi3Boolean *terminateSimulation,
                                    fmi3Boolean *nominalsOfContinuousStatesChanged, fmi3Boolean *valuesOfContinuousStatesChanged,
                                    fmi3Boolean *nextEventTimeDefined, fmi3Float64 *nextEventTime)
{
    ALLOWED(EVENT_MODE);
    *discreteStatesNeedUpdate = *terminateSimulation = fmi3False;
    *nominalsOfContinuousStatesChanged = *valuesOfContinuousStatesChanged = fmi3False;
    *nextEventTimeDefined = fmi3False;
    *nextEventTime = 0;
    return fmi3OK;
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance)
{
    ALLOWED(INITIALIZATION | EVENT_MODE);
    return fmi3OK;
}

fmi3Status fmi3EnterStepMode(fmi3Instance instance)
{
    ALLOWED(EVENT_MODE);
    in->mode = STEP_MODE;
    return fmi3OK;
}

fmi3Status fmi3Terminate(fmi3Instance instance)
{
    ALLOWED(INITIALIZATION | EVENT_MODE | STEP_MODE | TERMINATED);
    in->mode = TERMINATED;
    return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance instance)
{
    return instance ? (fmi3Status)instance_reset(instance) : fmi3Error;
}

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                          fmi3Float64 values[], size_t nValues)
{
    size_t i, next, used = 0;
    ALLOWED(ANY_MODE);
    for (i = 0; i < nValueReferences; i = next) {
        unsigned n;
        const double *source;
        next = i + neighbours(in, valueReferences + i, nValueReferences - i, &n);
        source = slot_read(in, valueReferences[i], n);
        if (!source)
            return fmi3Error;
        if (used + n > nValues)
            break;
        copy(values + used, source, n);
        used += n;
    }
    if (i < nValueReferences || used != nValues)
        return (fmi3Status)report(in, STATUS_ERROR, "%s was given room for %lu values, but the variables asked for have another number", __func__, (unsigned long)nValues);
    return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                          const fmi3Float64 values[], size_t nValues)
{
    size_t i, next, used = 0;
    ALLOWED(ANY_MODE);
    for (i = 0; i < nValueReferences; i = next) {
        unsigned n;
        next = i + neighbours(in, valueReferences + i, nValueReferences - i, &n);
        if (used + n > nValues)
            break;
        if (slot_write(in, valueReferences[i], n, values + used) != STATUS_OK)
            return fmi3Error;
        used += n;
    }
    if (i < nValueReferences || used != nValues)
        return (fmi3Status)report(in, STATUS_ERROR, "%s was given %lu values, but the variables to set have another number", __func__, (unsigned long)nValues);
    return fmi3OK;
}

static int table_of(Instance *in, fmi3ValueReference reference)
{
    if (reference >= (unsigned)model.end && reference - (unsigned)model.end < (unsigned)model.n_tables)
        return (int)reference - model.end;
    report(in, STATUS_ERROR, "no String variable has the value reference %u", reference);
    return -1;
}

fmi3Status fmi3GetString(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                         fmi3String values[], size_t nValues)
{
    size_t i;
    ALLOWED(ANY_MODE);
    for (i = 0; i < nValueReferences && i < nValues; i++) {
        int table = table_of(in, valueReferences[i]);
        if (table < 0)
            return fmi3Error;
        values[i] = in->tables[table].text;
    }
    return fmi3OK;
}

fmi3Status fmi3SetString(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                         const fmi3String values[], size_t nValues)
{
    size_t i;
    ALLOWED(INSTANTIATED | INITIALIZATION);
    for (i = 0; i < nValueReferences && i < nValues; i++) {
        int table = table_of(in, valueReferences[i]);
        if (table < 0 || table_set(in, table, values[i]) != STATUS_OK)
            return fmi3Error;
    }
    return fmi3OK;
}

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *FMUState)
{
    ALLOWED(ANY_MODE);
    return (fmi3Status)snapshot_get(in, FMUState);
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState FMUState)
{
    ALLOWED(ANY_MODE | FAILED);
    return (fmi3Status)snapshot_read(in, FMUState);
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *FMUState)
{
    ALLOWED(ANY_MODE | FAILED);
    free(*FMUState);
    *FMUState = NULL;
    return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState FMUState, size_t *size)
{
    ALLOWED(ANY_MODE | FAILED);
    (void)FMUState;
    *size = snapshot_size();
    return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState FMUState, fmi3Byte serializedState[], size_t size)
{
    ALLOWED(ANY_MODE | FAILED);
    return (fmi3Status)snapshot_serialize(in, FMUState, serializedState, size);
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte serializedState[], size_t size, fmi3FMUState *FMUState)
{
    ALLOWED(ANY_MODE | FAILED);
    return (fmi3Status)snapshot_deserialize(in, serializedState, size, FMUState);
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[], size_t nUnknowns,
                                        const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed,
                                        fmi3Float64 sensitivity[], size_t nSensitivity)
{
    ALLOWED(INITIALIZATION | EVENT_MODE | STEP_MODE | TERMINATED);
    return (fmi3Status)derivative_along(in, unknowns, nUnknowns, knowns, nKnowns, seed, nSeed, sensitivity, nSensitivity);
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 currentCommunicationPoint, fmi3Float64 communicationStepSize,
                      fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean *eventHandlingNeeded,
                      fmi3Boolean *terminateSimulation, fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime)
{
    Ending ending;
    Status status;
    ALLOWED(STEP_MODE);
    (void)noSetFMUStatePriorToCurrentPoint;
    status = step(in, currentCommunicationPoint, currentCommunicationPoint + communicationStepSize, &ending);
    *eventHandlingNeeded = ending.early && in->event_mode;
    *terminateSimulation = fmi3False;
    *earlyReturn = ending.early != 0;
    *lastSuccessfulTime = ending.reached;
    return (fmi3Status)status;
}

/* The functions of FMI 3.0 for what these FMUs do not have: other types, clocks, structural parameters, model exchange,
 * scheduled execution, adjoint derivatives.  Each is exported, as the standard asks, and says so.
 */

static fmi3Status refuse3(Instance *in, const char *function)
{
    return in ? (fmi3Status)report(in, STATUS_ERROR, "%s is not supported: this FMU has Float64 and String variables and co-simulation only", function)
              : fmi3Error;
}

#define REFUSE(name, ...)                                                                                              \
    fmi3Status name(fmi3Instance instance, __VA_ARGS__)                                                                \
    {                                                                                                                  \
        return refuse3(instance, __func__);                                                                            \
    }
#define REFUSE_BARE(name)                                                                                              \
    fmi3Status name(fmi3Instance instance)                                                                             \
    {                                                                                                                  \
        return refuse3(instance, __func__);                                                                            \
    }
#define REFUSE_TYPE(Type)                                                                                              \
    REFUSE(fmi3Get##Type, const fmi3ValueReference r[], size_t n, fmi3##Type v[], size_t m)                            \
    REFUSE(fmi3Set##Type, const fmi3ValueReference r[], size_t n, const fmi3##Type v[], size_t m)

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

REFUSE_TYPE(Float32)
REFUSE_TYPE(Int8)
REFUSE_TYPE(UInt8)
REFUSE_TYPE(Int16)
REFUSE_TYPE(UInt16)
REFUSE_TYPE(Int32)
REFUSE_TYPE(UInt32)
REFUSE_TYPE(Int64)
REFUSE_TYPE(UInt64)
REFUSE_TYPE(Boolean)
REFUSE(fmi3GetBinary, const fmi3ValueReference r[], size_t n, size_t sizes[], fmi3Binary v[], size_t m)
REFUSE(fmi3SetBinary, const fmi3ValueReference r[], size_t n, const size_t sizes[], const fmi3Binary v[], size_t m)
REFUSE(fmi3GetClock, const fmi3ValueReference r[], size_t n, fmi3Clock v[])
REFUSE(fmi3SetClock, const fmi3ValueReference r[], size_t n, const fmi3Clock v[])
REFUSE(fmi3GetIntervalDecimal, const fmi3ValueReference r[], size_t n, fmi3Float64 v[], fmi3IntervalQualifier q[])
REFUSE(fmi3GetIntervalFraction, const fmi3ValueReference r[], size_t n, fmi3UInt64 c[], fmi3UInt64 d[], fmi3IntervalQualifier q[])
REFUSE(fmi3GetShiftDecimal, const fmi3ValueReference r[], size_t n, fmi3Float64 v[])
REFUSE(fmi3GetShiftFraction, const fmi3ValueReference r[], size_t n, fmi3UInt64 c[], fmi3UInt64 d[])
REFUSE(fmi3SetIntervalDecimal, const fmi3ValueReference r[], size_t n, const fmi3Float64 v[])
REFUSE(fmi3SetIntervalFraction, const fmi3ValueReference r[], size_t n, const fmi3UInt64 c[], const fmi3UInt64 d[])
REFUSE(fmi3SetShiftDecimal, const fmi3ValueReference r[], size_t n, const fmi3Float64 v[])
REFUSE(fmi3SetShiftFraction, const fmi3ValueReference r[], size_t n, const fmi3UInt64 c[], const fmi3UInt64 d[])
REFUSE(fmi3GetNumberOfVariableDependencies, fmi3ValueReference r, size_t *n)
REFUSE(fmi3GetVariableDependencies, fmi3ValueReference r, size_t a[], fmi3ValueReference b[], size_t c[], fmi3DependencyKind k[], size_t n)
REFUSE(fmi3GetAdjointDerivative, const fmi3ValueReference a[], size_t i, const fmi3ValueReference b[], size_t j, const fmi3Float64 s[], size_t m, fmi3Float64 v[], size_t n)
REFUSE(fmi3GetOutputDerivatives, const fmi3ValueReference r[], size_t n, const fmi3Int32 o[], fmi3Float64 v[], size_t m)
REFUSE(fmi3ActivateModelPartition, fmi3ValueReference clock, fmi3Float64 time)
REFUSE(fmi3SetTime, fmi3Float64 time)
REFUSE(fmi3SetContinuousStates, const fmi3Float64 v[], size_t n)
REFUSE(fmi3GetContinuousStateDerivatives, fmi3Float64 v[], size_t n)
REFUSE(fmi3GetEventIndicators, fmi3Float64 v[], size_t n)
REFUSE(fmi3GetContinuousStates, fmi3Float64 v[], size_t n)
REFUSE(fmi3GetNominalsOfContinuousStates, fmi3Float64 v[], size_t n)
REFUSE(fmi3GetNumberOfEventIndicators, size_t *n)
REFUSE(fmi3GetNumberOfContinuousStates, size_t *n)
REFUSE(fmi3CompletedIntegratorStep, fmi3Boolean set, fmi3Boolean *enter, fmi3Boolean *terminate)
REFUSE_BARE(fmi3EnterConfigurationMode)
REFUSE_BARE(fmi3ExitConfigurationMode)
REFUSE_BARE(fmi3EnterContinuousTimeMode)

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String path, fmi3Boolean visible, fmi3Boolean loggingOn,
                                          fmi3InstanceEnvironment environment, fmi3LogMessageCallback logMessage)
{
    if (logMessage)
        logMessage(environment, fmi3Error, "logStatusError", "this FMU has no model exchange; use co-simulation");
    return NULL;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String path, fmi3Boolean visible, fmi3Boolean loggingOn,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback logMessage,
                                               fmi3ClockUpdateCallback clockUpdate, fmi3LockPreemptionCallback lock,
                                               fmi3UnlockPreemptionCallback unlock)
{
    if (logMessage)
        logMessage(environment, fmi3Error, "logStatusError", "this FMU has no scheduled execution; use co-simulation");
    return NULL;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

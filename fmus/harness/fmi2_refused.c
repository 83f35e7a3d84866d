/* The functions of FMI 2.0 for what these FMUs do not have: other types, model exchange, derivatives of
 * outputs, asynchronous steps.  Each is exported, as the standard asks, and says so.
 */

static fmi2Status refuse2(Instance *in, const char *function)
{
    return in ? (fmi2Status)report(in, STATUS_ERROR, "%s is not supported: this FMU has Real and String variables and co-simulation only", function)
              : fmi2Error;
}

#define REFUSE(name, ...)                                                                                              \
    fmi2Status name(fmi2Component c, __VA_ARGS__)                                                                      \
    {                                                                                                                  \
        return refuse2(c, __func__);                                                                                   \
    }
#define REFUSE_BARE(name)                                                                                              \
    fmi2Status name(fmi2Component c)                                                                                   \
    {                                                                                                                  \
        return refuse2(c, __func__);                                                                                   \
    }
#define DISCARD(name, type)                                                                                            \
    fmi2Status name(fmi2Component c, const fmi2StatusKind kind, type *value)                                           \
    {                                                                                                                  \
        return fmi2Discard;                                                                                            \
    }

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

REFUSE(fmi2GetInteger, const fmi2ValueReference vr[], size_t n, fmi2Integer v[])
REFUSE(fmi2GetBoolean, const fmi2ValueReference vr[], size_t n, fmi2Boolean v[])
REFUSE(fmi2SetInteger, const fmi2ValueReference vr[], size_t n, const fmi2Integer v[])
REFUSE(fmi2SetBoolean, const fmi2ValueReference vr[], size_t n, const fmi2Boolean v[])
REFUSE(fmi2GetRealOutputDerivatives, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[], fmi2Real v[])
REFUSE_BARE(fmi2CancelStep)
DISCARD(fmi2GetStatus, fmi2Status)
DISCARD(fmi2GetIntegerStatus, fmi2Integer)
DISCARD(fmi2GetStringStatus, fmi2String)
REFUSE_BARE(fmi2EnterEventMode)
REFUSE_BARE(fmi2EnterContinuousTimeMode)
REFUSE(fmi2NewDiscreteStates, fmi2EventInfo *info)
REFUSE(fmi2CompletedIntegratorStep, fmi2Boolean set, fmi2Boolean *enter, fmi2Boolean *terminate)
REFUSE(fmi2SetTime, fmi2Real time)
REFUSE(fmi2SetContinuousStates, const fmi2Real x[], size_t n)
REFUSE(fmi2GetDerivatives, fmi2Real v[], size_t n)
REFUSE(fmi2GetEventIndicators, fmi2Real v[], size_t n)
REFUSE(fmi2GetContinuousStates, fmi2Real x[], size_t n)
REFUSE(fmi2GetNominalsOfContinuousStates, fmi2Real x[], size_t n)

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

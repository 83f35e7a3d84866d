/* A hand-written FMI 2.0 FMU that keeps what it is given, and whose steps end as the parameter "script" says:
 * 0 normally, 2 ends the simulation at the middle of the step, 3 warns, 4 fails in silence, 5 fails with a formatted
 * word, 6 discards the step, 7 fatally. */
#include <stdlib.h>
#include <string.h>
#include "fmi2Functions.h"

typedef struct {
    double real[10], reached;
    int integer[10];
    char text[64];
    const fmi2CallbackFunctions *functions;
} Thing;

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean logging)
{
    Thing *t = functions->allocateMemory(1, sizeof *t);
    t->functions = functions;
    return t;
}
void fmi2FreeInstance(fmi2Component c) { ((Thing *)c)->functions->freeMemory(c); }
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean a, fmi2Real b, fmi2Real d, fmi2Boolean e, fmi2Real f) { return fmi2OK; }
fmi2Status fmi2EnterInitializationMode(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2Terminate(fmi2Component c) { return fmi2OK; }

#define TYPE(T, field)                                                                                                 \
    fmi2Status fmi2Get##T(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2##T v[])                        \
    {                                                                                                                  \
        for (size_t i = 0; i < n; i++)                                                                                 \
            v[i] = ((Thing *)c)->field[r[i]];                                                                          \
        return fmi2OK;                                                                                                 \
    }                                                                                                                  \
    fmi2Status fmi2Set##T(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2##T v[])                  \
    {                                                                                                                  \
        for (size_t i = 0; i < n; i++)                                                                                 \
            ((Thing *)c)->field[r[i]] = v[i];                                                                          \
        return fmi2OK;                                                                                                 \
    }
TYPE(Real, real)
TYPE(Integer, integer)
TYPE(Boolean, integer)

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String v[])
{
    v[0] = ((Thing *)c)->text;
    return fmi2OK;
}
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2String v[])
{
    strncpy(((Thing *)c)->text, v[0], 63);
    return fmi2OK;
}

static void say(Thing *t, fmi2Status status, const char *format, double value)
{
    t->functions->logger(t->functions->componentEnvironment, "thing", status, "all", format, value);
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real at, fmi2Real h, fmi2Boolean no)
{
    Thing *t = c;
    t->real[2] = t->real[1];
    t->reached = at + h / 2;
    switch (t->integer[7]) {
    case 2: return fmi2Discard;
    case 3: say(t, fmi2Warning, "slow at %.2f s", at); return fmi2Warning;
    case 4: return fmi2Error;
    case 5: say(t, fmi2Error, "the speed %.3f is too much for me", t->real[1]); return fmi2Error;
    case 6: return fmi2Discard;
    case 7: return fmi2Fatal;
    default: return fmi2OK;
    }
}
fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind k, fmi2Boolean *v)
{
    *v = k == fmi2Terminated && ((Thing *)c)->integer[7] == 2;
    return fmi2OK;
}
fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind k, fmi2Real *v)
{
    *v = ((Thing *)c)->reached;
    return fmi2OK;
}

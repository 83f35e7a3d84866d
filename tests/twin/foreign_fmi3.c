/* A hand-written FMI 3.0 FMU that keeps what it is given, and whose steps end as the parameter "script" says:
 * 0 normally, 1 early at the middle, 2 asks to end the simulation, 3 warns, 4 fails in silence, 5 fails with a word,
 * 6 early at once and for ever, 7 fatally. */
#include <stdlib.h>
#include <string.h>
#include "fmi3Functions.h"

typedef struct {
    double speed, speed_out, sized[2];
    float single;
    int8_t i8;
    uint16_t u16;
    int32_t i32, script;
    int64_t i64, gear;
    uint64_t u64;
    bool flags[3];
    char text[64];
    uint8_t blob[64];
    size_t blob_size;
    fmi3LogMessageCallback log;
    void *environment;
} Thing;

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String path, fmi3Boolean visible, fmi3Boolean logging,
                                         fmi3Boolean event, fmi3Boolean early, const fmi3ValueReference r[], size_t n,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update)
{
    Thing *t = calloc(1, sizeof *t);
    t->log = log;
    t->environment = environment;
    if (strcmp(token, "{42}")) {
        log(environment, fmi3Error, "all", "the token is not {42}");
        free(t);
        return NULL;
    }
    return t;
}
void fmi3FreeInstance(fmi3Instance i) { free(i); }
fmi3Status fmi3EnterInitializationMode(fmi3Instance i, fmi3Boolean a, fmi3Float64 b, fmi3Float64 c, fmi3Boolean d, fmi3Float64 e) { return fmi3OK; }
fmi3Status fmi3ExitInitializationMode(fmi3Instance i) { return fmi3OK; }
fmi3Status fmi3Terminate(fmi3Instance i) { return fmi3OK; }

static void *place(Thing *t, fmi3ValueReference r)
{
    switch (r) {
    case 1: return &t->speed;
    case 2: return &t->speed_out;
    case 3: return &t->single;
    case 4: return &t->i8;
    case 5: return &t->u16;
    case 6: return &t->i32;
    case 7: return &t->i64;
    case 8: return &t->u64;
    case 9: return t->flags;
    case 12: return &t->gear;
    case 14: return t->sized;
    default: return &t->script;
    }
}

/* one variable at a time is enough for a test, but for Float64 */
#define TYPE(T)                                                                                                        \
    fmi3Status fmi3Get##T(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3##T v[], size_t m)               \
    {                                                                                                                  \
        memcpy(v, place(i, r[0]), m * sizeof *v);                                                                      \
        return fmi3OK;                                                                                                 \
    }                                                                                                                  \
    fmi3Status fmi3Set##T(fmi3Instance i, const fmi3ValueReference r[], size_t n, const fmi3##T v[], size_t m)         \
    {                                                                                                                  \
        memcpy(place(i, r[0]), v, m * sizeof *v);                                                                      \
        return fmi3OK;                                                                                                 \
    }
TYPE(Float64) TYPE(Float32) TYPE(Int8) TYPE(UInt16) TYPE(Int32) TYPE(Int64) TYPE(UInt64) TYPE(Boolean)

fmi3Status fmi3GetString(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3String v[], size_t m)
{
    v[0] = ((Thing *)i)->text;
    return fmi3OK;
}
fmi3Status fmi3SetString(fmi3Instance i, const fmi3ValueReference r[], size_t n, const fmi3String v[], size_t m)
{
    strncpy(((Thing *)i)->text, v[0], 63);
    return fmi3OK;
}
fmi3Status fmi3GetBinary(fmi3Instance i, const fmi3ValueReference r[], size_t n, size_t s[], fmi3Binary v[], size_t m)
{
    v[0] = ((Thing *)i)->blob;
    s[0] = ((Thing *)i)->blob_size;
    return fmi3OK;
}
fmi3Status fmi3SetBinary(fmi3Instance i, const fmi3ValueReference r[], size_t n, const size_t s[], const fmi3Binary v[], size_t m)
{
    memcpy(((Thing *)i)->blob, v[0], s[0]);
    ((Thing *)i)->blob_size = s[0];
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance i, fmi3Float64 at, fmi3Float64 h, fmi3Boolean no, fmi3Boolean *event, fmi3Boolean *terminate,
                      fmi3Boolean *early, fmi3Float64 *reached)
{
    Thing *t = i;
    *event = *terminate = *early = fmi3False;
    *reached = at + h;
    t->speed_out = t->speed;
    switch (t->script) {
    case 1: *early = h > 1e-3; *reached = *early ? at + h / 2 : at + h; return fmi3OK;
    case 2: *terminate = fmi3True; *reached = at + h / 2; return fmi3OK;
    case 3: t->log(t->environment, fmi3Warning, "all", "this is a warning"); return fmi3Warning;
    case 4: return fmi3Error;
    case 5: t->log(t->environment, fmi3Error, "all", "the speed is too much for me"); return fmi3Error;
    case 7: return fmi3Fatal;
    case 6: *early = fmi3True; *reached = at; return fmi3OK;
    default: return fmi3OK;
    }
}

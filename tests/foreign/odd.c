/* An odd FMU, of FMI 2.0 or 3.0 by FMI_VERSION: x' = u, y = x, until it does at the time "at" what "oddity" says. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <math.h>
#include <unistd.h>
#include <pthread.h>
#include <signal.h>

enum { NONE, FAIL, FATALLY, HANG, CRASH, ABORT, EXIT, DISCARD, END, NOT_A_NUMBER, CHATTY, HANG_AT_THE_END, CRASH_AT_THE_START,
       CRASH_IN_GET, DISCARD_ALL, KEEP_ON_RESET, THREAD_KEY, REFUSE_INPUTS, REFUSE_OUTPUTS, END_NOWHERE, END_BEFORE,
       RETURN_NOWHERE, CREEP, FAIL_TO_SAVE, FAIL_TO_RESTORE, TALK, START_A_TOOL, WRITE_A_LOT, STIFF };

#ifndef ODDITY
#define ODDITY NONE /* what it is if nobody says so */
#endif

typedef struct {
    double x, u, y, at, longest, reached;
    int oddity;
    void *environment;
    void *functions;
} Odd;

#if FMI_VERSION == 2
#include "fmi2Functions.h"
#define F(name) fmi2##name
#define STATUS(name) fmi2##name
typedef fmi2Component Handle;
typedef fmi2Status Status;
static void say(Odd *o, Status status, const char *text)
{
    ((const fmi2CallbackFunctions *)o->functions)->logger(o->environment, "odd", status, "all", "%s", text);
}
#else
#include "fmi3Functions.h"
#define F(name) fmi3##name
#define STATUS(name) fmi3##name
typedef fmi3Instance Handle;
typedef fmi3Status Status;
static void say(Odd *o, Status status, const char *text)
{
    ((fmi3LogMessageCallback)o->functions)(o->environment, status, "all", text);
}
#endif

/* what many a runtime does when it is loaded, and not undo: there are 1024 keys in a process */
static int keyed;
__attribute__((constructor)) static void loaded(void)
{
    pthread_key_t key;
    keyed = pthread_key_create(&key, NULL) == 0;
}

static Odd *created(void *environment, void *functions)
{
    Odd *o = calloc(1, sizeof *o);
    o->environment = environment;
    o->functions = functions;
    o->oddity = ODDITY;
    o->at = 0.5;
    o->longest = 1e9;
    return o;
}

static Status start(Odd *o)
{
    if (o->oddity == CRASH_AT_THE_START)
        abort();
    if (o->oddity == THREAD_KEY && !keyed) {
        say(o, STATUS(Error), "there is no key for the data of this thread");
        return STATUS(Error);
    }
    o->y = o->x;
    return STATUS(OK);
}

static Status reset(Odd *o)
{
    double kept = o->oddity == KEEP_ON_RESET ? o->x : 0;
    void *environment = o->environment, *functions = o->functions;
    memset(o, 0, sizeof *o);
    o->x = kept;
    o->at = 0.5;
    o->longest = 1e9;
    o->environment = environment;
    o->functions = functions;
    return STATUS(OK);
}

static Status finish(Odd *o)
{
    while (o->oddity == HANG_AT_THE_END)
        usleep(1000);
    return STATUS(OK);
}

/* a process of its own, as FMUs that need their tool start one; says its number, and never comes back */
static void start_a_tool(Odd *o)
{
    char text[40];
    int tool = fork();
    if (!tool)
        for (;;) sleep(1);
    snprintf(text, sizeof text, "tool %d", tool);
    say(o, STATUS(Warning), text);
    for (;;) usleep(1000);
}

static void write_a_lot(void)
{
    for (int i = 0; i < 100000; i++)
        fprintf(stderr, "%063d\n", i);
}

static Status step(Odd *o, double t, double h, int *terminate, int *early)
{
    int now = t + h > o->at * (1 + 1e-12);
    o->reached = t;
    if (o->oddity == DISCARD && h > o->longest * (1 + 1e-9)) {
        o->reached = t + o->longest;
        o->x = NAN; /* nothing is left of the state that the step began with */
        say(o, STATUS(Discard), "the step is too long for me");
        return STATUS(Discard);
    }
    if (now)
        switch (o->oddity) {
        case FAIL: say(o, STATUS(Error), "the valve is stuck"); return STATUS(Error);
        case FATALLY: say(o, STATUS(Fatal), "the heap is broken"); return STATUS(Fatal);
        case HANG: for (;;) usleep(1000);
        case CRASH: say(o, STATUS(Warning), "about to write where nothing is"); *(volatile int *)0 = 1; break;
        case ABORT: fputs("odd.c: assertion x > 0 failed\n", stderr); abort();
        case EXIT: exit(3);
        case END: o->reached = o->at; *terminate = 1; return STATUS(OK);
        case END_NOWHERE: o->reached = NAN; *terminate = 1; return STATUS(OK);
        case END_BEFORE: o->reached = t - 0.05; *terminate = 1; return STATUS(OK);
        case RETURN_NOWHERE: o->reached = NAN; *early = 1; return STATUS(OK);
        case CREEP: *early = 1; return STATUS(OK);
        case FAIL_TO_RESTORE: o->reached = t + h / 2; *early = 1; return STATUS(OK);
        case NOT_A_NUMBER: o->x = NAN; break;
        case TALK: for (;;) say(o, STATUS(Warning), "one moment, please");
        case START_A_TOOL: start_a_tool(o); break;
        case WRITE_A_LOT: write_a_lot(); break;
        case DISCARD_ALL: return STATUS(Discard);
        default: break;
        }
    if (o->oddity == CHATTY)
        for (int i = 0; i < 1000; i++)
            say(o, STATUS(Warning), "here I am");
    o->x += h * (o->oddity == STIFF ? 1e80 * (o->u - o->x) : o->u); /* explicit Euler: for h < 2e-80 s */
    o->y = o->x;
    o->reached = t + h;
    return STATUS(OK);
}

/* whether the oddity has begun: from the communication point "at" on, or behind it */
static int begun(const Odd *o, int oddity)
{
    return o->oddity == oddity && o->reached > o->at * (1 - 1e-12);
}

static Status refusal(Odd *o, int oddity)
{
    if (!begun(o, oddity))
        return STATUS(OK);
    if (oddity == REFUSE_INPUTS)
        say(o, STATUS(Error), "the input is out of range");
    return STATUS(Error);
}

static double *place(Odd *o, unsigned reference)
{
    if (reference == 1 && o->oddity == CRASH_IN_GET && o->reached > o->at)
        raise(SIGSEGV);
    switch (reference) {
    case 0: return &o->u;
    case 1: return &o->y;
    case 3: return &o->at;
    default: return &o->longest;
    }
}

#if FMI_VERSION == 2
Handle fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources, const fmi2CallbackFunctions *functions,
                       fmi2Boolean visible, fmi2Boolean logging)
{
    return created(functions->componentEnvironment, (void *)functions);
}
Status fmi2SetupExperiment(Handle c, fmi2Boolean a, fmi2Real b, fmi2Real d, fmi2Boolean e, fmi2Real f) { return fmi2OK; }
Status fmi2EnterInitializationMode(Handle c) { return start(c); }
Status fmi2GetReal(Handle c, const fmi2ValueReference r[], size_t n, fmi2Real v[])
{
    for (size_t i = 0; i < n; i++)
        v[i] = *place(c, r[i]);
    return refusal(c, REFUSE_OUTPUTS);
}
Status fmi2SetReal(Handle c, const fmi2ValueReference r[], size_t n, const fmi2Real v[])
{
    for (size_t i = 0; i < n; i++)
        *place(c, r[i]) = v[i];
    return refusal(c, REFUSE_INPUTS);
}
Status fmi2GetInteger(Handle c, const fmi2ValueReference r[], size_t n, fmi2Integer v[]) { v[0] = ((Odd *)c)->oddity; return fmi2OK; }
Status fmi2SetInteger(Handle c, const fmi2ValueReference r[], size_t n, const fmi2Integer v[]) { ((Odd *)c)->oddity = v[0]; return fmi2OK; }
Status fmi2DoStep(Handle c, fmi2Real t, fmi2Real h, fmi2Boolean no)
{
    int terminate = 0, early = 0;
    Status status = step(c, t, h, &terminate, &early);
    return terminate ? fmi2Discard : status;
}
Status fmi2GetBooleanStatus(Handle c, const fmi2StatusKind k, fmi2Boolean *v) { int o = ((Odd *)c)->oddity; *v = o == END || o == END_NOWHERE || o == END_BEFORE; return fmi2OK; }
Status fmi2GetRealStatus(Handle c, const fmi2StatusKind k, fmi2Real *v) { *v = ((Odd *)c)->reached; return fmi2OK; }
#define STATE fmi2FMUstate
#define GET_STATE fmi2GetFMUstate
#define SET_STATE fmi2SetFMUstate
#define FREE_STATE fmi2FreeFMUstate
#else
Handle fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String path, fmi3Boolean visible, fmi3Boolean logging,
                                   fmi3Boolean event, fmi3Boolean early, const fmi3ValueReference r[], size_t n,
                                   fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update)
{
    return created(environment, (void *)log);
}
Status fmi3EnterInitializationMode(Handle i, fmi3Boolean a, fmi3Float64 b, fmi3Float64 c, fmi3Boolean d, fmi3Float64 e) { return start(i); }
Status fmi3GetFloat64(Handle i, const fmi3ValueReference r[], size_t n, fmi3Float64 v[], size_t m)
{
    for (size_t k = 0; k < n; k++)
        v[k] = *place(i, r[k]);
    return refusal(i, REFUSE_OUTPUTS);
}
Status fmi3SetFloat64(Handle i, const fmi3ValueReference r[], size_t n, const fmi3Float64 v[], size_t m)
{
    for (size_t k = 0; k < n; k++)
        *place(i, r[k]) = v[k];
    return refusal(i, REFUSE_INPUTS);
}
Status fmi3GetInt32(Handle i, const fmi3ValueReference r[], size_t n, fmi3Int32 v[], size_t m) { v[0] = ((Odd *)i)->oddity; return fmi3OK; }
Status fmi3SetInt32(Handle i, const fmi3ValueReference r[], size_t n, const fmi3Int32 v[], size_t m) { ((Odd *)i)->oddity = v[0]; return fmi3OK; }
Status fmi3DoStep(Handle i, fmi3Float64 t, fmi3Float64 h, fmi3Boolean no, fmi3Boolean *event, fmi3Boolean *end, fmi3Boolean *early, fmi3Float64 *last)
{
    int terminate = 0, returned = 0;
    Status status = step(i, t, h, &terminate, &returned);
    *event = false;
    *early = returned;
    *end = terminate;
    *last = ((Odd *)i)->reached;
    return status;
}
#define STATE fmi3FMUState
#define GET_STATE fmi3GetFMUState
#define SET_STATE fmi3SetFMUState
#define FREE_STATE fmi3FreeFMUState
#endif

void F(FreeInstance)(Handle c) { free(c); }
Status F(ExitInitializationMode)(Handle c) { return STATUS(OK); }
Status F(Terminate)(Handle c) { return finish(c); }
Status F(Reset)(Handle c) { return reset(c); }
Status GET_STATE(Handle c, STATE *s)
{
    if (!*s)
        *s = malloc(sizeof(Odd));
    memcpy(*s, c, sizeof(Odd));
    return refusal(c, FAIL_TO_SAVE);
}
Status SET_STATE(Handle c, STATE s)
{
    Status status = refusal(c, FAIL_TO_RESTORE);
    memcpy(c, s, sizeof(Odd));
    return status;
}
Status FREE_STATE(Handle c, STATE *s) { free(*s); *s = NULL; return STATUS(OK); }

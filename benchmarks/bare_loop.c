/* The least that three coupled FMUs cost: load them, wire them in a ring, step them in turn, nothing else.
 * FMI_VERSION is 2 or 3; the ports are the value references given. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <time.h>

#define N 3

typedef struct {
    void *instance;
#if FMI_VERSION == 2
    int (*set)(void *, const uint32_t *, size_t, const double *);
    int (*get)(void *, const uint32_t *, size_t, double *);
    int (*step)(void *, double, double, int);
#else
    int (*set)(void *, const uint32_t *, size_t, const double *, size_t);
    int (*get)(void *, const uint32_t *, size_t, double *, size_t);
    int (*step)(void *, double, double, bool, bool *, bool *, bool *, double *);
#endif
    int (*terminate)(void *);
    void (*free)(void *);
    void *library;
} Part;

#if FMI_VERSION == 2
#define NAME(f) "fmi2" f
#define SET NAME("SetReal")
#define GET NAME("GetReal")
typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*free)(void *);
    void *finished, *environment;
} Callbacks;

static void silent(void *e, const char *i, int s, const char *c, const char *m, ...)
{
    (void)e, (void)i, (void)s, (void)c, (void)m;
}

static const Callbacks callbacks = {silent, calloc, free, NULL, NULL};
#else
#define NAME(f) "fmi3" f
#define SET NAME("SetFloat64")
#define GET NAME("GetFloat64")
#endif

static int load(Part *p, const char *path, const char *token)
{
    void *lib = p->library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!lib)
        return 1;
#if FMI_VERSION == 2
    void *(*instantiate)(const char *, int, const char *, const char *, const Callbacks *, int, int) =
        dlsym(lib, "fmi2Instantiate");
    int (*enter)(void *) = dlsym(lib, "fmi2EnterInitializationMode");
    int (*setup)(void *, int, double, double, int, double) = dlsym(lib, "fmi2SetupExperiment");
    p->instance = instantiate("p", 1, token, "", &callbacks, 0, 0);
    if (!p->instance || setup(p->instance, 0, 0, 0, 0, 0) > 1 || enter(p->instance) > 1)
        return 1;
#else
    void *(*instantiate)(const char *, const char *, const char *, bool, bool, bool, bool, const uint32_t *, size_t, void *,
                         void *, void *) = dlsym(lib, "fmi3InstantiateCoSimulation");
    int (*enter)(void *, bool, double, double, bool, double) = dlsym(lib, "fmi3EnterInitializationMode");
    p->instance = instantiate("p", token, "", false, false, false, false, NULL, 0, NULL, NULL, NULL);
    if (!p->instance || enter(p->instance, false, 0, 0, false, 0) > 1)
        return 1;
#endif
    p->set = dlsym(lib, SET);
    p->get = dlsym(lib, GET);
    p->step = dlsym(lib, NAME("DoStep"));
    p->terminate = dlsym(lib, NAME("Terminate"));
    p->free = dlsym(lib, NAME("FreeInstance"));
    return ((int (*)(void *))dlsym(lib, NAME("ExitInitializationMode")))(p->instance) > 1;
}

static double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Make *steps* of *h* s with *n* FMUs in a ring (one feeds itself nothing); y holds their outputs in the end.
 * Returns the seconds of processor time, or -1 if anything went wrong. */
double bare_loop(int n, const char *const *paths, const char *const *tokens, uint32_t u, uint32_t output, long steps,
                 double h, double *y)
{
    Part part[N];
    double began, taken;
    long k;
    int i, status = 0;
    for (i = 0; i < n; i++) {
        if (load(&part[i], paths[i], tokens[i]))
            return -1;
#if FMI_VERSION == 2
        part[i].get(part[i].instance, &output, 1, &y[i]);
#else
        part[i].get(part[i].instance, &output, 1, &y[i], 1);
#endif
    }
    began = seconds();
    for (k = 0; k < steps && status <= 1; k++) {
        double t = (double)k * h;
#if FMI_VERSION == 2
        for (i = 0; n > 1 && i < n; i++)
            status |= part[i].set(part[i].instance, &u, 1, &y[(i + n - 1) % n]);
        for (i = 0; i < n; i++)
            status |= part[i].step(part[i].instance, t, (double)(k + 1) * h - t, 0);
        for (i = 0; i < n; i++)
            status |= part[i].get(part[i].instance, &output, 1, &y[i]);
#else
        bool event, end, early;
        double last;
        for (i = 0; n > 1 && i < n; i++)
            status |= part[i].set(part[i].instance, &u, 1, &y[(i + n - 1) % n], 1);
        for (i = 0; i < n; i++)
            status |= part[i].step(part[i].instance, t, (double)(k + 1) * h - t, false, &event, &end, &early, &last);
        for (i = 0; i < n; i++)
            status |= part[i].get(part[i].instance, &output, 1, &y[i], 1);
#endif
    }
    taken = seconds() - began;
    for (i = 0; i < n; i++) {
        part[i].terminate(part[i].instance);
        part[i].free(part[i].instance);
        dlclose(part[i].library);
    }
    return status > 1 ? -1 : taken;
}

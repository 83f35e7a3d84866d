/* Mathematical functions for a build that does not link libm, such as FMPy's.
 *
 * With the GNU C library they are a library of their own.  A foreign build description cannot ask for it, and a shared
 * object that leaves them undefined loads only into programs that happen to have them.  So they are fetched when the
 * FMU is loaded; whoever loads an FMU has dlopen.  Elsewhere libm is part of the C library and nothing is done.
 */
#if defined(__GLIBC__) && !defined(LIBM_IS_LINKED)
#include <dlfcn.h>

/* every function that generated code or the harness may call */
#define ONE_ARGUMENT(F)                                                                                                \
    F(sqrt) F(sin) F(cos) F(tan) F(asin) F(acos) F(atan) F(sinh) F(cosh) F(tanh) F(asinh) F(acosh) F(atanh) F(exp)     \
    F(expm1) F(log) F(log1p) F(floor) F(ceil) F(fabs) F(erf)
#define TWO_ARGUMENTS(F) F(pow) F(fmod) F(atan2) F(hypot) F(fmin) F(fmax) F(copysign) F(remainder)

#define DECLARE1(f) static double (*libm_##f)(double);
#define DECLARE2(f) static double (*libm_##f)(double, double);
ONE_ARGUMENT(DECLARE1)
TWO_ARGUMENTS(DECLARE2)

/* POSIX: an object pointer from dlsym may be stored through a pointer to a function pointer */
#define FETCH(f) *(void **)&libm_##f = dlsym(library, #f);

__attribute__((constructor)) static void load_libm(void)
{
    void *library = dlopen("libm.so.6", RTLD_NOW); /* NULL, if it failed, stands for the libraries of the program */
    ONE_ARGUMENT(FETCH)
    TWO_ARGUMENTS(FETCH)
}

#define sqrt libm_sqrt
#define sin libm_sin
#define cos libm_cos
#define tan libm_tan
#define asin libm_asin
#define acos libm_acos
#define atan libm_atan
#define sinh libm_sinh
#define cosh libm_cosh
#define tanh libm_tanh
#define asinh libm_asinh
#define acosh libm_acosh
#define atanh libm_atanh
#define exp libm_exp
#define expm1 libm_expm1
#define log libm_log
#define log1p libm_log1p
#define floor libm_floor
#define ceil libm_ceil
#define fabs libm_fabs
#define erf libm_erf
#define pow libm_pow
#define fmod libm_fmod
#define atan2 libm_atan2
#define hypot libm_hypot
#define fmin libm_fmin
#define fmax libm_fmax
#define copysign libm_copysign
#define remainder libm_remainder
#endif

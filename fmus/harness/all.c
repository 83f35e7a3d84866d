/* The whole FMU as one translation unit: the only file to compile. */

#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("O2,fp-contract=off") /* a foreign build may ask for neither: the same numbers everywhere */
#endif

#include "harness.h"
#include "libm.h"

#include "model.c"

#include "messages.c"
#include "table.c"
#include "evaluate.c"
#include "events.c"
#include "integrate.c"
#include "step.c"
#include "snapshot.c"
#include "instance.c"
#include "directional.c"
#if FMI_VERSION == 2
#include "fmi2.c"
#include "fmi2_refused.c"
#else
#include "fmi3.c"
#include "fmi3_refused.c"
#endif

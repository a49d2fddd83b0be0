/*
 * Sixteen lanes by plain C, as with compilers other than gcc and clang. See test_lanes.c.
 *
 * SPDX-License-Identifier: MIT
 */
#define SC_NO_SIMD
#define SC_NO_VECTORS
#include "simd/quads.h"

#define LANES_TRY lanes_try_plain
#define SC_LANES SC_QUADS

#include "lanes_trial.h"

/*
 * Sixteen lanes by the compiler's vector types, as on machines other than x86-64. See test_lanes.c.
 *
 * SPDX-License-Identifier: MIT
 */
#define SC_NO_SIMD
#include "simd/quads.h"

#define LANES_TRY lanes_try_vectors
#define SC_LANES SC_QUADS

#include "lanes_trial.h"

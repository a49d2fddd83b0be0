/*
 * Sixteen lanes as every machine has them. See test_lanes.c.
 *
 * SPDX-License-Identifier: MIT
 */
#include "simd/quads.h"

#define LANES_TRY lanes_try_base
#define SC_LANES SC_QUADS

#include "lanes_trial.h"

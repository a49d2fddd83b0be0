/*
 * Sixteen lanes by the compiler's vector types, as on machines other than x86-64. See test_lanes.c.
 *
 * SPDX-License-Identifier: MIT
 */
#define SC_NO_SIMD
#include "base/isa.h"

#include "lanes_trial_types.h"

#include <string.h>

#define SC_KERNEL(name) name##_vectors
#define SC_LANES SC_QUADS

#include "base/lanes.h"
#include "base/lanes_double.h"
#include "base/lanes_pick.h"
#include "base/lanes_bytes.h"
#include "base/lanes_cells.h"
#include "base/lanes_rows.h"
#include "lanes_trial.h"

void lanes_try_vectors(const lanes_input *in, lanes_outcome *out)
{
    SC_KERNEL(try_all)(in, out);
}

/*
 * Sixteen lanes by plain C, as with compilers other than gcc and clang. See test_lanes.c.
 *
 * SPDX-License-Identifier: MIT
 */
#define SC_NO_SIMD
#define SC_NO_VECTORS
#include "base/isa.h"

#include "lanes_trial_types.h"

#include <string.h>

#define SC_KERNEL(name) name##_plain
#define SC_LANES SC_QUADS

#include "base/lanes.h"
#include "base/lanes_double.h"
#include "base/lanes_pick.h"
#include "base/lanes_bytes.h"
#include "base/lanes_cells.h"
#include "base/lanes_rows.h"
#include "lanes_trial.h"

void lanes_try_plain(const lanes_input *in, lanes_outcome *out)
{
    SC_KERNEL(try_all)(in, out);
}

/*
 * Sixteen lanes by AVX2. See test_lanes.c.
 *
 * SPDX-License-Identifier: MIT
 */
#include "simd/isa.h"

#define LANES_TRY lanes_try_avx2

#if SC_ISA_X86

#  define SC_LANES 2

#  include "lanes_trial.h"

#else

#  include "lanes_trial_types.h"

void LANES_TRY(const lanes_input *in, lanes_outcome *out)
{
    (void)in;
    (void)out;
}

#endif

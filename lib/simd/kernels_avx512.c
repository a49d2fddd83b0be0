/*
 * All kernels for machines with AVX-512. See simd/kernels.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "simd/isa.h"

#if SC_ISA_X86

#  define SC_KERNELS sc_kernels_avx512
#  define SC_LANES 3

#  include "simd/all_kernels.h"

#else

typedef int sc_kernels_avx512_is_empty; /* C wants a declaration in every file */

#endif

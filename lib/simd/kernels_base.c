/*
 * All kernels for every machine: by SSE2 on x86-64, else as the compiler can. See simd/kernels.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "simd/quads.h"

#define SC_KERNELS sc_kernels_base
#define SC_LANES SC_QUADS

#include "simd/all_kernels.h"

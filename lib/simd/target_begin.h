/*
 * From here to simd/target_end.h, functions are compiled for the instruction set that SC_LANES says
 * (see simd/lanes.h): AVX2, or of AVX-512 its foundation, bytes and words, doublewords and
 * quadwords, and vector lengths. No fused multiplication and addition: it would round differently.
 *
 * SPDX-License-Identifier: MIT
 */
#if SC_LANES > 1
#  include <immintrin.h>
#  if !defined(__clang__)
#    pragma GCC push_options
#  endif
#endif
#if SC_LANES == 2 && defined(__clang__)
#  pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#elif SC_LANES == 2
#  pragma GCC target("avx2")
#elif SC_LANES == 3 && defined(__clang__)
#  pragma clang attribute push(__attribute__((target("avx512f,avx512bw,avx512dq,avx512vl"))),      \
                               apply_to = function)
#elif SC_LANES == 3
#  pragma GCC target("avx512f,avx512bw,avx512dq,avx512vl")
#endif

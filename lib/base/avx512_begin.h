/*
 * From here to base/avx512_end.h, functions are compiled for machines with AVX-512: its foundation,
 * bytes and words, doublewords and quadwords, and vector lengths. No fused multiplication and
 * addition: it would round differently.
 *
 * SPDX-License-Identifier: MIT
 */
#include <immintrin.h>
#if defined(__clang__)
#  pragma clang attribute push(__attribute__((target("avx512f,avx512bw,avx512dq,avx512vl"))),      \
                               apply_to = function)
#else
#  pragma GCC push_options
#  pragma GCC target("avx512f,avx512bw,avx512dq,avx512vl")
#endif

/*
 * From here to base/avx2_end.h, functions are compiled for machines with AVX2. No fused
 * multiplication and addition: it would round differently.
 *
 * SPDX-License-Identifier: MIT
 */
#include <immintrin.h>
#if defined(__clang__)
#  pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#  pragma GCC push_options
#  pragma GCC target("avx2")
#endif

/*
 * Ends what simd/target_begin.h began.
 *
 * SPDX-License-Identifier: MIT
 */
#if SC_LANES > 1 && defined(__clang__)
#  pragma clang attribute pop
#elif SC_LANES > 1
#  pragma GCC pop_options
#endif

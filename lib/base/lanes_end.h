/*
 * Ends what base/lanes.h began: its names, SC_KERNEL and SC_LANES mean nothing from here on.
 *
 * SPDX-License-Identifier: MIT
 */
#undef SC_KERNEL
#undef SC_LANES
#undef SC_LANES_AVX512
#undef SC_LANES_AVX2
#undef SC_LANES_QUADS
#undef SC_LANES_SSE2
#undef lanes
#undef lanes_all
#undef lanes_load
#undef lanes_store
#undef lanes_store_half
#undef lanes_add
#undef lanes_subtract
#undef lanes_multiply
#undef lanes_smaller
#undef lanes_larger
#undef lanes_absolute
#undef lanes_largest_size
#undef lanes_mask
#undef lanes_below
#undef lanes_not_above
#undef lanes_both
#undef lanes_bits
#undef lanes_every
#undef lanes_evens
#undef lanes_odds
#undef lanes_sum
#undef lanes_least
#undef lanes_most
#undef lanes_points
#undef lanes_numbers
#undef lanes_rows
#undef lanes_turned
#undef lanes_four
#undef lanes_each_four
#undef lanes_store_least
#undef lanes_store_most

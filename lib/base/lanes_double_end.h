/*
 * Ends what base/lanes_double.h began.
 *
 * SPDX-License-Identifier: MIT
 */
#undef doubles
#undef doubles_mask
#undef doubles_all
#undef doubles_load
#undef doubles_store
#undef doubles_add
#undef doubles_subtract
#undef doubles_multiply
#undef doubles_smaller
#undef doubles_larger
#undef doubles_absolute
#undef doubles_below
#undef doubles_bits
#undef doubles_choose
#undef doubles_points
#undef doubles_larger_size
#undef doubles_smaller_size
#undef doubles_signs
#undef doubles_differ
#undef doubles_differ3
#undef doubles_equal
#undef doubles_both
#undef doubles_either

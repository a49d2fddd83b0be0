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

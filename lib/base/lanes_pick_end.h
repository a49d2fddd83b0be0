/*
 * Ends what base/lanes_pick.h began.
 *
 * SPDX-License-Identifier: MIT
 */
#undef lanes_index
#undef lanes_from
#undef lanes_pick_both
#undef lanes_corners_two
#undef lanes_index_load
#undef lanes_index_through
#undef lanes_pick
#undef lanes_pick_of
#undef lanes_pick_two
#undef lanes_choose
#undef lanes_same
#undef lanes_differ
#undef lanes_corners
#undef lanes_corners_at
#undef lanes_corners_through
#undef lanes_list
#undef lanes_list_from
#undef lanes_list_pairs
#undef lanes_list_among
#undef lanes_list_bits
#undef lanes_marked
#undef lanes_among

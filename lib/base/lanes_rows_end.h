/*
 * Ends what base/lanes_rows.h began.
 *
 * SPDX-License-Identifier: MIT
 */
#undef lanes_signs
#undef lanes_signs_of
#undef lanes_all_negative
#undef lanes_rows_ends
#undef lanes_signs_kept
#undef lanes_keep_all
#undef lanes_keep
#undef lanes_kept_negative

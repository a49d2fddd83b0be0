/*
 * Ends what base/lanes_cells.h began.
 *
 * SPDX-License-Identifier: MIT
 */
#undef lanes_cells
#undef lanes_cells_of
#undef lanes_cells_load
#undef lanes_cells_all
#undef lanes_cells_store
#undef lanes_cells_joined
#undef lanes_cells_reach
#undef lanes_cells_none
#undef lanes_cells_note
#undef lanes_cells_noted

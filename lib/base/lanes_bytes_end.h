/*
 * Ends what base/lanes_bytes.h began.
 *
 * SPDX-License-Identifier: MIT
 */
#undef lanes_bytes
#undef lanes_bytes_load
#undef lanes_bytes_all
#undef lanes_bytes_quarters
#undef lanes_bytes_store
#undef lanes_bytes_same
#undef lanes_bytes_both
#undef lanes_bytes_either
#undef lanes_bytes_but
#undef lanes_bytes_choose
#undef lanes_bytes_bits
#undef lanes_bytes_through
#undef lanes_triples
#undef lanes_triples_of
#undef lanes_triples_through
#undef lanes_list_rows
#undef lanes_names
#undef lanes_index_of
#undef lanes_edges_of

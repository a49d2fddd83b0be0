/*
 * The caller's array of pairs: filled in any order, sorted at the end.
 *
 * SPDX-License-Identifier: MIT
 *
 * An array that is too short keeps the first pairs of the sorted list: once full, it is a heap with
 * the last pair on top, which a lower one replaces.
 */
#ifndef SC_QUERY_PAIRS_H
#define SC_QUERY_PAIRS_H

#include "query/worker.h"

/* Takes a pair that was not taken before, unless the caller's filter has it left out. */
void sc_pairs_take(sc_worker *w, uint32_t a, uint32_t b);

/* Whether pairs are only counted, all of them. */
static inline int sc_pairs_are_counted(const sc_question *q)
{
    return !q->filter && (q->options.output == SC_OUTPUT_COUNT ||
                          (q->options.output == SC_OUTPUT_PAIRS && !q->capacity));
}

/*
 * Pairs of several questions in one array: in one number of 64 bits the question's prefix, of which
 * the lowest bit is that of turned pairs, then a, then b. So a sorted array has those of one
 * question behind each other, in their order.
 */
enum { SC_PACKED_BITS = 27, SC_PACKED_QUESTIONS = 1 << (63 - 2 * SC_PACKED_BITS) };
#define SC_PACKED_NUMBER ((1u << SC_PACKED_BITS) - 1u)

/* Whether a model's numbers of vertices, triangles and edges have so many bits. */
static inline int sc_pairs_can_be_packed(const sc_model *model)
{
    return model->vertex_count <= SC_PACKED_NUMBER && model->triangle_count <= SC_PACKED_NUMBER / 3;
}

static inline sc_pair sc_pairs_pack(uint32_t prefix, sc_pair pair)
{
    const uint64_t number = (uint64_t)(prefix | pair.a >> 31) << (2 * SC_PACKED_BITS) |
                            (uint64_t)(pair.a & SC_PACKED_NUMBER) << SC_PACKED_BITS | pair.b;
    sc_pair packed;
    packed.a = (uint32_t)(number >> 32);
    packed.b = (uint32_t)number;
    return packed;
}

/* Without the prefix. */
static inline sc_pair sc_pairs_unpack(sc_pair packed)
{
    sc_pair pair;
    pair.a = (packed.a << (32 - SC_PACKED_BITS) | packed.b >> SC_PACKED_BITS) & SC_PACKED_NUMBER;
    pair.b = packed.b & SC_PACKED_NUMBER;
    return pair;
}

/* Gives what a worker has found, SC_FOUND_MAX pairs at most, to the array that several share. */
void sc_pairs_deliver(sc_worker *w);

/* Takes several such. */
void sc_pairs_take_all(sc_worker *w, const sc_pair *pairs, uint32_t count);

/* Sorts the array, at the end of a query that found so many; there is room for some more pairs.
   Tasks, or NULL, share in that if there are very many. */
void sc_pairs_finish(const sc_question *question, uint64_t found, sc_pair *spare, uint64_t room,
                     const sc_tasks *tasks);

#endif

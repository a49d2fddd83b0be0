/*
 * Sorting without allocation. In place: by digits while there are many, then quicksort with a
 * heapsort behind it, O(n log n) always.
 *
 * SPDX-License-Identifier: MIT
 *
 * A pair is ordered by a, then b.
 */
#ifndef SC_BASE_SORT_H
#define SC_BASE_SORT_H

#include <string.h>

#include "starcontour.h"

static inline uint64_t sc_sort_number(sc_pair x)
{
    return (uint64_t)x.a << 32 | x.b;
}

static inline int sc_sort_less(sc_pair x, sc_pair y)
{
    return sc_sort_number(x) < sc_sort_number(y);
}

/* Unsigned integers in the order of floats, NaN aside. */
static inline uint32_t sc_sort_key(float f)
{
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

void sc_sort_pairs(sc_pair *pairs, uint64_t count);

/* Moves pairs so that none of the first i is greater than one of the rest, and returns i, about
   half their count if there are 9 or more. */
uint64_t sc_sort_split(sc_pair *pairs, uint64_t count);

/* The same by the lowest `bits` bits of a; pairs with equal a stay in order. Linear: a pass for
   every ten bits, by the host's tasks if there are any. There are 1 to 2^32 - 1 pairs, and spare
   has room for as many. With tasks, room is for so many numbers as sc_sort_digits_room says.
   Returns where the sorted pairs are: in spare after an odd number of passes. */
sc_pair *sc_sort_by_digits(sc_pair *pairs, sc_pair *spare, uint32_t count, unsigned bits,
                           const sc_tasks *tasks, uint32_t *room);
uint32_t sc_sort_digits_room(uint32_t count);

/* As sc_sort_pairs, in a third to a sixth of the time where there are thousands, unless many have
   the same a. spare has room for as many. */
void sc_sort_with_room(sc_pair *pairs, sc_pair *spare, uint64_t count);

/* As sc_sort_pairs, with room for so many pairs, however many are sorted: these are split in place
   into parts that have room, and are in the cache. */
void sc_sort_in_room(sc_pair *pairs, sc_pair *spare, uint64_t room, uint64_t count);

/* Splits pairs in place by the highest bits in which they differ into SC_SORT_PARTS parts, of which
   none has a pair that is greater than one of the next. end: where each ends. */
enum { SC_SORT_PARTS = 256 };
void sc_sort_in_parts(sc_pair *pairs, uint64_t count, uint64_t end[SC_SORT_PARTS]);

/* Restores the heap (greatest pair first) below position at, where alone it may be broken. */
void sc_sort_sift(sc_pair *heap, uint64_t count, uint64_t at);

/* Makes a heap, greatest pair first. */
void sc_sort_heapify(sc_pair *pairs, uint64_t count);

#endif

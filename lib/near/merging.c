/*
 * Merging of stencils, in place. See merging.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * The array of multiplicities first holds the numbers of all stencils that may be merged, sorted by
 * what they are of, then by number. A heap does that, in O(n log n) whatever the input. Then all of
 * a group but its first are marked as gone; as they are not needed any more, the second keeps the
 * number of the first and the size of the group. So the array is free for the multiplicities.
 */
#include "near/merging.h"

enum { GONE = 0 }; /* as a feature */

/* What a stencil is of: two vertices in order; or a vertex, and the ends of an edge in order. */
typedef struct subject {
    uint32_t feature, vertex[3];
} subject;

static void put_in_order_of_number(uint32_t *u, uint32_t *v)
{
    uint32_t larger = *u > *v ? *u : *v;
    *u = *u > *v ? *v : *u;
    *v = larger;
}

/* The vertices of the feature are those that have a weight; those of one side are negative. */
static subject subject_of(const sc_near_stencil *stencil)
{
    uint32_t of[2][4] = {{0, 0, 0, 0}, {0, 0, 0, 0}};
    int i, count[2] = {0, 0}, alone;
    subject s;
    for (i = 0; i < 4; i++) {
        int side = stencil->weights[i] > 0;
        if (side || stencil->weights[i] < 0) of[side][count[side]++] = stencil->vertices[i];
    }
    s.feature = stencil->feature;
    alone = count[0] != 1;
    s.vertex[0] = of[alone][0];
    s.vertex[1] = of[1 - alone][0];
    s.vertex[2] = of[1 - alone][1];
    if (s.feature == SC_FEATURE_VERTEX_VERTEX)
        put_in_order_of_number(&s.vertex[0], &s.vertex[1]);
    else
        put_in_order_of_number(&s.vertex[1], &s.vertex[2]);
    return s;
}

/* -1, 0 or 1. */
static int compare_subjects(const subject *s, const subject *t)
{
    int i;
    if (s->feature != t->feature) return s->feature < t->feature ? -1 : 1;
    for (i = 0; i < 3; i++)
        if (s->vertex[i] != t->vertex[i]) return s->vertex[i] < t->vertex[i] ? -1 : 1;
    return 0;
}

static int comes_before(const sc_near_stencil *stencils, uint32_t i, uint32_t j)
{
    subject s = subject_of(&stencils[i]), t = subject_of(&stencils[j]);
    int order = compare_subjects(&s, &t);
    return order ? order < 0 : i < j;
}

/* Lets a number sink into a heap, the last one on top, from a place that is free. */
static void sink(const sc_near_stencil *stencils, uint32_t *heap, uint64_t count, uint64_t at,
                 uint32_t number)
{
    for (;;) {
        uint64_t child = 2 * at + 1;
        if (child >= count) break;
        if (child + 1 < count && comes_before(stencils, heap[child], heap[child + 1])) child++;
        if (!comes_before(stencils, number, heap[child])) break;
        heap[at] = heap[child];
        at = child;
    }
    heap[at] = number;
}

static void sort_numbers(const sc_near_stencil *stencils, uint32_t *numbers, uint64_t count)
{
    uint64_t i;
    for (i = count / 2; i-- > 0;) sink(stencils, numbers, count, i, numbers[i]);
    for (i = count; i-- > 1;) {
        uint32_t number = numbers[i];
        numbers[i] = numbers[0];
        sink(stencils, numbers, i, 0, number);
    }
}

uint32_t sc_merging_run(sc_near_stencil *stencils, uint32_t count, uint32_t *multiplicities)
{
    uint32_t i, first, end, some = 0, left = 0;
    for (i = 0; i < count; i++)
        if (stencils[i].feature == SC_FEATURE_VERTEX_VERTEX ||
            stencils[i].feature == SC_FEATURE_VERTEX_EDGE)
            multiplicities[some++] = i;
    sort_numbers(stencils, multiplicities, some);
    for (first = 0; first < some; first = end) {
        subject s = subject_of(&stencils[multiplicities[first]]);
        for (end = first + 1; end < some; end++) {
            subject t = subject_of(&stencils[multiplicities[end]]);
            if (compare_subjects(&s, &t)) break;
            stencils[multiplicities[end]].feature = GONE;
            stencils[multiplicities[end]].vertices[1] = 0;
        }
        if (end == first + 1) continue;
        stencils[multiplicities[first + 1]].vertices[0] = multiplicities[first];
        stencils[multiplicities[first + 1]].vertices[1] = end - first;
    }
    for (i = 0; i < count; i++) multiplicities[i] = 1;
    for (i = 0; i < count; i++)
        if (stencils[i].feature == GONE && stencils[i].vertices[1])
            multiplicities[stencils[i].vertices[0]] = stencils[i].vertices[1];
    for (i = 0; i < count; i++) {
        if (stencils[i].feature == GONE) continue;
        if (left != i) stencils[left] = stencils[i];
        multiplicities[left++] = multiplicities[i];
    }
    return left;
}

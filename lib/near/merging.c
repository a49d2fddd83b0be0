/*
 * Merging of stencils, in place. See merging.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * The array of multiplicities first links all stencils that may be merged to a list, which is
 * sorted by what they are of, merging sorted lists of 1, 2, 4, ... stencils: O(n log n), and those
 * of one subject keep their order. Then all of a group but its first are marked as gone; as they
 * are not needed any more, the second keeps the number of the first and the size of the group. So
 * the array is free for the multiplicities.
 */
#include "near/merging.h"

enum { GONE = 0 /* as a feature */, LISTS = 33 /* of 2^0, 2^1, ... 2^32 */ };

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

/* Merges two sorted lists; of equals those of the first come first. next[i] follows i, SC_NONE ends
   a list. */
static uint32_t merge_lists(const sc_near_stencil *stencils, uint32_t *next, uint32_t one,
                            uint32_t two)
{
    uint32_t first = SC_NONE, last = SC_NONE;
    subject s, t;
    s = subject_of(&stencils[one]);
    t = subject_of(&stencils[two]);
    for (;;) {
        int takes_two = compare_subjects(&t, &s) < 0;
        uint32_t taken = takes_two ? two : one, follows = next[taken];
        if (last == SC_NONE)
            first = taken;
        else
            next[last] = taken;
        last = taken;
        if (follows == SC_NONE) {
            next[last] = takes_two ? one : two;
            return first;
        }
        if (takes_two) {
            two = follows;
            t = subject_of(&stencils[two]);
        } else {
            one = follows;
            s = subject_of(&stencils[one]);
        }
    }
}

/* Links what may be merged to a sorted list; returns its first, or SC_NONE. */
static uint32_t link_sorted(const sc_near_stencil *stencils, uint32_t count, uint32_t *next)
{
    uint32_t list[LISTS], all = SC_NONE, i;
    int k;
    for (k = 0; k < LISTS; k++) list[k] = SC_NONE;
    for (i = 0; i < count; i++) {
        uint32_t carried = i;
        if (stencils[i].feature != SC_FEATURE_VERTEX_VERTEX &&
            stencils[i].feature != SC_FEATURE_VERTEX_EDGE)
            continue;
        next[i] = SC_NONE;
        for (k = 0; list[k] != SC_NONE; k++) {
            carried = merge_lists(stencils, next, list[k], carried);
            list[k] = SC_NONE;
        }
        list[k] = carried;
    }
    for (k = 0; k < LISTS; k++)
        if (list[k] != SC_NONE)
            all = all == SC_NONE ? list[k] : merge_lists(stencils, next, list[k], all);
    return all;
}

uint32_t sc_merging_run(sc_near_stencil *stencils, uint32_t count, uint32_t *multiplicities)
{
    uint32_t i, first, left = 0;
    for (first = link_sorted(stencils, count, multiplicities); first != SC_NONE;) {
        subject s = subject_of(&stencils[first]);
        uint32_t member = multiplicities[first], second = member, size = 1;
        for (; member != SC_NONE; member = multiplicities[member], size++) {
            subject t = subject_of(&stencils[member]);
            if (compare_subjects(&s, &t)) break;
            stencils[member].feature = GONE;
            stencils[member].vertices[1] = 0;
        }
        if (size > 1) {
            stencils[second].vertices[0] = first;
            stencils[second].vertices[1] = size;
        }
        first = member;
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

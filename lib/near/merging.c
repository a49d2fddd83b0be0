/*
 * Merging of stencils, in place. See merging.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * A table finds the first stencil of each subject: for each value of a hash a chain of such
 * stencils, of which the array of multiplicities has the beginnings. There is no other memory, so a
 * chain goes on in the stencil itself. A feature of two or three vertices leaves a weight of 0, and
 * what is written there for a while are bits of a number below any that a weight can be: which
 * stencil is next, or the second of this one's group. That one is not needed any more, and has
 * which is next and the size of the group. So one pass finds the groups, and one more writes down
 * the multiplicities and puts the first of each group behind each other.
 */
#include "near/merging.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "build/model.h"

enum { GONE = 0 /* as a feature */ };

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
        if (fabs(stencil->weights[i]) >= DBL_MIN) of[side][count[side]++] = stencil->vertices[i];
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

static int are_same(const subject *s, const subject *t)
{
    return s->feature == t->feature && s->vertex[0] == t->vertex[0] &&
           s->vertex[1] == t->vertex[1] && s->vertex[2] == t->vertex[2];
}

/* A number below count for each subject, much as if drawn. */
static uint32_t hash_of(const subject *s, uint32_t count)
{
    uint64_t hash = (uint64_t)s->feature << 32;
    int i;
    for (i = 0; i < 3; i++) {
        hash = (hash ^ s->vertex[i]) * UINT64_C(0x9e3779b97f4a7c15);
        hash ^= hash >> 29;
    }
    hash *= UINT64_C(0xbf58476d1ce4e5b9);
    return (uint32_t)((hash >> 32) * count >> 32);
}

/* The first weight of 0, or the last weight if none is 0. */
static double *gap_of(sc_near_stencil *stencil)
{
    int i;
    for (i = 0; i < 3; i++)
        if (fabs(stencil->weights[i]) < DBL_MIN) break;
    return &stencil->weights[i];
}

/* Whether a stencil has a feature that may be merged, and a weight of 0. */
static int may_be_merged(sc_near_stencil *stencil)
{
    return (stencil->feature == SC_FEATURE_VERTEX_VERTEX ||
            stencil->feature == SC_FEATURE_VERTEX_EDGE) &&
           fabs(*gap_of(stencil)) < DBL_MIN;
}

/* What is written there: a number of 32 bits, and whether it is the second of a group. */
static uint32_t read_gap(const double *gap, int *grouped)
{
    uint64_t bits;
    memcpy(&bits, gap, sizeof bits);
    *grouped = (int)(bits >> 32);
    return (uint32_t)bits;
}

static void write_gap(double *gap, uint32_t number, int grouped)
{
    const uint64_t bits = (uint64_t)grouped << 32 | number;
    memcpy(gap, &bits, sizeof bits);
}

/* A stencil that is gone has the size of its group as its second vertex, and as its third which
   stencil follows the first of the group. */
static void add_to_group(sc_near_stencil *stencils, uint32_t first, uint32_t member)
{
    double *gap = gap_of(&stencils[first]);
    int grouped;
    const uint32_t number = read_gap(gap, &grouped);
    stencils[member].feature = GONE;
    if (grouped) {
        stencils[number].vertices[1]++;
        return;
    }
    stencils[member].vertices[1] = 2;
    stencils[member].vertices[2] = number;
    write_gap(gap, member, 1);
}

/* Which stencil of a chain follows. */
static uint32_t next_of(sc_near_stencil *stencils, uint32_t first)
{
    int grouped;
    const uint32_t number = read_gap(gap_of(&stencils[first]), &grouped);
    return grouped ? stencils[number].vertices[2] : number;
}

/* Adds a stencil to the group of its subject, or puts it at the beginning of its chain. */
static void put_in_table(sc_near_stencil *stencils, uint32_t count, uint32_t *table, uint32_t i)
{
    subject s, t;
    uint32_t *chain, other;
    if (!may_be_merged(&stencils[i])) return;
    s = subject_of(&stencils[i]);
    chain = &table[hash_of(&s, count)];
    for (other = *chain; other != SC_NONE; other = next_of(stencils, other)) {
        t = subject_of(&stencils[other]);
        if (are_same(&s, &t)) {
            add_to_group(stencils, other, i);
            return;
        }
    }
    write_gap(gap_of(&stencils[i]), *chain, 0);
    *chain = i;
}

uint32_t sc_merging_run(sc_near_stencil *stencils, uint32_t count, uint32_t *multiplicities)
{
    uint32_t i, left = 0;
    for (i = 0; i < count; i++) multiplicities[i] = SC_NONE;
    for (i = 0; i < count; i++) put_in_table(stencils, count, multiplicities, i);
    for (i = 0; i < count; i++) {
        uint32_t size = 1;
        int grouped;
        if (stencils[i].feature == GONE) continue;
        if (may_be_merged(&stencils[i])) {
            double *gap = gap_of(&stencils[i]);
            const uint32_t number = read_gap(gap, &grouped);
            if (grouped) size = stencils[number].vertices[1];
            *gap = 0;
        }
        if (left != i) stencils[left] = stencils[i];
        multiplicities[left++] = size;
    }
    return left;
}

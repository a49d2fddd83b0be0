/*
 * Lists of the pairs of triangles that share points. See sharing_lists.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/sharing_lists.h"

#include <string.h>

#include "base/bits.h"

uint64_t sc_sharing_lists_count(const sc_sharing *sharing, const sc_xbvh *xbvh)
{
    const uint64_t entries = sharing->first[xbvh->leaf_count];
    uint64_t count = SC_SHARE_ROWS * entries + SC_SHARE_BEHIND, i;
    for (i = 0; i < SC_LEAF_MAX * entries; i++)
        count += sc_bits_count(sharing->rows[i]) + (sharing->rows[i] != 0);
    return count;
}

/* How the corners of two triangles are shared. */
typedef struct shared_corners {
    unsigned of[2]; /* bits */
} shared_corners;

static shared_corners find_shared_corners(const uint32_t *t, const uint32_t *u)
{
    shared_corners r = {{0, 0}};
    unsigned i, k;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) {
            unsigned same = t[i] == u[k];
            r.of[0] |= same << i;
            r.of[1] |= same << k;
        }
    return r;
}

/* 0 if they share just a point, 1 if an edge, else 2. */
static unsigned kind_of(const shared_corners *s)
{
    static const uint8_t count[8] = {0, 1, 1, 2, 1, 2, 2, 3};
    unsigned a = count[s->of[0]], b = count[s->of[1]];
    return a == b && a <= 2 ? a - 1 : 2;
}

/* The corner that is shared and the one before not, if one or two are. */
static unsigned first_corner(unsigned shared)
{
    static const uint8_t first[8] = {0, 0, 1, 0, 2, 2, 1, 0};
    return first[shared];
}

/* Writes the pairs of two clusters, of which there are rows; returns how many words. */
static uint32_t write_run(const uint16_t rows[SC_LEAF_MAX], const uint32_t *t, const uint32_t *u,
                          uint16_t *list)
{
    uint16_t kept[3][SC_LEAF_MAX * SC_LEAF_MAX];
    uint32_t count[3] = {0, 0, 0}, at = SC_SHARE_ROWS, i, k;
    list[SC_SHARE_TRIANGLES] = 0;
    for (i = 0; i < SC_LEAF_MAX; i++) {
        uint32_t row = rows[i];
        if (!row) continue;
        list[SC_SHARE_TRIANGLES] |= (uint16_t)(1u << i);
        list[at++] = (uint16_t)row;
        for (; row; row &= row - 1) {
            uint32_t j = sc_bits_lowest(row);
            shared_corners s = find_shared_corners(t + 3 * (uint64_t)i, u + 3 * (uint64_t)j);
            k = kind_of(&s);
            if (k < 2 && count[k] == SC_SHARE_EDGE - 1) k = 2;
            kept[k][count[k]++] =
                (uint16_t)(i | j << 4 | first_corner(s.of[0]) << 8 | first_corner(s.of[1]) << 12);
        }
    }
    list[SC_SHARE_KINDS] = (uint16_t)(count[0] + SC_SHARE_EDGE * count[1]);
    for (k = 0; k < 3; k++) {
        memcpy(list + at, kept[k], count[k] * sizeof *list);
        at += count[k];
    }
    return at;
}

void sc_sharing_lists_write(const sc_sharing *sharing, const sc_xbvh *xbvh,
                            const uint32_t *triangle, uint32_t *begin, uint16_t *list)
{
    const uint32_t *first = xbvh->leaf_first;
    uint32_t leaf, i, at = 0;
    for (leaf = 0; leaf < xbvh->leaf_count; leaf++)
        for (i = sharing->first[leaf]; i < sharing->first[leaf + 1]; i++) {
            begin[i] = at;
            at += write_run(sharing->rows + SC_LEAF_MAX * (uint64_t)i,
                            triangle + 3 * (uint64_t)first[leaf],
                            triangle + 3 * (uint64_t)first[sharing->leaf[i]], list + at);
        }
    begin[sharing->first[xbvh->leaf_count]] = at;
    memset(list + at, 0, SC_SHARE_BEHIND * sizeof *list);
}

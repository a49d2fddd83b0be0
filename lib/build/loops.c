/*
 * Loops. See loops.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/loops.h"

/* Points that are written at once. */
enum { AT_ONCE = 8 };

/* Of each point of a segment: 16 times the leaf cluster of its half-edge, plus its place there,
   turned; and room for reading as many as are written at once. */
static uint32_t *find_places(const sc_csf *csf, const sc_xbvh *xbvh, const uint32_t *order,
                             const uint8_t *leaf_corner, sc_scratch *scratch)
{
    const uint32_t *first = xbvh->leaf_first;
    uint32_t *place = (uint32_t *)sc_scratch_take_filled(
        scratch, (uint64_t)csf->point_count + AT_ONCE, sizeof *place, 0);
    uint32_t *row = (uint32_t *)sc_scratch_take(scratch, first[xbvh->leaf_count], sizeof *row);
    uint32_t leaf, i;
    if (!place || !row) return NULL;
    for (leaf = 0; leaf < xbvh->leaf_count; leaf++)
        for (i = first[leaf]; i < first[leaf + 1]; i++)
            row[order[i]] = SC_LEAF_MAX * leaf + (i - first[leaf]);
    for (i = 0; i < csf->point_count; i++) {
        uint32_t h = csf->half_edges[i], at = row[h / 3];
        leaf = at / SC_LEAF_MAX;
        place[i] = sc_loops_turn(
            SC_LEAF_POINTS * leaf +
            leaf_corner[SC_LEAF_MAX * (3 * (uint64_t)leaf + h % 3) + at % SC_LEAF_MAX]);
    }
    sc_scratch_give(scratch, row);
    return place;
}

/* The number of pieces and how many edges each has, of closed chains of so many segments; returns
   what follows. A chain goes on where its last segment ended, and ends where no other starts
   (build/chains.h). */
static uint16_t *write_pieces(const sc_csf *csf, const uint32_t *segments, uint32_t count,
                              uint16_t *loop)
{
    uint16_t *edges = loop;
    uint32_t i, end = SC_NONE;
    for (*loop = 0, i = 0; i < count; i++) {
        uint32_t first = csf->point_first[segments[i]], last = csf->point_last[segments[i]];
        if (csf->points[first] != end) {
            ++*loop;
            *++edges = 0;
        }
        *edges = (uint16_t)(*edges + last - first);
        end = csf->points[last];
    }
    return edges + 1;
}

/* One node's; segments are those of its chains. Points are written eight at a time, for segments
   are short: what is written behind the last is written again by the next segment or node. Only
   where the array ends one by one. */
static void write_loop(const sc_csf *csf, const sc_xbvh *xbvh, sc_pair patches,
                       const uint32_t *segments, const uint32_t *place, uint16_t *loop,
                       const uint16_t *end, const uint16_t *array_end)
{
    uint32_t first = SC_LEAF_POINTS * xbvh->leaf[patches.a];
    uint32_t count = SC_LEAF_POINTS * xbvh->leaf[patches.a + 1] - first;
    uint32_t second = SC_LEAF_POINTS * xbvh->leaf[patches.b] - count;
    while (loop < end) {
        uint32_t i = csf->point_first[*segments], last = csf->point_last[*segments], k;
        uint32_t base = place[i] - first < count ? first : second;
        segments++;
        for (; array_end - loop >= AT_ONCE && i < last; i += AT_ONCE) {
            for (k = 0; k < AT_ONCE; k++) loop[k] = (uint16_t)(place[i + k] - base);
            loop += last - i < AT_ONCE ? last - i : AT_ONCE;
        }
        for (; i < last; i++) *loop++ = (uint16_t)(place[i] - base);
    }
}

sc_status sc_loops_write(const sc_csf *csf, const sc_sctt *sctt, const sc_xbvh *xbvh,
                         const uint32_t *order, const uint8_t *leaf_corner, sc_scratch *scratch,
                         uint16_t *loop)
{
    uint32_t n, *place = find_places(csf, xbvh, order, leaf_corner, scratch);
    if (!place) return SC_ERROR_MEMORY;
    for (n = 0; n < sctt->node_count; n++) {
        const uint32_t *segments = csf->contours + csf->contour_first[n];
        uint32_t count = csf->contour_first[n + 1] - csf->contour_first[n];
        uint16_t *points = loop + csf->loop_first[n];
        if (csf->loop_first[n] == csf->loop_first[n + 1]) continue;
        if (csf->in_pieces[n]) points = write_pieces(csf, segments, count, points);
        write_loop(csf, xbvh, sctt->patches[n], segments, place, points,
                   loop + csf->loop_first[n + 1], loop + csf->loop_first[sctt->node_count]);
    }
    sc_scratch_give(scratch, place);
    return SC_OK;
}

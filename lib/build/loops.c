/*
 * Loops. See loops.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/loops.h"

#include "base/jobs.h"

/* Points that are written at once. */
enum { AT_ONCE = 8 };

/* Parts of jobs have so many leaf clusters, points or nodes at least. */
enum { LOOP_LEAVES_MIN = 1000, LOOP_POINTS_MIN = 10000, LOOP_NODES_MIN = 1000 };

/* What the parts of jobs read and write. */
typedef struct loops {
    const sc_csf *csf;
    const sc_sctt *sctt;
    const sc_xbvh *xbvh;
    const uint32_t *order;
    const uint8_t *leaf_corner;
    uint32_t *row;   /* of each triangle: SC_LEAF_MAX times its leaf cluster, and its place there */
    uint32_t *place; /* of each point of a segment: 16 times the leaf cluster of its half-edge, plus
                        its place there, turned; and room for reading AT_ONCE */
    uint16_t *loop;
} loops;

/* The rows of the triangles of some leaf clusters. */
static void find_triangle_rows(void *context, uint32_t part, uint32_t leaf, uint32_t end)
{
    const loops *l = (const loops *)context;
    const uint32_t *first = l->xbvh->leaf_first;
    uint32_t i;
    (void)part;
    for (; leaf < end; leaf++)
        for (i = first[leaf]; i < first[leaf + 1]; i++)
            l->row[l->order[i]] = SC_LEAF_MAX * leaf + (i - first[leaf]);
}

/* The places of some points of segments. */
static void find_places(void *context, uint32_t part, uint32_t i, uint32_t end)
{
    const loops *l = (const loops *)context;
    (void)part;
    for (; i < end; i++) {
        uint32_t h = l->csf->half_edges[i], at = l->row[h / 3], leaf = at / SC_LEAF_MAX;
        l->place[i] = sc_loops_turn(
            SC_LEAF_POINTS * leaf +
            l->leaf_corner[SC_LEAF_MAX * (3 * (uint64_t)leaf + h % 3) + at % SC_LEAF_MAX]);
    }
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
   where those of the job's part end one by one: what follows is another's. */
static void write_loop(const sc_csf *csf, const sc_xbvh *xbvh, sc_pair patches,
                       const uint32_t *segments, const uint32_t *place, uint16_t *loop,
                       const uint16_t *end, const uint16_t *part_end)
{
    uint32_t first = SC_LEAF_POINTS * xbvh->leaf[patches.a];
    uint32_t count = SC_LEAF_POINTS * xbvh->leaf[patches.a + 1] - first;
    uint32_t second = SC_LEAF_POINTS * xbvh->leaf[patches.b] - count;
    while (loop < end) {
        uint32_t i = csf->point_first[*segments], last = csf->point_last[*segments], k;
        uint32_t base = place[i] - first < count ? first : second;
        segments++;
        for (; part_end - loop >= AT_ONCE && i < last; i += AT_ONCE) {
            for (k = 0; k < AT_ONCE; k++) loop[k] = (uint16_t)(place[i + k] - base);
            loop += last - i < AT_ONCE ? last - i : AT_ONCE;
        }
        for (; i < last; i++) *loop++ = (uint16_t)(place[i] - base);
    }
}

/* The loops of some nodes. */
static void write_loops(void *context, uint32_t part, uint32_t n, uint32_t end)
{
    const loops *l = (const loops *)context;
    const sc_csf *csf = l->csf;
    (void)part;
    for (; n < end; n++) {
        const uint32_t *segments = csf->contours + csf->contour_first[n];
        uint32_t count = csf->contour_first[n + 1] - csf->contour_first[n];
        uint16_t *points = l->loop + csf->loop_first[n];
        if (csf->loop_first[n] == csf->loop_first[n + 1]) continue;
        if (csf->in_pieces[n]) points = write_pieces(csf, segments, count, points);
        write_loop(csf, l->xbvh, l->sctt->patches[n], segments, l->place, points,
                   l->loop + csf->loop_first[n + 1], l->loop + csf->loop_first[end]);
    }
}

sc_status sc_loops_write(const sc_csf *csf, const sc_sctt *sctt, const sc_xbvh *xbvh,
                         const uint32_t *order, const uint8_t *leaf_corner, sc_scratch *scratch,
                         uint16_t *loop)
{
    loops l;
    uint32_t k;
    l.csf = csf;
    l.sctt = sctt;
    l.xbvh = xbvh;
    l.order = order;
    l.leaf_corner = leaf_corner;
    l.loop = loop;
    l.place =
        (uint32_t *)sc_scratch_take(scratch, (uint64_t)csf->point_count + AT_ONCE, sizeof *l.place);
    l.row = (uint32_t *)sc_scratch_take(scratch, xbvh->leaf_first[xbvh->leaf_count], sizeof *l.row);
    if (!l.place || !l.row) return SC_ERROR_MEMORY;
    for (k = 0; k < AT_ONCE; k++) l.place[csf->point_count + k] = 0;
    sc_jobs_loop(scratch->tasks, xbvh->leaf_count, LOOP_LEAVES_MIN, find_triangle_rows, &l);
    if (csf->point_count)
        sc_jobs_loop(scratch->tasks, csf->point_count, LOOP_POINTS_MIN, find_places, &l);
    sc_scratch_give(scratch, l.row);
    sc_jobs_loop(scratch->tasks, sctt->node_count, LOOP_NODES_MIN, write_loops, &l);
    sc_scratch_give(scratch, l.place);
    return SC_OK;
}

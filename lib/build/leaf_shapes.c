/*
 * Shapes of leaf clusters. See leaf_shapes.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/leaf_shapes.h"

#include <string.h>

#include "base/bits.h"
#include "base/jobs.h"
#include "build/sharing_lists.h"

/* Parts of jobs have so many leaf clusters at least. */
enum { SHAPES_LEAVES_MIN = 500 };

/* The model, and the array of it that is to be filled. */
typedef struct shapes_job {
    const sc_model *model;
    uint16_t *fan, *touch;
    uint8_t *outline;
} shapes_job;

/* How the triangles of a cluster lie round one of its points: as places in leaf_point, where each
   begins and ends, counter- clockwise. */
typedef struct turns {
    uint32_t begins, ends; /* sets */
    uint32_t count, twice; /* twice: some begin or end at the same place */
    uint8_t end_of[SC_LEAF_POINTS];
} turns;

/* Whether they follow each other, all of them; and whether they close a fan. */
static int are_one_fan(const turns *t, int *closed)
{
    uint32_t heads = t->begins & ~t->ends, start, at, steps = 0;
    *closed = !heads;
    if (!t->count || t->twice || (heads & (heads - 1))) return 0;
    start = at = sc_bits_lowest(heads ? heads : t->begins);
    do {
        at = t->end_of[at];
        steps++;
    } while (at != start && (t->begins >> at & 1u));
    return steps == t->count;
}

/* Those of some leaf clusters. */
static void find_fans(void *context, uint32_t part, uint32_t leaf, uint32_t end_leaf)
{
    const shapes_job *job = (const shapes_job *)context;
    const uint32_t *first = sc_model_leaf_first(job->model);
    const uint8_t *where = sc_model_leaf_corner(job->model) + 3 * SC_LEAF_MAX * (uint64_t)leaf;
    uint16_t *fan = job->fan + 2 * (uint64_t)leaf;
    uint32_t i, k;
    (void)part;
    for (; leaf < end_leaf; leaf++, where += 3 * SC_LEAF_MAX, fan += 2) {
        turns at[SC_LEAF_POINTS];
        memset(at, 0, sizeof at);
        for (i = 0; i < first[leaf + 1] - first[leaf]; i++)
            for (k = 0; k < 3; k++) {
                uint8_t begin = where[SC_LEAF_MAX * ((k + 1) % 3) + i];
                uint8_t end = where[SC_LEAF_MAX * ((k + 2) % 3) + i];
                turns *t = &at[where[SC_LEAF_MAX * k + i]];
                t->twice |= (t->begins >> begin | t->ends >> end) & 1u;
                t->begins |= 1u << begin;
                t->ends |= 1u << end;
                t->end_of[begin] = end;
                t->count++;
            }
        fan[0] = fan[1] = 0;
        for (i = 0; i < SC_LEAF_POINTS; i++) {
            int closed;
            if (are_one_fan(&at[i], &closed)) fan[!closed] |= (uint16_t)(1u << i);
        }
    }
}

void sc_leaf_shapes_fans(const sc_model *m, const sc_tasks *tasks, uint16_t *fan)
{
    shapes_job job;
    memset(&job, 0, sizeof job);
    job.model = m;
    job.fan = fan;
    sc_jobs_loop(tasks, m->leaf_count, SHAPES_LEAVES_MIN, find_fans, &job);
}

/* Follows a chain of edges until it begins again: its points. Returns how many edges it has. */
static uint32_t follow_chain(const uint32_t to[SC_LEAF_POINTS], uint32_t start, uint32_t *points)
{
    uint32_t at = start, count = 0;
    *points = 0;
    do {
        *points |= 1u << at;
        at = sc_bits_lowest(to[at]);
        count++;
    } while (at != start);
    return count;
}

/* Writes an outline of two chains, one of which begins here, if it is such. */
static void write_two_chains(const uint32_t to[SC_LEAF_POINTS], uint32_t edges, uint32_t start,
                             uint8_t outline[SC_LEAF_POINTS])
{
    uint32_t first, second, i;
    const uint32_t count = follow_chain(to, start, &first);
    if (count == edges) return;
    for (i = 0; i < SC_LEAF_POINTS; i++)
        if (to[i] && !(first >> i & 1u)) start = i;
    if (count + follow_chain(to, start, &second) != edges) return;
    for (i = 0; i < SC_LEAF_POINTS; i++)
        outline[i] =
            (uint8_t)(!to[i] ? i | SC_OUTLINE_NOWHERE
                             : sc_bits_lowest(to[i]) | (second >> i & 1u ? SC_OUTLINE_SECOND : 0u));
    outline[SC_LEAF_POINTS - 1] |= SC_OUTLINE_TWO;
}

/* Those of some leaf clusters. */
static void find_outlines(void *context, uint32_t part, uint32_t leaf, uint32_t end_leaf)
{
    const shapes_job *job = (const shapes_job *)context;
    const uint32_t *first = sc_model_leaf_first(job->model);
    const uint8_t *where = sc_model_leaf_corner(job->model) + 3 * SC_LEAF_MAX * (uint64_t)leaf;
    uint8_t *outline = job->outline + SC_LEAF_POINTS * (uint64_t)leaf;
    uint32_t i, k;
    (void)part;
    for (; leaf < end_leaf; leaf++, where += 3 * SC_LEAF_MAX, outline += SC_LEAF_POINTS) {
        uint32_t to[SC_LEAF_POINTS] = {0}, back[SC_LEAF_POINTS] = {0};
        uint32_t edges = 0, start = 0;
        int is_chain = 1;
        for (i = 0; i < first[leaf + 1] - first[leaf]; i++)
            for (k = 0; k < 3; k++) {
                uint32_t end = where[SC_LEAF_MAX * ((k + 1) % 3) + i];
                uint32_t begin = where[SC_LEAF_MAX * k + i];
                is_chain &= !(to[begin] >> end & 1u);
                to[begin] |= 1u << end;
                back[end] |= 1u << begin;
            }
        for (i = 0; i < SC_LEAF_POINTS; i++) {
            to[i] &= ~back[i]; /* an edge and its opposite are none */
            is_chain &= !(to[i] & (to[i] - 1));
            edges += to[i] != 0;
            start = to[i] ? i : start;
        }
        memset(outline, 0, SC_LEAF_POINTS);
        if (is_chain && edges) write_two_chains(to, edges, start, outline);
    }
}

void sc_leaf_shapes_outlines(const sc_model *m, const sc_tasks *tasks, uint8_t *outline)
{
    shapes_job job;
    memset(&job, 0, sizeof job);
    job.model = m;
    job.outline = outline;
    sc_jobs_loop(tasks, m->leaf_count, SHAPES_LEAVES_MIN, find_outlines, &job);
}

/* Whether two leaf clusters whose outlines are two chains each share the points of just one of
   either, which runs in the other direction in the other cluster. */
static int share_chain(const sc_model *m, uint32_t a, uint32_t b)
{
    const uint8_t *row[2];
    const uint32_t *point[2];
    uint32_t shared[2] = {0, 0}, i, k;
    uint8_t other[SC_LEAF_POINTS] = {0};
    int s;
    for (s = 0; s < 2; s++) {
        const uint64_t leaf = s ? b : a;
        row[s] = sc_model_leaf_outline(m) + SC_LEAF_POINTS * leaf;
        point[s] = sc_model_leaf_point(m) + SC_LEAF_POINTS * leaf;
        if (!(row[s][SC_LEAF_POINTS - 1] & SC_OUTLINE_TWO)) return 0;
    }
    for (i = SC_LEAF_POINTS; i-- > 0;)
        for (k = SC_LEAF_POINTS; k-- > 0;)
            if (point[0][i] == point[1][k] && (!i || point[0][i] != point[0][i - 1]) &&
                (!k || point[1][k] != point[1][k - 1])) { /* not what fills a row */
                shared[0] |= 1u << i;
                shared[1] |= 1u << k;
                other[i] = (uint8_t)k;
            }
    for (s = 0; s < 2; s++) {
        uint32_t chain[2] = {0, 0};
        for (i = 0; i < SC_LEAF_POINTS; i++)
            if (!(row[s][i] & SC_OUTLINE_NOWHERE))
                chain[(row[s][i] & SC_OUTLINE_SECOND) != 0] |= 1u << i;
        if (shared[s] != chain[0] && shared[s] != chain[1]) return 0;
    }
    for (i = 0; i < SC_LEAF_POINTS; i++) {
        const uint32_t next = row[0][i] & (SC_LEAF_POINTS - 1u);
        if ((shared[0] >> i & 1u) && (row[1][other[next]] & (SC_LEAF_POINTS - 1u)) != other[i])
            return 0;
    }
    return 1;
}

/* Where two leaf clusters that share points have the one point that they share; 0 if they share
   more. */
static uint16_t find_touch(const uint32_t *points, const uint32_t *other)
{
    uint32_t shared = 0, at = 0, i, k;
    for (i = 0; i < SC_LEAF_POINTS; i++) {
        if (i && points[i] == points[i - 1]) break; /* what fills the row */
        for (k = 0; k < SC_LEAF_POINTS; k++) {
            if (points[i] != other[k]) continue;
            if (++shared > 1) return 0;
            at = i | k << 4 | (uint32_t)(points[i] == points[SC_LEAF_POINTS - 1]) << SC_TOUCH_LAST |
                 (uint32_t)(other[k] == other[SC_LEAF_POINTS - 1]) << SC_TOUCH_LAST_OF_OTHER;
            break;
        }
    }
    return (uint16_t)(SC_TOUCHES | at);
}

/* The touches of some leaf clusters with higher ones. */
static void find_touches(void *context, uint32_t part, uint32_t leaf, uint32_t end)
{
    const shapes_job *job = (const shapes_job *)context;
    const sc_model *m = job->model;
    const uint32_t *first = sc_model_share_first(m), *other = sc_model_share_leaf(m);
    const uint32_t *points = sc_model_leaf_point(m);
    uint32_t i;
    (void)part;
    for (; leaf < end; leaf++)
        for (i = first[leaf]; i < first[leaf + 1]; i++)
            job->touch[i] = share_chain(m, leaf, other[i])
                                ? SC_TOUCH_CHAIN
                                : find_touch(points + SC_LEAF_POINTS * (uint64_t)leaf,
                                             points + SC_LEAF_POINTS * (uint64_t)other[i]);
}

void sc_leaf_shapes_touches(const sc_model *m, const sc_tasks *tasks, uint16_t *touch)
{
    shapes_job job;
    memset(&job, 0, sizeof job);
    job.model = m;
    job.touch = touch;
    sc_jobs_loop(tasks, m->leaf_count, SHAPES_LEAVES_MIN, find_touches, &job);
}

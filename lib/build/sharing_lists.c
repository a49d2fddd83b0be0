/*
 * Lists of the pairs of triangles that share points. See sharing_lists.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/sharing_lists.h"

#include <string.h>

#include "base/bits.h"

/* Parts of jobs have so many leaf clusters at least. */
enum { SHARING_LEAVES_MIN = 500 };

/* What the parts of jobs read and write. */
typedef struct sharing_job {
    const sc_sharing *sharing;
    const sc_xbvh *xbvh;
    const uint32_t *triangle;
    sc_sharing_parts *parts;
    uint32_t *begin;
    uint16_t *list;
} sharing_job;

/* The words of the lists of some leaf clusters. */
static void count_words(void *context, uint32_t part, uint32_t leaf, uint32_t end)
{
    const sharing_job *job = (const sharing_job *)context;
    const sc_sharing *sharing = job->sharing;
    const uint64_t first = sharing->first[leaf], behind = sharing->first[end];
    uint64_t count = SC_SHARE_ROWS * (behind - first), i;
    for (i = SC_LEAF_MAX * first; i < SC_LEAF_MAX * behind; i++)
        count += sc_bits_count(sharing->rows[i]) + (sharing->rows[i] != 0);
    job->parts->begin[part] = count;
}

uint64_t sc_sharing_lists_count(const sc_sharing *sharing, const sc_xbvh *xbvh,
                                const sc_tasks *tasks, sc_sharing_parts *parts)
{
    sharing_job job;
    uint64_t at = 0;
    uint32_t part, count;
    memset(&job, 0, sizeof job);
    job.sharing = sharing;
    job.parts = parts;
    count = sc_jobs_loop(tasks, xbvh->leaf_count, SHARING_LEAVES_MIN, count_words, &job);
    for (part = 0; part < count; part++) {
        const uint64_t words = parts->begin[part];
        parts->begin[part] = at;
        at += words;
    }
    return at + SC_SHARE_BEHIND;
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

/* The lists of some leaf clusters. */
static void write_lists(void *context, uint32_t part, uint32_t leaf, uint32_t end)
{
    const sharing_job *job = (const sharing_job *)context;
    const sc_sharing *sharing = job->sharing;
    const uint32_t *first = job->xbvh->leaf_first, *triangle = job->triangle;
    uint32_t i, at = (uint32_t)job->parts->begin[part];
    for (; leaf < end; leaf++)
        for (i = sharing->first[leaf]; i < sharing->first[leaf + 1]; i++) {
            job->begin[i] = at;
            at += write_run(sharing->rows + SC_LEAF_MAX * (uint64_t)i,
                            triangle + 3 * (uint64_t)first[leaf],
                            triangle + 3 * (uint64_t)first[sharing->leaf[i]], job->list + at);
        }
    if (leaf < job->xbvh->leaf_count) return;
    job->begin[sharing->first[leaf]] = at;
    memset(job->list + at, 0, SC_SHARE_BEHIND * sizeof *job->list);
}

void sc_sharing_lists_write(const sc_sharing *sharing, const sc_xbvh *xbvh,
                            const uint32_t *triangle, const sc_tasks *tasks,
                            sc_sharing_parts *parts, uint32_t *begin, uint16_t *list)
{
    sharing_job job;
    job.sharing = sharing;
    job.xbvh = xbvh;
    job.triangle = triangle;
    job.parts = parts;
    job.begin = begin;
    job.list = list;
    sc_jobs_loop(tasks, xbvh->leaf_count, SHARING_LEAVES_MIN, write_lists, &job);
}

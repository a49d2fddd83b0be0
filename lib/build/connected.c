/*
 * How many patches are connected through edges. See connected.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/connected.h"

#include "base/bits.h"

/* Of pieces that hang together: the first of the piece that i is in. */
static uint32_t find_first(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* Joins the pieces of a and b; returns whether they were two. */
static uint32_t join_pieces(uint32_t *parent, uint32_t a, uint32_t b)
{
    a = find_first(parent, a);
    b = find_first(parent, b);
    parent[a < b ? b : a] = a < b ? a : b;
    return a != b;
}

/* How many of the patches of a level are in one piece. */
static uint32_t count_whole(const sc_xbvh *xbvh, uint32_t level, const uint32_t *pieces)
{
    uint32_t p, count = 0;
    for (p = xbvh->level_first[level]; p + 1 < xbvh->level_first[level + 1]; p++)
        count += pieces[p] == 1;
    return count;
}

/* Numbers the parts of a leaf cluster, of which each triangle is next to some; returns how many. */
static uint32_t number_parts(const uint32_t near[SC_LEAF_MAX], uint32_t leaf, uint32_t first,
                             uint32_t count, sc_connected *c)
{
    uint32_t left = (1u << count) - 1, before = c->count;
    while (left) {
        uint32_t reached = left & (0u - left), next = reached;
        while (next) {
            uint32_t i = sc_bits_lowest(next);
            c->of[first + i] = c->count;
            next = (next & (next - 1)) | (near[i] & ~reached);
            reached |= near[i];
        }
        c->leaf[c->count++] = leaf;
        left &= ~reached;
    }
    return c->count - before;
}

/* Finds the parts of all leaf clusters, and how many each has. */
static void find_parts(const sc_adjacency *adjacency, const uint32_t *order, const sc_xbvh *xbvh,
                       uint32_t *own, sc_connected *c)
{
    uint32_t leaf, i, k;
    for (leaf = 0; leaf < xbvh->leaf_count; leaf++) {
        uint32_t first = xbvh->leaf_first[leaf], count = xbvh->leaf_first[leaf + 1] - first;
        uint32_t near[SC_LEAF_MAX] = {0};
        uint64_t n = c->joint_count;
        for (i = 0; i < count; i++)
            for (k = 0; k < 3; k++) {
                uint32_t h = adjacency->opposite[3 * (uint64_t)order[first + i] + k], at;
                if (h == SC_NONE) continue;
                at = c->place[h / 3];
                if (at - first < count) {
                    near[i] |= 1u << (at - first);
                } else if (at < first) {
                    c->joints[c->joint_count].a = first + i;
                    c->joints[c->joint_count++].b = c->of[at];
                }
            }
        own[leaf] = number_parts(near, leaf, first, count, c);
        for (; n < c->joint_count; n++) c->joints[n].a = c->of[c->joints[n].a];
    }
}

sc_status sc_connected_take(const sc_xbvh *xbvh, sc_scratch *scratch, sc_connected *c)
{
    const uint32_t count = xbvh->leaf_first[xbvh->leaf_count];
    c->place = (uint32_t *)sc_scratch_take(scratch, count, sizeof *c->place);
    c->parent = (uint32_t *)sc_scratch_take(scratch, count, sizeof *c->parent);
    c->patch_at = (uint32_t *)sc_scratch_take(scratch, xbvh->leaf_count, sizeof *c->patch_at);
    c->pieces = (uint32_t *)sc_scratch_take_filled(scratch, xbvh->patch_end, sizeof *c->pieces, 0);
    c->of = (uint32_t *)sc_scratch_take(scratch, count, sizeof *c->of);
    c->leaf = (uint32_t *)sc_scratch_take(scratch, count, sizeof *c->leaf);
    c->joints = (sc_pair *)sc_scratch_take(scratch, 3 * (uint64_t)count / 2 + 1, sizeof(sc_pair));
    c->count = 0;
    c->joint_count = 0;
    if (!c->place || !c->parent || !c->patch_at || !c->pieces || !c->of || !c->leaf || !c->joints)
        return SC_ERROR_MEMORY;
    return SC_OK;
}

void sc_connected_count(const sc_adjacency *adjacency, const uint32_t *order, const sc_xbvh *xbvh,
                        sc_connected *c, uint32_t *connected)
{
    uint32_t count = xbvh->leaf_first[xbvh->leaf_count], level = xbvh->level_count - 1, p, i, leaf;
    uint64_t n, kept;
    for (i = 0; i < count; i++) c->place[order[i]] = i;
    find_parts(adjacency, order, xbvh, c->pieces + xbvh->level_first[level], c);
    for (i = 0; i < c->count; i++) c->parent[i] = i;
    connected[level] = count_whole(xbvh, level, c->pieces);
    for (; level-- > 0; c->joint_count = kept) {
        for (p = xbvh->level_first[level]; p + 1 < xbvh->level_first[level + 1]; p++) {
            for (leaf = xbvh->leaf[p]; leaf < xbvh->leaf[p + 1]; leaf++) c->patch_at[leaf] = p;
            for (i = xbvh->child[p]; i < xbvh->child[p + 1]; i++) c->pieces[p] += c->pieces[i];
        }
        for (n = kept = 0; n < c->joint_count; n++) {
            sc_pair joint = c->joints[n];
            p = c->patch_at[c->leaf[joint.a]];
            if (p == c->patch_at[c->leaf[joint.b]])
                c->pieces[p] -= join_pieces(c->parent, joint.a, joint.b);
            else
                c->joints[kept++] = joint;
        }
        connected[level] = count_whole(xbvh, level, c->pieces);
    }
}

void sc_connected_give(sc_scratch *scratch, sc_connected *c)
{
    sc_scratch_give(scratch, c->joints);
    sc_scratch_give(scratch, c->leaf);
    sc_scratch_give(scratch, c->of);
    sc_scratch_give(scratch, c->pieces);
    sc_scratch_give(scratch, c->patch_at);
    sc_scratch_give(scratch, c->parent);
    sc_scratch_give(scratch, c->place);
}

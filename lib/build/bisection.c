/*
 * Partition by recursive bisection. See bisection.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/bisection.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/assume.h"
#include "base/jobs.h"
#include "base/sort.h"
#include "build/slices.h"
#include "build/small_refinement.h"
#include "build/straight_cut.h"

/* Deeper than this, patches are halved as they stand, which ends within SC_DEPTH_MAX. A cut leaves
   at most 17 / 32 on a side, and components are dealt out between two cuts: some 100,000 triangles
   would have to be joined in the worst way to get here. */
enum { DEPTH_MEASURED = 32 };

/* A cut may be off its target by one triangle in this many. Tuned on the bunny: of the patches of
   level 10, 53 % pass the tests in the rest pose, 49 % with 64; without this limit, leaves are 6 %
   more. */
enum { SLACK = 32 };

/* Ten times the number of triangles that leaf clusters are to have on average. */
enum { LEAF_AIM = 146 };

/* What numbers of leaves are a power of two times, at most: by the built-in cut, and by the
   caller's. Larger ones make fewer leaf clusters. With METIS, 63 instead of 15: 4 % fewer, 2 % less
   memory, queries 1 to 4 % faster (rods 5 to 9); with the built-in cut 1.4 % fewer, and the bunny
   at rest 10 % slower. */
enum { ODD_LEAVES = 15, ODD_LEAVES_OF_CALLER = 63 };

/* Of a small component, in place of its size: it has a side, bit 0; it is beside the largest
   there. */
enum { HELD = 2 };
static const uint32_t DECIDED = 0x80000000u;

/* Arrays are per triangle of the mesh, or per place of the patch at hand: then one after the other
   in the patch's order, whatever else is in that room. */
typedef struct bisection {
    const sc_points *points;
    const sc_adjacency *adjacency;
    sc_bisect cut;
    void *user;
    sc_hierarchy *hierarchy;
    float *centers; /* 3 * triangle_count + 1: sums of corners */
    float *normals; /* 3 * triangle_count + 1: unit normals */
    sc_facets facets;
    float *costs;        /* 3 * triangle_count: of a cut along each side, see bisection.h */
    uint32_t *neighbor;  /* 3 * triangle_count: across each side, triangle_count if there is none */
    uint32_t *label;     /* triangle_count + 1: 2 * number of the patch at hand, + 1 on side 1 */
    uint32_t *component; /* triangle_count + 1 */
    uint32_t *queue;     /* a place */
    sc_pair *keys;       /* a place */
    uint32_t *sizes;     /* a place: of components */
    int32_t *graph; /* 7 * triangle_count + 1, for the caller's cut: offsets, neighbors, weights */
    uint32_t patches;      /* numbers given out */
    const sc_tasks *tasks; /* to share a cut out, or NULL: then one thread makes it */
    sc_refinement refinement;
    sc_slices slices;
} bisection;

/* Whether u is in the patch of t, and if asked on its side. */
static int is_with(const bisection *b, uint32_t t, uint32_t u, int by_side)
{
    return (b->label[u] ^ b->label[t]) <= !by_side;
}

/* Ranges of a patch that are joined by themselves. */
typedef struct range_joins {
    bisection *b;
    const uint32_t *triangles;
    int by_side;
    uint32_t first[SC_JOBS_PARTS];
    uint32_t joins[SC_JOBS_PARTS];  /* that made two components one */
    uint32_t across[SC_JOBS_PARTS]; /* triangles beside one of an earlier range: in b->sizes, from
                                       first on */
} range_joins;

/* Ranges of fewer triangles than this are not worth it. */
enum { JOINED_LEAST = 16384 };

/* Joins a triangle with those beside it from lowest to end - 1; returns how often that made two
   components one. */
static uint32_t join_triangle(const range_joins *j, uint32_t t, uint32_t lowest, uint32_t end)
{
    /* of each triangle: a lower one, or itself */
    uint32_t *parent = j->b->component, root = t, joins = 0, k;
    while (parent[root] != root) root = parent[root];
    for (k = 0; k < 3; k++) {
        uint32_t u = j->b->neighbor[3 * (uint64_t)t + k];
        if (u >= end || u < lowest || !is_with(j->b, t, u, j->by_side)) continue;
        while (parent[u] != u) u = parent[u] = parent[parent[u]];
        if (u == root) continue;
        joins++;
        if (u < root)
            root = parent[root] = u;
        else
            parent[u] = root;
    }
    return joins;
}

static void join_range(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    range_joins *j = (range_joins *)context;
    const uint32_t lowest = j->triangles[first];
    uint32_t joins = 0, across = 0, i, k;
    for (i = first; i < end; i++) {
        uint32_t t = j->triangles[i], is_across = 0;
        j->b->component[t] = t;
        joins += join_triangle(j, t, lowest, t);
        for (k = 0; first > 0 && k < 3; k++)
            is_across |= j->b->neighbor[3 * (uint64_t)t + k] < lowest;
        j->b->sizes[first + across] = t;
        across += is_across;
    }
    j->first[part] = first;
    j->joins[part] = joins;
    j->across[part] = across;
}

/* Numbers the components of a patch in the order of their first triangles, where crossing from side
   0 to side 1 does or does not count as connected, and writes their sizes; returns how many. If
   they are no more than least, there are no numbers. Triangles of a patch are ascending: so a pass
   from first to last joins each with those before it, and needs no search through memory. */
static uint32_t number_components(bisection *b, const uint32_t *triangles, uint32_t count,
                                  int by_side, uint32_t least)
{
    uint32_t *parent = b->component, found = count, parts, part, i;
    range_joins j;
    j.b = b;
    j.triangles = triangles;
    j.by_side = by_side;
    parts = sc_jobs_loop(b->tasks, count, JOINED_LEAST, join_range, &j);
    for (part = 0; part < parts; part++) {
        found -= j.joins[part];
        for (i = 0; i < j.across[part]; i++)
            found -= join_triangle(&j, b->sizes[j.first[part] + i], 0, triangles[j.first[part]]);
    }
    if (found <= least) return found;
    found = 0;
    for (i = 0; i < count; i++) { /* components, written over lower triangles */
        uint32_t t = triangles[i];
        if (parent[t] == t) {
            b->sizes[found] = 0;
            b->component[t] = found++;
        } else { /* of a lower one it is known */
            b->component[t] = b->component[parent[t]];
        }
        b->sizes[b->component[t]]++;
    }
    return found;
}

/* The next half-edge of the border between the two sides of a patch, seen from the side of h, which
   is one: forward round its end, or backward round its start; SC_NONE where the border ends. */
static uint32_t follow_border(const bisection *b, uint32_t h, int forward)
{
    uint32_t label = b->label[h / 3];
    for (;;) {
        uint32_t other;
        h = forward ? sc_adjacency_next(h) : sc_adjacency_previous(h);
        other = b->neighbor[h];
        if (b->label[other] == (label ^ 1)) return h;
        if (b->label[other] != label) return SC_NONE;
        h = b->adjacency->opposite[h];
    }
}

/* How many half-edges a walk along the border meets. */
static uint32_t walk_border(const bisection *b, uint32_t start)
{
    uint32_t met = 1, h;
    for (h = follow_border(b, start, 1); h != start && h != SC_NONE; h = follow_border(b, h, 1))
        met++;
    if (h == start) return met;
    for (h = follow_border(b, start, 0); h != SC_NONE; h = follow_border(b, h, 0)) met++;
    return met;
}

/* Whether on each side one walk along the border meets all of it: then the triangles beside it hang
   together there, and with them all of a side of a connected patch. */
static int are_single_walks(const bisection *b)
{
    const sc_refinement *r = &b->refinement;
    uint32_t length[2] = {0, 0}, start[2] = {SC_NONE, SC_NONE}, i, k;
    for (i = 0; i < r->border_count; i++) {
        uint32_t t = r->border[i], label = b->label[t], last = start[label & 1];
        for (k = 0; k < 3; k++) {
            uint32_t across = b->label[b->neighbor[3 * (uint64_t)t + k]] == (label ^ 1);
            length[label & 1] += across;
            last = across ? 3 * t + k : last;
        }
        start[label & 1] = last;
    }
    return walk_border(b, start[0]) == length[0] && walk_border(b, start[1]) == length[1];
}

/* The caller's cut. */
static sc_status cut_by_caller(bisection *b, const uint32_t *triangles, uint32_t count,
                               uint32_t left_target)
{
    sc_dual_graph graph;
    uint8_t *side = (uint8_t *)b->keys; /* not in use meanwhile */
    int32_t *offsets = b->graph, *neighbors = offsets + count + 1;
    int32_t *weights = neighbors + 3 * (uint64_t)count;
    uint32_t i, k, zeros = 0, low = b->label[triangles[0]];
    int32_t arcs = 0;
    sc_status status;
    for (i = 0; i < count; i++) b->component[triangles[i]] = i; /* local numbers */
    for (i = 0; i < count; i++) {
        offsets[i] = arcs;
        for (k = 0; k < 3; k++) {
            uint32_t t = triangles[i], u = b->neighbor[3 * (uint64_t)t + k];
            float weight = 100 * b->costs[3 * (uint64_t)t + k];
            if (!is_with(b, t, u, 0)) continue;
            neighbors[arcs] = (int32_t)b->component[u];
            weights[arcs++] = weight > 999 ? 1000 : weight >= 1 ? (int32_t)weight : 1;
        }
    }
    offsets[count] = arcs;
    graph.struct_size = (uint32_t)sizeof graph;
    graph.node_count = count;
    graph.offsets = offsets;
    graph.neighbors = neighbors;
    graph.weights = weights;
    memset(side, 2, count);
    status = b->cut(b->user, &graph, left_target, side);
    if (status) return status;
    for (i = 0; i < count; i++) {
        if (side[i] > 1) return SC_ERROR_PARTITION;
        zeros += side[i] == 0;
        b->label[triangles[i]] = low + side[i];
    }
    return zeros == 0 || zeros == count ? SC_ERROR_PARTITION : SC_OK;
}

/* If a side has more than its capacity, triangles next to the other side, then those next to them,
   change over. */
static void even_out(bisection *b, const uint32_t *triangles, uint32_t count, uint32_t size[2],
                     const uint32_t capacity[2])
{
    uint32_t heavy = size[0] > capacity[0] ? 0 : 1, excess, head = 0, tail = 0, i, k;
    if (size[heavy] <= capacity[heavy]) return;
    excess = size[heavy] - capacity[heavy];
    size[heavy] -= excess;
    size[!heavy] += excess;
    for (i = 0; i < count; i++)
        if ((b->label[triangles[i]] & 1) != heavy) b->queue[tail++] = triangles[i];
    while (excess && SC_ALWAYS(head < tail)) { /* the patch is connected, and has both sides */
        uint32_t t = b->queue[head++];
        for (k = 0; k < 3 && excess; k++) {
            uint32_t u = b->neighbor[3 * (uint64_t)t + k];
            if ((b->label[u] ^ b->label[t]) != 1) continue;
            b->label[u] ^= 1;
            b->queue[tail++] = u;
            excess--;
        }
    }
}

/* Whether a triangle of a component is beside another component. */
static int touches_component(const bisection *b, uint32_t t, uint32_t component)
{
    const uint32_t *u = b->neighbor + 3 * (uint64_t)t;
    uint32_t k, found = 0;
    for (k = 0; k < 3; k++) found |= is_with(b, t, u[k], 0) && b->component[u[k]] == component;
    return (int)found;
}

/* Gives the smaller components of each side to the other side. connected: whether each side is
   known to be: so it is if nothing of its own stays apart, and each that changes over to it is
   beside the largest there. */
static void connect(bisection *b, const uint32_t *triangles, uint32_t count, uint32_t size[2],
                    const uint32_t capacity[2], int connected[2])
{
    uint32_t largest[2] = {SC_NONE, SC_NONE}, loose[2] = {0, 0}, i;
    connected[0] = connected[1] = 1;
    if (are_single_walks(b)) return;
    if (number_components(b, triangles, count, 1, 2) == 2) return;
    for (i = 0; i < count; i++) {
        uint32_t c = b->component[triangles[i]], s = b->label[triangles[i]] & 1;
        if (largest[s] == SC_NONE || b->sizes[c] > b->sizes[largest[s]]) largest[s] = c;
    }
    for (i = 0; i < count; i++) {
        uint32_t t = triangles[i], c = b->component[t], s = b->label[t] & 1, *state = &b->sizes[c];
        if (c == largest[s]) continue;
        if (!(*state & DECIDED)) { /* at its first triangle */
            int fits = size[!s] + *state <= capacity[!s];
            if (fits) {
                size[s] -= *state;
                size[!s] += *state;
            }
            *state = DECIDED | (fits ? !s : s);
            loose[*state & 1]++;
        }
        if ((*state & 1) != s && !(*state & HELD) && touches_component(b, t, largest[!s])) {
            *state |= HELD;
            loose[!s]--;
        }
        b->label[t] = (b->label[t] & ~1u) | (*state & 1);
    }
    connected[0] = loose[0] == 0;
    connected[1] = loose[1] == 0;
}

/* Deals the components of a patch out to two sides, none cut: the largest against the rest if it is
   half of all, else by their order along a direction of one triangle of each. connected: whether a
   side has one. */
static void deal_components(bisection *b, const uint32_t *triangles, uint32_t count, uint32_t found,
                            int connected[2])
{
    uint32_t largest = 0, i, taken = 0, n = 0;
    float direction[3];
    for (i = 1; i < found; i++)
        if (b->sizes[i] > b->sizes[largest]) largest = i;
    if (2 * (uint64_t)b->sizes[largest] >= count) {
        for (i = 0; i < count; i++) b->label[triangles[i]] |= b->component[triangles[i]] != largest;
        connected[0] = 1;
        connected[1] = found == 2;
        return;
    }
    for (i = 0; i < found; i++) b->queue[i] = SC_NONE;
    for (i = 0; i < count; i++)
        if (b->queue[b->component[triangles[i]]] == SC_NONE)
            b->queue[b->component[triangles[i]]] = triangles[i];
    sc_direction_find(&b->facets, b->queue, found, 1, direction);
    for (i = 0; i < found; i++) {
        const float *center = b->centers + 3 * (uint64_t)b->queue[i];
        b->keys[i].a = sc_sort_key(sc_direction_along(center, direction));
        b->keys[i].b = i;
    }
    sc_sort_pairs(b->keys, found);
    /* the prefix nearest to half; b->queue[component] becomes its side */
    while (n + 1 < found) {
        uint32_t more = b->sizes[b->keys[n].b];
        if (n > 0 && 2 * (uint64_t)taken + more > count) break;
        taken += more;
        n++;
    }
    connected[0] = n == 1;
    connected[1] = found - n == 1;
    for (i = 0; i < found; i++) b->queue[b->keys[i].b] = i >= n;
    for (i = 0; i < count; i++) b->label[triangles[i]] |= b->queue[b->component[triangles[i]]];
}

/*
 * How many leaves count triangles should get: a small number times a power of two, so that nearly
 * all patches have two halves of one size. LEAF_AIM triangles a leaf leave what connecting and
 * smoothing patches lives on; of the built-in cut that needs more, which is what rounding up to
 * fewer numbers leaves it.
 */
static uint32_t leaves_for(const bisection *b, uint32_t count)
{
    uint32_t least, step = 1, most = b->cut ? ODD_LEAVES_OF_CALLER : ODD_LEAVES;
    if (count <= SC_LEAF_MAX) return 1;
    least = (uint32_t)(((uint64_t)10 * count + LEAF_AIM - 1) / LEAF_AIM);
    while ((least + step - 1) / step > most) step *= 2;
    return (least + step - 1) / step * step;
}

/* How many of a patch's leaves its first half gets: half, as multiples of the largest power of two
   in them. */
static uint32_t left_part(uint32_t leaves)
{
    uint32_t step = leaves & (0u - leaves);
    return step == leaves ? leaves / 2 : (leaves / step + 1) / 2 * step;
}

/* How many triangles a cut may be off its target by. */
static uint32_t slack_of(uint32_t count)
{
    return 1 + count / SLACK;
}

/* How many leaves the two sides of a patch get: as planned, if they fit and are about as large as
   planned, which components are not that were dealt out. */
static void share_leaves(const bisection *b, uint32_t leaves, uint32_t left, uint32_t right,
                         uint32_t *left_leaves, uint32_t *right_leaves)
{
    uint32_t count = left + right, target, slack = slack_of(count);
    *left_leaves = left_part(leaves);
    *right_leaves = leaves - *left_leaves;
    target = (uint32_t)((uint64_t)count * *left_leaves / leaves);
    if (left <= target + slack && target <= left + slack &&
        left <= (uint64_t)*left_leaves * SC_LEAF_MAX &&
        right <= (uint64_t)*right_leaves * SC_LEAF_MAX &&
        /* nine triangles a leaf to begin with: only many cuts in a row that use all slack leave so
           few */
        !SC_HARDLY(left < *left_leaves || right < *right_leaves))
        return;
    *left_leaves = leaves_for(b, left);
    *right_leaves = leaves_for(b, right);
}

/* Labels the sides of a patch that is to become so many leaves, two or more; both sides get some.
   whole: whether the patch is known to be connected; connected: then whether each side is. */
static sc_status divide(bisection *b, const uint32_t *triangles, uint32_t count, uint32_t leaves,
                        int whole, int connected[2])
{
    uint32_t left_leaves = left_part(leaves), found, i, low;
    uint32_t left_target = (uint32_t)((uint64_t)count * left_leaves / leaves);
    uint32_t size[2] = {0, 0}, capacity[2];
    sc_status status;
    for (i = 0; i < 2; i++) { /* slack that is used here is missing further down */
        uint32_t full = (i ? leaves - left_leaves : left_leaves) * SC_LEAF_MAX;
        capacity[i] = (i ? count - left_target : left_target) + slack_of(count);
        if (capacity[i] > full) capacity[i] = full;
    }
    low = 2 * ++b->patches;
    if (!whole || b->cut)
        for (i = 0; i < count; i++) b->label[triangles[i]] = low;
    if (!whole) {
        found = number_components(b, triangles, count, 0, 1);
        if (found > 1) {
            deal_components(b, triangles, count, found, connected);
            return SC_OK;
        }
    }
    if (b->cut) {
        status = cut_by_caller(b, triangles, count, left_target);
        if (status) return status;
        for (i = 0; i < count; i++) size[b->label[triangles[i]] & 1]++;
        even_out(b, triangles, count, size, capacity);
    } else {
        sc_straight_cut_run(&b->facets, triangles, count, left_target,
                            (float *)(void *)b->queue, /* not in use meanwhile */
                            (uint64_t *)(void *)b->keys, b->label, low);
        size[0] = left_target;
        size[1] = count - left_target;
    }
    if (count <= SC_SMALL_REFINEMENT_MAX)
        sc_small_refinement_run(&b->refinement, triangles, count, size, capacity);
    else
        sc_refinement_run(&b->refinement, triangles, count, size, capacity);
    connect(b, triangles, count, size, capacity, connected);
    return SC_OK;
}

/* A range of the hierarchy's order that is to become so many leaves. */
typedef struct patch {
    uint32_t first, count, leaves, depth;
    int whole; /* it is known to be connected */
} patch;

/* Divides a patch of two leaves or more, and puts the triangles of each half together. */
static sc_status cut_patch(bisection *b, const patch *p, patch half[2])
{
    uint32_t *triangles = b->hierarchy->order + p->first, i, left = 0, right = 0;
    int connected[2];
    sc_status status = divide(b, triangles, p->count, p->leaves, p->whole, connected);
    if (status) return status;
    for (i = 0; i < p->count; i++) { /* without a branch, which no processor could foresee */
        uint32_t t = triangles[i], side = b->label[t] & 1;
        b->queue[right] = triangles[left] = t;
        right += side;
        left += !side;
    }
    memcpy(triangles + left, b->queue, right * sizeof *triangles);
    share_leaves(b, p->leaves, left, right, &half[0].leaves, &half[1].leaves);
    half[0].first = p->first;
    half[0].count = left;
    half[1].first = p->first + left;
    half[1].count = right;
    for (i = 0; i < 2; i++) {
        half[i].depth = p->depth + 1;
        half[i].whole = connected[i];
    }
    return SC_OK;
}

static sc_status bisect_patch(bisection *b, const patch *p, uint32_t *node)
{
    sc_hierarchy *hierarchy = b->hierarchy;
    patch half[2];
    uint32_t child;
    sc_status status;
    if (p->leaves == 1 || SC_HARDLY(p->depth > DEPTH_MEASURED)) {
        *node = sc_hierarchy_add_balanced(hierarchy, p->first, p->count, p->depth);
        return SC_OK;
    }
    if ((p->whole || p->depth == 1) &&
        sc_slices_add(&b->slices, hierarchy, p->first, p->count, p->depth, node))
        return SC_OK;
    *node = sc_hierarchy_add(hierarchy, p->first, p->count, p->depth);
    status = cut_patch(b, p, half);
    if (status) return status;
    status = bisect_patch(b, &half[0], &child);
    if (status) return status;
    hierarchy->nodes[*node].left = child;
    status = bisect_patch(b, &half[1], &child);
    hierarchy->nodes[*node].right = child;
    return status;
}

/*
 * With several threads the first cuts are made level by level, the patches of a level at the same
 * time, until there are enough patches for all threads to have some; then each of these becomes a
 * subtree by itself. A patch has room of its own: that of its triangles, and that of its places in
 * the order. It reads nothing of others, since sides towards them count as sides without a
 * neighbor, which is all the same where patches are told apart by their labels. With one thread all
 * is one such patch.
 */

/* Levels of first cuts; patches below so many triangles are not cut then. */
enum { FIRST_LEVELS = 6, FIRST_LEAST = 8192, FIRSTS = 1 << FIRST_LEVELS };

/* Fewer are cut than are made. */
typedef char has_room_for_firsts[(int)FIRSTS <= (int)SC_HIERARCHY_SPARE ? 1 : -1];

/* A patch that the first cuts made: cut itself, or to become a subtree. */
typedef struct top {
    patch p;
    uint32_t child; /* the number of the first of its halves, which follow each other; 0: not cut */
    uint32_t nodes, leaves, depth; /* of its subtree */
    sc_status status;
} top;

typedef struct tops {
    bisection *b;
    uint32_t count, begin; /* begin: the first of the level at hand */
    uint32_t inner;        /* how many are cut */
    const sc_tasks *tasks; /* to share a cut out, or NULL where several are made at the same time */
    top at[2 * FIRSTS];
    patch half[2 * FIRSTS]; /* of those of a level */
} tops;

/* What a patch needs of a bisection, apart from all other patches. */
static bisection own_room(const bisection *b, const patch *p)
{
    bisection own = *b;
    own.queue += p->first;
    own.keys += p->first;
    own.sizes += p->first;
    own.patches += p->first; /* of a patch come fewer than it has triangles */
    own.refinement.moves = own.slices.before = own.queue;
    own.refinement.border = own.sizes;
    own.refinement.heap += 4 * (uint64_t)p->first;
    own.slices.keys = own.keys;
    return own;
}

/* From now on the halves of a patch are beside nothing of each other. */
static void part_range(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    bisection *b = ((const range_joins *)context)->b;
    const uint32_t *triangles = ((const range_joins *)context)->triangles,
                   none = b->points->triangle_count;
    uint32_t i, k;
    (void)part;
    for (i = first; i < end; i++)
        for (k = 0; k < 3; k++) {
            uint32_t *u = &b->neighbor[3 * (uint64_t)triangles[i] + k];
            if (b->label[*u] != b->label[triangles[i]]) *u = none;
        }
}

static void cut_top(void *context, uint32_t part, uint32_t worker)
{
    tops *all = (tops *)context;
    top *at = &all->at[all->begin + part];
    bisection own = own_room(all->b, &at->p);
    range_joins halves;
    (void)worker;
    own.tasks = all->tasks;
    if (at->p.count < FIRST_LEAST) return;
    (void)cut_patch(&own, &at->p, all->half + 2 * part); /* the built-in cut does not fail */
    halves.b = &own;
    halves.triangles = own.hierarchy->order + at->p.first;
    (void)sc_jobs_loop(own.tasks, at->p.count, JOINED_LEAST, part_range, &halves);
    at->child = 1;
}

static void make_firsts(tops *all, const sc_tasks *tasks)
{
    uint32_t level, end, i;
    for (level = 0; tasks && level < FIRST_LEVELS; level++) {
        end = all->count;
        all->tasks = level == 0 ? tasks : NULL;
        if (level == 0)
            cut_top(all, 0, 0);
        else
            sc_jobs_run(tasks, end - all->begin, cut_top, all);
        for (i = all->begin; i < end; i++) {
            const patch *half = all->half + 2 * (i - all->begin);
            if (!all->at[i].child) continue;
            all->at[i].child = all->count;
            all->at[all->count++].p = half[0];
            all->at[all->count++].p = half[1];
            all->inner++;
        }
        if (all->count == end) break;
        all->begin = end;
    }
}

/* The nodes of a subtree, until all of them are moved together: a tree has fewer than twice as many
   as triangles. */
static sc_tree_node *nodes_of(const tops *all, const top *at)
{
    return all->b->hierarchy->nodes + all->inner + 2 * (uint64_t)at->p.first;
}

static void make_subtree(void *context, uint32_t part, uint32_t worker)
{
    tops *all = (tops *)context;
    top *at = &all->at[part];
    sc_hierarchy hierarchy = *all->b->hierarchy;
    bisection own;
    uint32_t root;
    (void)worker;
    if (at->child) return;
    own = own_room(all->b, &at->p);
    own.hierarchy = &hierarchy;
    hierarchy.nodes = nodes_of(all, at);
    hierarchy.starts = (uint32_t *)(void *)own.refinement.heap; /* not in use meanwhile */
    at->status = bisect_patch(&own, &at->p, &root);
    at->nodes = hierarchy.node_count;
    at->leaves = hierarchy.leaf_count;
    at->depth = hierarchy.depth;
}

/* Moves the nodes of a patch behind those that are there, a node before those below it. There is
   room: what was moved before has at most so many nodes as its room had, and inner nodes. */
static uint32_t append_nodes(const tops *all, const top *at)
{
    sc_hierarchy *hierarchy = all->b->hierarchy;
    sc_tree_node *nodes = hierarchy->nodes + hierarchy->node_count;
    uint32_t first = hierarchy->node_count, i, child;
    if (at->child) {
        (void)sc_hierarchy_add(hierarchy, at->p.first, at->p.count, at->p.depth);
        child = append_nodes(all, &all->at[at->child]);
        nodes->left = child;
        child = append_nodes(all, &all->at[at->child + 1]);
        nodes->right = child;
        return first;
    }
    memmove(nodes, nodes_of(all, at), at->nodes * sizeof *nodes);
    for (i = 0; i < at->nodes; i++)
        if (nodes[i].left != SC_NONE) {
            nodes[i].left += first;
            nodes[i].right += first;
        }
    hierarchy->node_count += at->nodes;
    hierarchy->leaf_count += at->leaves;
    if (at->depth > hierarchy->depth) hierarchy->depth = at->depth;
    return first;
}

static sc_status bisect_all(bisection *b, const sc_tasks *tasks)
{
    tops all;
    uint32_t i;
    sc_status status = SC_OK;
    memset(&all, 0, sizeof all);
    all.b = b;
    all.count = 1;
    all.at[0].p.count = b->points->triangle_count;
    all.at[0].p.leaves = leaves_for(b, b->points->triangle_count);
    all.at[0].p.depth = 1;
    if (b->cut) tasks = NULL; /* the caller's function may not be made for several threads */
    make_firsts(&all, tasks);
    sc_jobs_run(tasks, all.count, make_subtree, &all);
    for (i = 0; i < all.count; i++)
        if (all.at[i].status) status = all.at[i].status; /* of the caller's cut, hence of one */
    if (!status) (void)append_nodes(&all, &all.at[0]);
    return status;
}

/* The unit normal of a triangle, by its sides; 0 if it has none, or is 1e-77 of the mesh in
   size. */
static void find_normal(double sides[3][3], float normal[3])
{
    double n[3], square = 0, inverse;
    int k;
    for (k = 0; k < 3; k++) {
        int next = k < 2 ? k + 1 : 0, last = k ? k - 1 : 2;
        n[k] = sides[0][next] * sides[1][last] - sides[0][last] * sides[1][next];
        square += n[k] * n[k];
    }
    inverse = square > DBL_MIN ? 1 / sqrt(square) : 0;
    for (k = 0; k < 3; k++) normal[k] = (float)(n[k] * inverse);
}

/* By what the length of a side between triangles of unit normals a and b is divided: from 1 if they
   lie flat, or nearly so by rounding, to 3 if they are folded onto each other. */
static float divisor_at(const float a[3], const float b[3])
{
    float turn = 1 - (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
    return turn > 1e-6f ? 1 + turn : 1;
}

/* Lengths are added up for so many triangles at a time, and then these sums: in the same order,
   whatever the threads. */
enum { BLOCK = 4096, BLOCKS_LEAST = 4 };

typedef struct measuring {
    bisection *b;
    double scale;  /* of coordinates, so that nothing overflows */
    double *sums;  /* of each block */
    float inverse; /* of the mean length; 0 if that is */
} measuring;

static void measure_block(const measuring *m, uint32_t block)
{
    const bisection *b = m->b;
    const sc_points *points = b->points;
    const uint32_t *corner = points->triangles, count = points->triangle_count;
    uint64_t i = 3 * (uint64_t)BLOCK * block, end = i + 3 * BLOCK;
    double sum = 0;
    uint32_t j, k;
    if (end > 3 * (uint64_t)count) end = 3 * (uint64_t)count;
    for (; i < end; i += 3) {
        double at[3][3], sides[3][3];
        for (j = 0; j < 3; j++)
            for (k = 0; k < 3; k++)
                at[j][k] = points->rest[3 * (uint64_t)corner[i + j] + k] * m->scale;
        for (j = 0; j < 3; j++) {
            uint32_t h = b->adjacency->opposite[i + j];
            double square = 0;
            for (k = 0; k < 3; k++) {
                sides[j][k] = at[j < 2 ? j + 1 : 0][k] - at[j][k];
                square += sides[j][k] * sides[j][k];
            }
            square = sqrt(square);
            b->costs[i + j] = (float)square; /* for now */
            sum += square;
            /* with two corners at one point a triangle may be beside itself: then it has no other
               neighbor */
            b->neighbor[i + j] = h == SC_NONE || h / 3 == i / 3 ? count : h / 3;
        }
        for (k = 0; k < 3; k++) b->centers[i + k] = (float)(at[0][k] + at[1][k] + at[2][k]);
        find_normal(sides, b->normals + i);
    }
    m->sums[block] = sum;
}

static void measure_blocks(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    (void)part;
    for (; first < end; first++) measure_block((const measuring *)context, first);
}

static void find_costs(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const measuring *m = (const measuring *)context;
    const float *normals = m->b->normals;
    uint32_t count = m->b->points->triangle_count, t, j;
    (void)part;
    for (t = first; t < end; t++)
        for (j = 0; j < 3; j++) {
            const uint64_t side = 3 * (uint64_t)t + j;
            uint32_t other = m->b->neighbor[side];
            float cost = m->inverse > 0 ? m->b->costs[side] * m->inverse : 1;
            if (other < count)
                cost /= divisor_at(normals + 3 * (uint64_t)t, normals + 3 * (uint64_t)other);
            m->b->costs[side] = cost;
        }
}

/* Neighbors, centers and costs. */
static void measure(bisection *b, const sc_tasks *tasks)
{
    const sc_points *points = b->points;
    uint32_t blocks = (points->triangle_count - 1) / BLOCK + 1, block;
    double size = 0, sum = 0;
    measuring m;
    uint64_t i;
    int exponent;
    for (i = 0; i < 3 * (uint64_t)points->point_count; i++)
        if (fabs(points->rest[i]) > size) size = fabs(points->rest[i]);
    frexp(size, &exponent);
    m.b = b;
    m.scale = ldexp(1, exponent < -1000 ? 1000 : -exponent);
    m.sums = (double *)(void *)b->keys; /* not in use meanwhile */
    (void)sc_jobs_loop(tasks, blocks, BLOCKS_LEAST, measure_blocks, &m);
    for (block = 0; block < blocks; block++) sum += m.sums[block];
    m.inverse = sum > 0 ? (float)(3 * (double)points->triangle_count / sum) : 0;
    (void)sc_jobs_loop(tasks, points->triangle_count, BLOCKS_LEAST * BLOCK, find_costs, &m);
}

sc_status sc_bisection_build(const sc_points *points, const sc_adjacency *adjacency,
                             sc_bisect bisect, void *user, sc_scratch *scratch,
                             sc_hierarchy *hierarchy)
{
    uint32_t count = points->triangle_count, t;
    bisection b;
    sc_status status;
    memset(&b, 0, sizeof b);
    b.points = points;
    b.adjacency = adjacency;
    b.cut = bisect;
    b.user = user;
    b.hierarchy = hierarchy;
    b.centers = (float *)sc_scratch_take(scratch, 3 * (uint64_t)count + 1, sizeof(float));
    b.normals = (float *)sc_scratch_take(scratch, 3 * (uint64_t)count + 1, sizeof(float));
    b.costs = (float *)sc_scratch_take(scratch, 3 * (uint64_t)count, sizeof(float));
    b.neighbor = (uint32_t *)sc_scratch_take(scratch, 3 * (uint64_t)count, sizeof(uint32_t));
    b.label =
        (uint32_t *)sc_scratch_take_filled(scratch, (uint64_t)count + 1, sizeof(uint32_t), 0xff);
    b.component =
        (uint32_t *)sc_scratch_take_filled(scratch, (uint64_t)count + 1, sizeof(uint32_t), 0xff);
    b.queue = (uint32_t *)sc_scratch_take(scratch, count, sizeof(uint32_t));
    b.keys = (sc_pair *)sc_scratch_take(scratch, count, sizeof(sc_pair));
    b.sizes = (uint32_t *)sc_scratch_take(scratch, count, sizeof(uint32_t));
    b.refinement.neighbor = b.neighbor;
    b.refinement.lengths = b.costs;
    b.refinement.label = b.label;
    b.refinement.gain = (float *)sc_scratch_take(scratch, count, sizeof(float));
    b.refinement.state = (uint8_t *)sc_scratch_take_filled(scratch, (uint64_t)count + 1, 1, 0);
    b.refinement.moves = b.queue; /* these two are not in use meanwhile */
    b.refinement.border = b.sizes;
    b.refinement.heap = (sc_pair *)sc_scratch_take(scratch, 4 * (uint64_t)count, sizeof(sc_pair));
    if (bisect)
        b.graph = (int32_t *)sc_scratch_take(scratch, 7 * (uint64_t)count + 1, sizeof(int32_t));
    if (!b.centers || !b.normals || !b.costs || !b.neighbor || !b.label || !b.component ||
        !b.queue || !b.keys || !b.sizes || !b.refinement.gain || !b.refinement.state ||
        !b.refinement.heap || (bisect && !b.graph))
        return SC_ERROR_MEMORY;
    /* taken last, since it stays: where memory is taken from one end of a range, what is given back
       before it is there for the next steps */
    status = sc_hierarchy_init(hierarchy, points, scratch);
    if (status) return status;
    b.centers[3 * (uint64_t)count] = b.normals[3 * (uint64_t)count] = 0;
    b.facets.centers = b.centers;
    b.facets.normals = b.normals;
    b.slices.facets = b.facets;
    b.slices.neighbor = b.neighbor;
    b.slices.keys = b.keys; /* these three are not in use meanwhile */
    b.slices.before = b.queue;
    b.slices.place = b.component;
    measure(&b, scratch->tasks);
    for (t = 0; t < count; t++) hierarchy->order[t] = t;
    status = bisect_all(&b, scratch->tasks);
    sc_scratch_give(scratch, b.graph);
    sc_scratch_give(scratch, b.refinement.heap);
    sc_scratch_give(scratch, b.refinement.state);
    sc_scratch_give(scratch, b.refinement.gain);
    sc_scratch_give(scratch, b.sizes);
    sc_scratch_give(scratch, b.keys);
    sc_scratch_give(scratch, b.queue);
    sc_scratch_give(scratch, b.component);
    sc_scratch_give(scratch, b.label);
    sc_scratch_give(scratch, b.neighbor);
    sc_scratch_give(scratch, b.costs);
    sc_scratch_give(scratch, b.normals);
    sc_scratch_give(scratch, b.centers);
    return status;
}

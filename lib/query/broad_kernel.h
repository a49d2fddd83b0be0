/*
 * The broad phase: from pairs of patches whose boxes overlap to pairs of leaf clusters. See
 * query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * The same source serves steps, in which boxes move: two are apart if on one axis one is below the
 * other at both ends, see step/step_motion.h.
 *
 * Of pairs of patches whose children are leaf clusters, rows are listed: children of one that
 * overlap the other. When there are many, they are compared with the other's children, and then
 * pairs of leaf clusters are listed. Each is a loop over all rows, so that no branch depends on how
 * many a pair of patches has.
 */

/* Bit k: patch j + k of n is not apart from patch i of m at all times of a step. Behind the last
   patch, lows are infinite and highs are -infinite: those are. */
static inline unsigned stay_near(const sc_motion *m, uint64_t i, const sc_motion *n, uint64_t j)
{
    lanes least = lanes_all(0);
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        float *const *s = m->boxes[0].side, *const *e = m->boxes[m->ends - 1].side;
        float *const *t = n->boxes[0].side, *const *f = n->boxes[n->ends - 1].side;
        const lanes below =
            lanes_larger(lanes_subtract(lanes_all(s[k + 3][i]), lanes_load(t[k] + j)),
                         lanes_subtract(lanes_all(e[k + 3][i]), lanes_load(f[k] + j)));
        const lanes above =
            lanes_larger(lanes_subtract(lanes_load(t[k + 3] + j), lanes_all(s[k][i])),
                         lanes_subtract(lanes_load(f[k + 3] + j), lanes_all(e[k][i])));
        least = lanes_smaller(least, lanes_smaller(below, above));
    }
    return ~lanes_bits(lanes_below(least, lanes_all(0))) & ((1u << SC_LANES_COUNT) - 1u);
}

/* Bit k: patch j + k of one frame may meet patch i of another. */
static inline unsigned near_others(const sc_frame *frame, uint64_t i, const sc_frame *other,
                                   uint64_t j, int moves)
{
    if (moves) return stay_near(&frame->motion, i, &other->motion, j);
    return overlap(&frame->patch_boxes, i, &other->patch_boxes, j);
}

/* Bit k: patch j + k may meet patch i. */
static inline unsigned near_patches(const sc_frame *frame, uint64_t i, uint64_t j, int moves)
{
    return near_others(frame, i, frame, j, moves);
}

/* Box tests of pairs of patches that nodes leave. */
static inline void leave_pairs(sc_worker *w, uint32_t most, int moves)
{
    sc_lists *l = &w->lists;
    uint32_t *left = &l->count[SC_LIST_LEFT], count = *left < most ? *left : most, follow = 0, i;
    const sc_pair *pairs = l->left + (*left -= count);
    sc_pair *to = l->patches + l->count[SC_LIST_PATCHES];
    uint32_t kept = 0;
    for (i = 0; i < count; i++) {
        to[kept] = pairs[i];
        kept += near_patches(w->frame, pairs[i].a & SC_ITEM, pairs[i].b, moves) & 1u;
        follow += sc_item_follows(pairs[i].a);
    }
    l->count[SC_LIST_PATCHES] += kept;
    sc_worker_count_boxes(w, 0, count - follow);
    sc_worker_count_boxes(w, 1, follow);
}

/* Has two patches wait, or one against itself. */
static inline void add_patches(sc_worker *w, uint32_t item, uint32_t b)
{
    sc_pair *to = &w->lists.patches[w->lists.count[SC_LIST_PATCHES]++];
    to->a = item;
    to->b = b;
}

/* Two patches of a level whose boxes overlap: the descendants of one at the next level that is
   visited, sixteen at most, against the other's box, then row by row against the other's; rows of
   leaf clusters wait. */
static inline void open_patches(sc_worker *w, uint32_t item, uint32_t b, int moves)
{
    const sc_model *model = w->model;
    const uint32_t *box_child = sc_model_box_child(model), *share = sc_model_share_first(model);
    const uint32_t leaves = sc_model_first_leaf_patch(model);
    const uint32_t a = item & SC_ITEM, bit = item & SC_AFTER_CONTOUR;
    sc_lists *l = &w->lists;
    uint32_t first_a, first_b;
    unsigned rows, all_b, i;
    if (a >= leaves) {
        sc_worker_add_leaf_pair(w, (a - leaves) | bit, b - leaves);
        return;
    }
    first_a = box_child[a];
    first_b = box_child[b];
    all_b = (1u << (box_child[b + 1] - first_b)) - 1u;
    rows = near_patches(w->frame, b, first_a, moves) & ((1u << (box_child[a + 1] - first_a)) - 1u);
    sc_worker_count_boxes(w, sc_item_follows(item), 1 + sc_bits_count(rows));
    if (first_a >= leaves) {
        const uint32_t at = l->count[SC_LIST_ROWS];
        uint32_t *first = l->row[1] + at, *all = l->row[2] + at;
        sc_fetch(share + (first_a - leaves));
        sc_fetch(share + (box_child[a + 1] - leaves));
        for (i = 0; i < SC_LANES_COUNT; i++) first[i] = first_b - leaves;
        for (i = 0; i < SC_LANES_COUNT; i++) all[i] = all_b;
        l->count[SC_LIST_ROWS] += lanes_list_from(rows, (first_a - leaves) | bit, l->row[0] + at);
        return;
    }
    for (; rows; rows &= rows - 1) {
        const uint32_t c = first_a + sc_bits_lowest(rows);
        unsigned mask = near_patches(w->frame, c, first_b, moves) & all_b;
        for (; mask; mask &= mask - 1) add_patches(w, c | bit, first_b + sc_bits_lowest(mask));
    }
}

/* A patch against itself: its descendants at that level, and each of them with those behind it. The
   list is a stack, so the last come first: then all of one patch is looked at, and its pairs with
   others, before the next, while what it needs is in the cache. */
static inline void open_patch(sc_worker *w, uint32_t item, int moves)
{
    const sc_model *model = w->model;
    const uint32_t *box_child = sc_model_box_child(model);
    const uint32_t leaves = sc_model_first_leaf_patch(model);
    const uint32_t a = item & SC_ITEM, bit = item & SC_AFTER_CONTOUR;
    sc_lists *l = &w->lists;
    uint32_t first, count, i;
    if (a >= leaves || sc_model_is_leaf(model, a)) {
        sc_worker_add_leaf(w, (a >= leaves ? a - leaves : sc_model_leaf(model)[a]) | bit);
        return;
    }
    first = box_child[a];
    count = box_child[a + 1] - first;
    sc_worker_count_boxes(w, sc_item_follows(item), count);
    if (first >= leaves) {
        for (i = 0; i < count; i++) {
            const uint32_t c = first + i - leaves, at = l->count[SC_LIST_ROWS];
            l->row[0][at] = c | bit;
            l->row[1][at] = c + 1;
            l->row[2][at] = ((1u << count) - 1u) >> (i + 1); /* those behind it */
            l->count[SC_LIST_ROWS] += i + 1 < count;
            sc_worker_add_leaf(w, c | bit);
        }
        return;
    }
    for (i = count; i-- > 0;) {
        const uint32_t c = first + i;
        unsigned mask = near_patches(w->frame, c, c + 1, moves) & ((1u << count) - 1u) >> (i + 1);
        for (; mask; mask &= mask - 1) add_patches(w, c | bit, c + 1 + sc_bits_lowest(mask));
        add_patches(w, c | bit, c);
    }
}

/* Pairs of patches, or patches against themselves: their descendants are pairs, too, or leaf
   clusters. The list is a stack. */
static inline void open_pairs(sc_worker *w, uint32_t most, int moves)
{
    sc_lists *l = &w->lists;
    uint32_t *count = &l->count[SC_LIST_PATCHES];
    for (; most && *count && l->count[SC_LIST_ROWS] < SC_ROWS_ENOUGH &&
           l->count[SC_LIST_NEAR] < SC_LEAF_LIST_ENOUGH;
         most--) {
        const sc_pair pair = l->patches[--*count];
        if ((pair.a & SC_ITEM) == pair.b)
            open_patch(w, pair.a, moves);
        else
            open_patches(w, pair.a, pair.b, moves);
    }
}

/* Lists those pairs that share points: of a leaf cluster with those numbered from first on, all
   above it, of which bits of a mask are set. Returns the rest of the mask. */
static inline unsigned list_near_pairs(sc_worker *w, uint32_t item, uint32_t first, unsigned mask)
{
    const uint32_t *share = sc_model_share_first(w->model) + (item & SC_ITEM);
    const uint32_t *leaf = sc_model_share_leaf(w->model);
    sc_lists *l = &w->lists;
    uint32_t *count = &l->count[SC_LIST_NEAR], i;
    int k;
    if (share[1] - share[0] < 2) { /* one, as in rods, or none */
        const uint32_t at = share[0] < share[1] ? leaf[share[0]] - first : SC_LEAF_MAX;
        const unsigned bit = at < SC_LEAF_MAX ? mask & 1u << at % SC_LEAF_MAX : 0u;
        l->near[0][*count] = item;
        l->near[1][*count] = share[0];
        *count += bit != 0;
        return mask & ~bit;
    }
    sc_fetch(sc_model_share_touch(w->model) + share[0]);
    for (i = share[0]; i < share[1]; i += SC_LANES_COUNT) {
        const unsigned some = share[1] - i < SC_LANES_COUNT ? share[1] - i : SC_LANES_COUNT;
        uint32_t *lower = l->near[0] + *count;
        unsigned found;
        for (k = 0; k < SC_LANES_COUNT; k++) lower[k] = item;
        *count += lanes_list_among(leaf + i, some, first, mask, i, l->near[1] + *count, &found);
        mask &= ~found;
    }
    return mask;
}

/* Lists pairs of a leaf cluster with those numbered from first on, of which bits of a mask are set.
   They are all above it; or all below it, of pairs that the test tree leaves to boxes: then they
   share no points with it, unless both are crowded (build/neighbors.h). In which order two that
   share no points are listed makes no difference. */
static inline void list_leaf_pairs(sc_worker *w, uint32_t item, uint32_t first, unsigned mask)
{
    const uint32_t leaf = item & SC_ITEM;
    const unsigned pairs = sc_bits_count(mask);
    sc_lists *l = &w->lists;
    uint32_t *count = &l->count[SC_LIST_FAR], *same = l->far[0] + *count;
    int i;
    w->stats.leaf_pairs += pairs;
    sc_worker_count_boxes(w, sc_item_follows(item), pairs);
    if (leaf < first) mask = list_near_pairs(w, item, first, mask);
    for (i = 0; i < SC_LANES_COUNT; i++) same[i] = item;
    *count += lanes_list_from(mask, first, l->far[1] + *count);
}

/* The same in a step, where pairs that share points are listed with the others. */
static inline void list_moving_pairs(sc_worker *w, uint32_t item, uint32_t first, unsigned mask)
{
    const unsigned pairs = sc_bits_count(mask);
    sc_cluster_pair *to = w->lists.clusters + w->lists.count[SC_LIST_CLUSTERS];
    w->stats.leaf_pairs += pairs;
    w->lists.count[SC_LIST_CLUSTERS] += pairs;
    sc_worker_count_boxes(w, sc_item_follows(item), pairs);
    for (; mask; mask &= mask - 1, to++) {
        to->a = item & SC_ITEM;
        to->b = first + sc_bits_lowest(mask);
        to->shared = SC_NONE;
        to->known = item & SC_AFTER_CONTOUR;
    }
}

/* Drops those of some rows, the last ones, that overlap nothing; returns how many rows are left. */
static inline uint32_t compare_rows(sc_worker *w, uint32_t begin, int moves)
{
    const uint32_t leaves = sc_model_first_leaf_patch(w->model);
    sc_lists *l = &w->lists;
    uint32_t *row = l->row[0], *first = l->row[1], *all = l->row[2], end = begin, i;
    for (i = begin; i < l->count[SC_LIST_ROWS]; i++) {
        const uint32_t item = row[i], from = first[i];
        const unsigned mask =
            near_patches(w->frame, leaves + (item & SC_ITEM), leaves + from, moves) & all[i];
        row[end] = item;
        first[end] = from;
        all[end] = mask;
        end += mask != 0;
    }
    return end;
}

/* Pairs of leaf clusters that overlap in rows. */
static void list_rows(sc_worker *w, uint32_t most)
{
    enum { AHEAD = 8 };
    const uint32_t *share = sc_model_share_first(w->model);
    const uint32_t *shared = sc_model_share_leaf(w->model);
    sc_lists *l = &w->lists;
    const uint32_t have = l->count[SC_LIST_ROWS], begin = have < most ? 0 : have - most;
    const uint32_t *row = l->row[0], *first = l->row[1], *all = l->row[2];
    uint32_t end = compare_rows(w, begin, 0), i;
    for (i = end; i > begin && end - i < AHEAD; i--) sc_fetch(shared + share[row[i - 1] & SC_ITEM]);
    for (i = end; i > begin; i--) {
        if (i - begin > AHEAD) sc_fetch(shared + share[row[i - 1 - AHEAD] & SC_ITEM]);
        if (l->count[SC_LIST_FAR] > SC_LEAF_LIST_MAX - SC_LEAF_MAX ||
            l->count[SC_LIST_NEAR] > SC_LEAF_LIST_MAX - SC_LEAF_MAX)
            break;
        list_leaf_pairs(w, row[i - 1], first[i - 1], all[i - 1]);
    }
    l->count[SC_LIST_ROWS] = i;
}

/* The same in a step. */
static void list_moving_rows(sc_worker *w, uint32_t most)
{
    sc_lists *l = &w->lists;
    const uint32_t have = l->count[SC_LIST_ROWS], begin = have < most ? 0 : have - most;
    uint32_t i = compare_rows(w, begin, 1);
    for (; i > begin && l->count[SC_LIST_CLUSTERS] <= SC_CLUSTERS_MAX - SC_LEAF_MAX; i--)
        list_moving_pairs(w, l->row[0][i - 1], l->row[1][i - 1], l->row[2][i - 1]);
    l->count[SC_LIST_ROWS] = i;
}

/* ---- two objects ---- */

/* Lists leaf cluster a of the first object with some of the second's, numbered from first on; or,
   where it is the other way round, leaf cluster b of the second with some of the first's. */
static inline void list_between(sc_worker *w, uint32_t bit, uint32_t leaf, uint32_t first,
                                unsigned mask, int turned, int moves)
{
    sc_lists *l = &w->lists;
    uint32_t *far[2];
    int i;
    w->stats.leaf_pairs += sc_bits_count(mask);
    if (moves) {
        for (; mask; mask &= mask - 1) {
            sc_cluster_pair *to = &l->clusters[l->count[SC_LIST_CLUSTERS]++];
            const uint32_t other = first + sc_bits_lowest(mask);
            to->a = turned ? other : leaf;
            to->b = turned ? leaf : other;
            to->shared = SC_NONE;
            to->known = bit;
        }
        return;
    }
    for (i = 0; i < 2; i++) far[i] = l->far[i] + l->count[SC_LIST_FAR];
    for (i = 0; i < SC_LANES_COUNT; i++) far[turned][i] = leaf | (turned ? 0 : bit);
    l->count[SC_LIST_FAR] += lanes_list_from(mask, first | (turned ? bit : 0), far[1 - turned]);
}

/* A patch of each of two objects, whose boxes overlap: the larger one is opened, that is its
   descendants at the next level that is visited are compared with the other's box. */
static inline void open_two(sc_worker *w, uint32_t item, uint32_t b, int moves)
{
    const uint32_t a = item & SC_ITEM, bit = item & SC_AFTER_CONTOUR;
    const uint32_t leaves[2] = {sc_model_first_leaf_patch(w->model),
                                sc_model_first_leaf_patch(w->second->model)};
    const int turned = b < leaves[1] &&
                       (a >= leaves[0] ||
                        sc_model_leaves_of(w->model, a) < sc_model_leaves_of(w->second->model, b));
    const sc_worker *opened = turned ? w->second : w, *other = turned ? w : w->second;
    const uint32_t *child = sc_model_box_child(opened->model) + (turned ? b : a);
    const uint32_t kept = turned ? a : b, first = child[0], all = (1u << (child[1] - first)) - 1u;
    unsigned mask;
    if (a >= leaves[0] && b >= leaves[1]) {
        list_between(w, bit, a - leaves[0], b - leaves[1], 1, 0, moves);
        return;
    }
    mask = near_others(other->frame, kept, opened->frame, first, moves) & all;
    sc_worker_count_boxes(w, sc_item_follows(item), sc_bits_count(all));
    if (first >= leaves[turned] && kept >= leaves[1 - turned]) {
        list_between(w, bit, kept - leaves[1 - turned], first - leaves[turned], mask, !turned,
                     moves);
        return;
    }
    for (; mask; mask &= mask - 1) {
        const uint32_t c = first + sc_bits_lowest(mask);
        add_patches(w, (turned ? a : c) | bit, turned ? c : b);
    }
}

/* Pairs of patches of two objects. The list is a stack, to which each pair adds 15 more at most,
   as often as there are levels to visit in both. */
static inline void open_all_two(sc_worker *w, uint32_t most, int moves)
{
    sc_lists *l = &w->lists;
    uint32_t *count = &l->count[SC_LIST_PATCHES];
    for (; most && *count && l->count[SC_LIST_FAR] < SC_LEAF_LIST_ENOUGH &&
           l->count[SC_LIST_CLUSTERS] <= SC_CLUSTERS_MAX - SC_LEAF_MAX;
         most--) {
        const sc_pair pair = l->patches[--*count];
        open_two(w, pair.a, pair.b, moves);
    }
}

/* ---- the same for poses and for steps ---- */

static void open_between(sc_worker *w, uint32_t most)
{
    open_all_two(w, most, 0);
}

static void open_moving_between(sc_worker *w, uint32_t most)
{
    open_all_two(w, most, 1);
}

static void leave_patch_pairs(sc_worker *w, uint32_t most)
{
    leave_pairs(w, most, 0);
}

static void leave_moving_pairs(sc_worker *w, uint32_t most)
{
    leave_pairs(w, most, 1);
}

static void open_patch_pairs(sc_worker *w, uint32_t most)
{
    open_pairs(w, most, 0);
}

static void open_moving_pairs(sc_worker *w, uint32_t most)
{
    open_pairs(w, most, 1);
}

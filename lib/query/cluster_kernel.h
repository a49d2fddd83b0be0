/*
 * Pairs of leaf clusters: proofs that strike out those that have nothing in common but what they
 * share; and of the others the triangles: boxes against boxes, row by row; then rows against
 * planes; then what is left, sixteen pairs at a time, of one pair of clusters or of two
 * (query/sixteen_kernel.h). Each of these goes through some pairs of leaf clusters before the next
 * begins, so that few branches depend on how many rows or triangles one of them has. See
 * query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 */

/* ---- proofs ---- */

/* Prefetches the derived data of a leaf cluster; fetch_points its slab and points, and the derived
   data that a slab is made of where there is none yet. */
static inline void fetch_derived(const sc_worker *w, uint32_t leaf)
{
    const float *at = w->kept.derived[derived_place(w, leaf)].side[0];
    int k;
    for (k = 0; k < SC_DERIVED_ROWS; k++) sc_fetch(at + SC_LEAF_MAX * k);
}

static inline void fetch_points(const sc_worker *w, uint32_t leaf)
{
    const float *at = w->frame->point_at + 4 * SC_LEAF_POINTS * (uint64_t)leaf;
    int k;
    for (k = 0; k < 4; k++) sc_fetch(at + SC_LEAF_POINTS * k);
    if (w->kept.slab[leaf].epoch != w->frame->epoch) fetch_derived(w, leaf);
}

/* Lists such a pair as left. */
static inline void list_far(uint32_t item, uint32_t other, uint32_t known, sc_cluster_pair *to)
{
    to->a = item & SC_ITEM;
    to->b = other;
    to->shared = SC_NONE;
    to->known = (item & SC_AFTER_CONTOUR) | SC_CLUSTERS_FAR | known;
}

/* Pairs of leaf clusters that share no points, or are crowded. If they are many, slabs drop most of
   those that hold no pair of triangles; some pairs ahead, memory is asked for. If they are few, it
   does not pay to make slabs before boxes meet. */
static void part_far(sc_worker *w, uint32_t most)
{
    sc_lists *l = &w->lists;
    uint32_t *left = &l->count[SC_LIST_FAR], count = *left < most ? *left : most, kept = 0, i;
    const uint32_t *item = l->far[0] + (*left -= count), *other = l->far[1] + *left;
    const sc_worker *v = w->second;
    const int keeps_all = (w->kept.mask & v->kept.mask) == SC_KEEPS_ALL;
    sc_cluster_pair *to = l->clusters + l->count[SC_LIST_CLUSTERS];
    if (count < SC_LEAF_SLABS_FIRST) {
        for (i = 0; i < count; i++) list_far(item[i], other[i], SC_CLUSTERS_UNSLABBED, to + i);
        l->count[SC_LIST_CLUSTERS] += count;
        return;
    }
    for (i = 0; i < count; i++) {
        const uint32_t a = item[i] & SC_ITEM, b = other[i];
        if (i + SC_MADE_LEAVES < count) {
            sc_fetch(w->kept.slab + (item[i + SC_MADE_LEAVES] & SC_ITEM));
            sc_fetch(v->kept.slab + other[i + SC_MADE_LEAVES]);
        }
        if (i % SC_MADE_LEAVES == 0 && keeps_all) {
            const uint32_t some = count - i < SC_MADE_LEAVES ? count - i : SC_MADE_LEAVES;
            make_slabs(w, item + i, some);
            make_slabs(v, other + i, some);
        }
        if (i + SC_FETCH_POINTS < count) fetch_points(v, other[i + SC_FETCH_POINTS]);
        list_far(item[i], b, 0, to + kept);
        kept += !slabs_part(w, a, derived_place(w, a), b, derived_place(v, b));
    }
    l->count[SC_LIST_CLUSTERS] += kept;
}

/* Pairs of leaf clusters that share points, and leaf clusters against themselves: drops those that
   a proof separates, and prefetches for the others what tells whether their derived data is made,
   and where their lists begin. In steps with few branches, as any pair may be one of a kind. */
static SC_NOINLINE void part_near(sc_worker *w, uint32_t most)
{
    const uint32_t *leaf = sc_model_share_leaf(w->model);
    const uint32_t *begin = sc_model_share_begin(w->model);
    const uint16_t *touch = sc_model_share_touch(w->model);
    const int has_cones = w->question->has_last;
    sc_lists *l = &w->lists;
    uint32_t *left = &l->count[SC_LIST_NEAR], count = *left < most ? *left : most;
    const uint32_t *lower = l->near[0] + (*left -= count), *where = l->near[1] + *left;
    sc_cluster_pair *pairs = l->clusters + l->count[SC_LIST_CLUSTERS];
    uint32_t touch_count = 0, known = 0, kept = 0, i;
    for (i = 0; i < count; i++) {
        const uint32_t a = lower[i] & SC_ITEM, shared = where[i];
        pairs[i].a = pairs[i].b = a;
        pairs[i].shared = shared;
        if (shared != SC_NONE) {
            pairs[i].b = leaf[shared];
            pairs[i].known = touch[shared];
        } else {
            pairs[i].known = has_two_chains(w->model, a) ? SC_TOUCH_CHAIN : 0;
        }
        l->scratch[touch_count] = i;
        touch_count += (pairs[i].known & SC_TOUCHES) != 0;
        known |= pairs[i].known;
        pairs[i].known |= lower[i] & SC_AFTER_CONTOUR;
    }
    if (touch_count) drop_touching(w, pairs, l->scratch, touch_count);
    if (known & SC_TOUCH_CHAIN) drop_bands(w, pairs, count);
    if (has_cones) drop_certified(w, pairs, count);
    for (i = 0; i < count; i++) {
        const sc_cluster_pair p = pairs[i];
        sc_fetch(w->kept.known + derived_place(w, p.a));
        sc_fetch(w->kept.known + derived_place(w, p.b));
        sc_fetch(begin + (p.a == p.b ? 0 : p.shared));
        pairs[kept] = p;
        kept += !(p.known & SC_CLUSTERS_DROPPED);
    }
    l->count[SC_LIST_CLUSTERS] += kept;
}

/* ---- boxes and planes ---- */

/* Rows without a mask, whose boxes are to be compared: of which pair of clusters, and which
   triangle of the former. */
typedef struct waiting_rows {
    uint8_t pair[SC_TRIANGLES_MAX], row[SC_TRIANGLES_MAX];
    unsigned count;
} waiting_rows;

/* The boxes of the triangles of a leaf cluster that overlap that of triangle i of another. */
static inline unsigned overlap_row(const sc_leaf_derived *a, uint32_t i, const lanes low[3],
                                   const lanes high[3])
{
    lanes_mask m[3];
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++)
        m[k] = lanes_both(lanes_not_above(lanes_all(a->side[k][i]), high[k]),
                          lanes_not_above(low[k], lanes_all(a->side[k + 3][i])));
    return lanes_bits(lanes_both(m[0], lanes_both(m[1], m[2])));
}

static inline void load_boxes(const sc_leaf_derived *derived, lanes low[3], lanes high[3])
{
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        low[k] = lanes_load(derived->side[k]);
        high[k] = lanes_load(derived->side[k + 3]);
    }
}

/* Finds which boxes overlap in rows that wait. Without branches, as any row may have some. */
static unsigned compare_boxes(const waiting_rows *wait, sc_triangle_rows *rows, unsigned count)
{
    unsigned t;
    for (t = 0; t < wait->count; t++) {
        const unsigned pair = wait->pair[t], row = wait->row[t];
        lanes low[3], high[3];
        load_boxes(rows->derived[1][pair], low, high);
        rows->pair[count] = (uint8_t)pair;
        rows->row[count] = (uint8_t)row;
        rows->mask[count] = (uint16_t)overlap_row(rows->derived[0][pair], row, low, high);
        count += rows->mask[count] != 0;
    }
    return count;
}

/* The same where these are rows of clusters that share points: without the pairs that do. */
static unsigned compare_near_boxes(const waiting_rows *wait, sc_triangle_rows *rows, unsigned count)
{
    unsigned t;
    for (t = 0; t < wait->count; t++) {
        unsigned pair = wait->pair[t], row = wait->row[t], mask, shared;
        const uint16_t *list = rows->list[pair];
        lanes low[3], high[3];
        load_boxes(rows->derived[1][pair], low, high);
        mask = overlap_row(rows->derived[0][pair], row, low, high);
        shared = list[SC_SHARE_ROWS + sc_bits_count(list[SC_SHARE_TRIANGLES] & ((1u << row) - 1u))];
        mask &= ~(shared & (0u - ((unsigned)list[SC_SHARE_TRIANGLES] >> row & 1u)));
        rows->pair[count] = (uint8_t)pair;
        rows->row[count] = (uint8_t)row;
        rows->mask[count] = (uint16_t)mask;
        count += mask != 0;
    }
    return count;
}

/* The same of a cluster against itself, or of two that are crowded: pairs that share points are
   listed, and not in the rows. Returns how many rows there are now. */
static unsigned take_shared(sc_worker *w, const sc_leaf_pair *p, unsigned pair, unsigned some,
                            unsigned count)
{
    sc_triangle_rows *rows = w->lists.triangles;
    uint8_t near_a[SC_LEAF_PAIRS + 2 * SC_LANES_COUNT], near_b[SC_LEAF_PAIRS + 2 * SC_LANES_COUNT];
    const unsigned lower = p->a == p->b ? 0 : SC_LEAF_ALL; /* of b, those below i, too */
    unsigned near_count = 0, near = 0;                     /* triangles that are looked at */
    lanes low[3], high[3];
    if (p->wanted) near = p->a == p->b ? doubtful(w, p->a) : SC_LEAF_ALL;
    load_boxes(rows->derived[1][pair], low, high);
    for (; some; some &= some - 1) {
        uint32_t i = sc_bits_lowest(some);
        unsigned mask = overlap_row(rows->derived[0][pair], i, low, high), shared = p->shared[i];
        mask &= ~((2u << i) - 1u) | lower;
        memset(near_a + near_count, (int)i, SC_LANES_COUNT);
        near_count += lanes_list(mask & shared & (near >> i & 1u ? near : 0u), near_b + near_count);
        mask &= ~shared;
        rows->pair[count] = (uint8_t)pair;
        rows->row[count] = (uint8_t)i;
        rows->mask[count] = (uint16_t)mask;
        count += mask != 0;
    }
    if (near_count) take_neighbors(w, p, rows->extent[pair], near_a, near_b, near_count);
    return count;
}

/* Drops pairs of which the plane of the row's triangle has the other on one side. */
static unsigned compare_planes(const sc_worker *w, sc_triangle_rows *rows, unsigned rows_count)
{
    const sc_worker *v = w->second;
    unsigned count = 0, r = 0;
    int k;
    while (r < rows_count) {
        const unsigned pair = rows->pair[r];
        const uint64_t leaf_b = rows->leaf[1][pair];
        const sc_leaf_derived *a = rows->derived[0][pair];
        const uint8_t *where = sc_model_leaf_corner(v->model) + 3 * SC_LEAF_MAX * leaf_b;
        const float extent = rows->extent[pair];
        lanes_index corner[3];
        lanes at[3];
        lanes_coordinates(v->frame->point_at + 4 * SC_LEAF_POINTS * leaf_b, at);
        SC_UNROLL
        for (k = 0; k < 3; k++) corner[k] = lanes_index_load(where + SC_LEAF_MAX * k);
        do {
            unsigned i = rows->row[r];
            float bound = one_plane_bound(a->size[i], extent);
            lanes d[3], along = lanes_multiply(lanes_all(a->normal[0][i]), at[0]);
            lanes_mask meets;
            SC_UNROLL
            for (k = 1; k < 3; k++)
                along = lanes_add(along, lanes_multiply(lanes_all(a->normal[k][i]), at[k]));
            SC_UNROLL
            for (k = 0; k < 3; k++) d[k] = lanes_pick_of(along, corner[k]);
            meets = lanes_both(lanes_not_above(lanes_smaller(d[0], lanes_smaller(d[1], d[2])),
                                               lanes_all(a->offset[i] + bound)),
                               lanes_not_above(lanes_all(a->offset[i] - bound),
                                               lanes_larger(d[0], lanes_larger(d[1], d[2]))));
            rows->pair[count] = (uint8_t)pair;
            rows->row[count] = (uint8_t)i;
            rows->mask[count] = (uint16_t)(rows->mask[r] & lanes_bits(meets));
            count += rows->mask[count] != 0;
        } while (++r < rows_count && rows->pair[r] == pair);
    }
    return count;
}

/* The triangles of a leaf cluster, given as its derived data, whose boxes overlap that of leaf
   b. */
static inline unsigned rows_at(const sc_worker *w, const sc_leaf_derived *derived, uint32_t b)
{
    const sc_boxes *boxes = &w->second->frame->patch_boxes;
    uint64_t i = (uint64_t)sc_model_first_leaf_patch(w->second->model) + b;
    lanes_mask m[3];
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++)
        m[k] = lanes_both(
            lanes_not_above(lanes_all(boxes->side[k][i]), lanes_load(derived->side[k + 3])),
            lanes_not_above(lanes_load(derived->side[k]), lanes_all(boxes->side[k + 3][i])));
    return lanes_bits(lanes_both(m[0], lanes_both(m[1], m[2])));
}

/* Where two leaf clusters are kept, or one. */
typedef struct kept_places {
    uint32_t a, b;
} kept_places;

static inline kept_places places_of_pair(const sc_worker *w, const sc_cluster_pair *p)
{
    kept_places at;
    at.a = derived_place(w, p->a);
    at.b = derived_place(w->second, p->b);
    if (at.a == at.b && p->a != p->b && !sc_worker_is_between(w)) at.b = w->kept.spare;
    return at;
}

/* Whether a pair is one leaf cluster, to be looked at by itself. */
static inline int is_alone(const sc_worker *w, const sc_cluster_pair *p)
{
    return p->a == p->b && !sc_worker_is_between(w);
}

/* Whether one of the places of a pair is that of another leaf cluster that so many pairs are of. */
static int is_taken(const sc_worker *w, const sc_cluster_pair *p, kept_places at, unsigned pairs)
{
    const sc_triangle_rows *rows = w->lists.triangles;
    const sc_leaf_derived *a = w->kept.derived + at.a, *b = w->second->kept.derived + at.b;
    int taken = 0;
    unsigned k;
    if (!has_derived(w, p->a, at.a))
        for (k = 0; k < pairs; k++)
            taken |= (rows->derived[0][k] == a) | (rows->derived[1][k] == a);
    if (!has_derived(w->second, p->b, at.b))
        for (k = 0; k < pairs; k++)
            taken |= (rows->derived[0][k] == b) | (rows->derived[1][k] == b);
    return taken;
}

/* Names two leaf clusters whose derived data is made, and of which rows come next: triangles of
   a. */
static inline void name_pair(const sc_worker *w, const sc_cluster_pair *p, kept_places at,
                             unsigned k)
{
    sc_triangle_rows *rows = w->lists.triangles;
    const sc_kept_leaves *of_b = &w->second->kept;
    rows->leaf[0][k] = p->a | (p->known & SC_AFTER_CONTOUR);
    rows->leaf[1][k] = p->b;
    rows->derived[0][k] = w->kept.derived + at.a;
    rows->derived[1][k] = of_b->derived + at.b;
    rows->extent[k] = w->kept.known[at.a].extent + (is_alone(w, p) ? 0 : of_b->known[at.b].extent);
}

/* Has these triangles wait as rows of a pair. Returns how many. */
static inline unsigned add_waiting(unsigned some, unsigned pair, waiting_rows *wait)
{
    const unsigned count = lanes_list(some, wait->row + wait->count);
    memset(wait->pair + wait->count, (int)pair, SC_LANES_COUNT);
    wait->count += count;
    return count;
}

/* What two leaf clusters, or one, add to the rows. */
typedef struct added_rows {
    unsigned pairs, count; /* of clusters, and of rows */
    waiting_rows wait;
} added_rows;

/* Two leaf clusters that share no points, are not crowded and that slabs do not part; the derived
   data of both is made. Without branches, as boxes of triangles may be apart from the other in
   many. */
static inline void add_far(sc_worker *w, const sc_cluster_pair *p, kept_places at, added_rows *to)
{
    const sc_leaf_derived *derived = w->kept.derived + at.a;
    unsigned count;
    name_pair(w, p, at, to->pairs);
    count = add_waiting(rows_at(w, derived, p->b), to->pairs, &to->wait);
    to->pairs += count != 0;
    sc_worker_count_boxes(w, sc_item_follows(p->known), count);
}

/* Any two, a <= b, or one. */
static void add_clusters(sc_worker *w, const sc_cluster_pair *clusters, kept_places at,
                         added_rows *to)
{
    const sc_leaf_derived *a = derived_leaf(w, clusters->a, at.a);
    sc_leaf_pair p;
    unsigned some;
    if (is_alone(w, clusters)) {
        const uint32_t *first = sc_model_leaf_first(w->model) + clusters->a;
        some = (1u << (first[1] - first[0] - 1)) - 1u;
    } else {
        some = rows_at(w, a, clusters->b);
        if (!some) return;
        (void)derived_leaf(w->second, clusters->b, at.b);
        if (clusters->known & SC_CLUSTERS_UNSLABBED &&
            slabs_part(w, clusters->a, at.a, clusters->b, at.b))
            return;
    }
    sc_clusters_enter(w, clusters, &p);
    name_pair(w, clusters, at, to->pairs);
    w->lists.triangles->list[to->pairs] = p.list;
    if (p.shares && !p.list) {
        to->count = take_shared(w, &p, to->pairs, some, to->count);
    } else {
        add_waiting(some, to->pairs, &to->wait);
        if (p.list && p.wanted) take_listed(w, &p, w->lists.triangles->extent[to->pairs]);
    }
    sc_worker_count_boxes(w, sc_item_follows(clusters->known), sc_bits_count(some));
    to->pairs++;
}

/* Asks for what a pair of leaf clusters needs that share points, or one by itself. */
static inline void fetch_near(const sc_worker *w, const sc_cluster_pair *p)
{
    const sc_model *model = w->model;
    sc_fetch(sc_model_leaf_corner(model) + 3 * SC_LEAF_MAX * (uint64_t)p->b);
    if (p->shared != SC_NONE) {
        const uint16_t *list = sc_model_share_list(model) + sc_model_share_begin(model)[p->shared];
        sc_fetch(list);
        sc_fetch(list + 32);
    } else {
        sc_fetch(sc_model_share_own_rows(model) + SC_OWN_WORDS * (uint64_t)p->a);
    }
}

/* Whether there is room for what two leaf clusters list that share points. Pairs of triangles that
   share one are open first. */
static inline int have_room_for_clusters(const sc_worker *w)
{
    const uint32_t *count = w->lists.count;
    return count[SC_LIST_OPEN] <= SC_OPEN_MAX - SC_LEAF_PAIRS &&
           count[SC_LIST_EXACT] <= SC_FEW_MAX - SC_LEAF_PAIRS;
}

/* Triangles of pairs of leaf clusters, of one kind, by their boxes, and by planes of one of each.
   Derived data may have to be made where that of a leaf cluster of these rows is kept: then the
   rows are compared first. */
static void compare_clusters(sc_worker *w, uint32_t most)
{
    const sc_worker *v = w->second;
    const uint8_t *crowded = sc_model_share_crowded(w->model);
    const uint8_t *others = sc_model_share_crowded(v->model);
    const int keeps_all = (w->kept.mask & v->kept.mask) == SC_KEEPS_ALL;
    sc_lists *l = &w->lists;
    uint32_t left = l->count[SC_LIST_CLUSTERS];
    const uint32_t end = left < most ? 0 : left - most;
    const uint32_t far = l->clusters[left - 1].known & SC_CLUSTERS_FAR;
    added_rows to;
    to.pairs = to.count = to.wait.count = 0;
    for (; left > end; left--) {
        const sc_cluster_pair *p = l->clusters + left - 1;
        const kept_places at = places_of_pair(w, p);
        if ((p->known & SC_CLUSTERS_FAR) != far || (!keeps_all && is_taken(w, p, at, to.pairs)))
            break;
        if (left > SC_FETCH_DERIVED) {
            const sc_cluster_pair *next = p - SC_FETCH_DERIVED;
            fetch_derived(w, next->a);
            fetch_derived(v, next->b);
            if (!far) fetch_near(w, next);
        }
        if (far && !((p->known & SC_CLUSTERS_UNSLABBED) | (crowded[p->a] & others[p->b])) &&
            has_derived(w, p->a, at.a) & has_derived(v, p->b, at.b))
            add_far(w, p, at, &to);
        else if (have_room_for_clusters(w))
            add_clusters(w, p, at, &to);
        else
            break;
    }
    l->count[SC_LIST_CLUSTERS] = left;
    to.count = far ? compare_boxes(&to.wait, l->triangles, to.count)
                   : compare_near_boxes(&to.wait, l->triangles, to.count);
    l->count[SC_LIST_TRIANGLES] = compare_planes(w, l->triangles, to.count);
}

/* ---- sixteen pairs of triangles ---- */

/* Pairs of triangles of two leaf clusters, or of two such pairs of clusters, lanes from split on
   being of the second. */
typedef struct rows_window {
    const uint8_t *numbers[2]; /* of triangles in their clusters, sixteen may be read */
    unsigned pair[2];          /* of clusters */
    unsigned split, count;
} rows_window;

/* Fills a sixteen with these; and the places of the clusters' first triangles, with the bit for
   what follows a contour test. */
static inline void fill_sixteen(const sc_worker *w, const rows_window *window, sixteen_pairs *x,
                                uint32_t first[2][2])
{
    const sc_triangle_rows *rows = w->lists.triangles;
    int s, k;
    SC_UNROLL
    for (s = 0; s < 2; s++) {
        const sc_worker *v = s ? w->second : w;
        picked *t = &x->of[s];
        t->numbers = window->numbers[s];
        SC_UNROLL
        for (k = 0; k < 2; k++) {
            const unsigned pair = window->pair[k];
            const uint32_t item = rows->leaf[s][pair];
            const uint64_t leaf = item & SC_ITEM;
            t->derived[k] = rows->derived[s][pair];
            t->points[k] = v->frame->point_at + 4 * SC_LEAF_POINTS * leaf;
            t->corner[k] = sc_model_leaf_corner(v->model) + 3 * SC_LEAF_MAX * leaf;
            first[s][k] = sc_model_leaf_first(v->model)[leaf] | (item & SC_AFTER_CONTOUR);
        }
    }
    x->split = window->split < window->count ? window->split : SC_LANES_COUNT;
    x->extent = lanes_choose(lanes_from(window->split), lanes_all(rows->extent[window->pair[1]]),
                             lanes_all(rows->extent[window->pair[0]]));
}

/* Lists those of pairs of triangles that are not certainly apart. What becomes of a pair does not
   depend on which others are in its sixteen: these are not the same with several workers. */
static void collect(sc_worker *w, const rows_window *window)
{
    sc_lists *l = &w->lists;
    uint32_t *count = &l->count[SC_LIST_CANDIDATES];
    unsigned mask = (1u << window->count) - 1u;
    sixteen_pairs x;
    uint32_t first[2][2];
    fill_sixteen(w, window, &x, first);
    mask &= ~part_pairs(&x, mask);
    *count += lanes_list_pairs(mask, ~0u << window->split, window->numbers[0], first[0],
                               window->numbers[1], first[1],
                               (uint32_t *)(void *)(l->candidates + *count));
}

/* Some of the last rows: those of a pair of clusters together. */
static void compare_triangles(sc_worker *w, uint32_t most)
{
    const sc_triangle_rows *rows = w->lists.triangles;
    uint8_t of_a[SC_ROWS_LIST], of_b[SC_ROWS_LIST], pair[SC_ROWS_PAIRS + 1];
    uint16_t end[SC_ROWS_PAIRS + 1];
    uint32_t *left = &w->lists.count[SC_LIST_TRIANGLES];
    unsigned r = *left, count = 0, pairs = 0, at = 0, k = 0;
    rows_window window;
    (void)most;
    do {
        r--;
        memset(of_a + count, rows->row[r], SC_LANES_COUNT);
        count += lanes_list(rows->mask[r], of_b + count);
        pair[pairs] = rows->pair[r];
        end[pairs] = (uint16_t)count;
        pairs += r == 0 || rows->pair[r - 1] != rows->pair[r];
    } while (r && (count < SC_ROWS_LISTED || rows->pair[r - 1] == rows->pair[r]));
    *left = r;
    memset(of_a + count, 0, SC_LANES_COUNT); /* fills the last sixteen */
    memset(of_b + count, 0, SC_LANES_COUNT);
    for (; at < count; at += window.count) {
        const unsigned next = k + (k + 1 < pairs && end[k] < at + SC_LANES_COUNT);
        window.numbers[0] = of_a + at;
        window.numbers[1] = of_b + at;
        window.pair[0] = pair[k];
        window.pair[1] = pair[next];
        window.split = end[k] - at;
        window.count = end[next] - at;
        if (window.split > SC_LANES_COUNT) window.split = SC_LANES_COUNT;
        if (window.count > SC_LANES_COUNT) window.count = SC_LANES_COUNT;
        collect(w, &window);
        while (k < pairs && end[k] <= at + window.count) k++;
    }
}

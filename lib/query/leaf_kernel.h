/*
 * The triangles of two leaf clusters, or of one: boxes against boxes, row by row; then rows against
 * planes; then what is left, sixteen pairs at a time, of one pair of clusters or of two
 * (query/sixteen_kernel.h). Pairs that are not certainly apart are collected. Each of these goes through some pairs of leaf clusters before the next
 * begins, so that few branches depend on how many rows or triangles one of them has. See
 * query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 */
/* What is left of pairs of leaf clusters: rows, that is triangles of one of them and a mask of the
   other's. Those of one pair are together. */
typedef struct leaf_rows {
    uint32_t leaf[2][SC_ROWS_PAIRS];
    const sc_leaf_ready *ready[2][SC_ROWS_PAIRS]; /* all of them are, as long as there are rows */
    const uint16_t *list[SC_ROWS_PAIRS];          /* as in sc_leaf_pair */
    float extent[SC_ROWS_PAIRS];                  /* of both; made when needed */
    int near;                                     /* those that wait have such a list */
    unsigned pairs, wait, count;                  /* how many there are */
    uint8_t wait_pair
        [SC_ROWS]; /* rows without a mask, whose boxes are to be compared: of which pair, */
    uint8_t wait_row[SC_ROWS]; /* and the triangle */
    uint8_t pair[SC_ROWS];     /* the others */
    uint8_t row[SC_ROWS];
    uint16_t mask[SC_ROWS];
    open_neighbors open; /* pairs of triangles that share points, of these clusters or others */
} leaf_rows;

static inline void no_rows(leaf_rows *rows)
{
    rows->pairs = rows->wait = rows->count = 0;
}

/* Pairs of triangles of two leaf clusters, or of two such pairs of clusters, lanes from split on
   being of the second. */
typedef struct rows_window {
    const uint8_t *numbers[2]; /* of triangles in their clusters, sixteen may be read */
    unsigned pair[2];          /* of clusters */
    unsigned split, count;
} rows_window;

/* Fills a sixteen with these; and the places of the clusters' first triangles. */
static inline void fill_sixteen(const sc_query_state *state, const leaf_rows *rows,
                                const rows_window *window, sixteen_pairs *x, uint32_t first[2][2])
{
    int s, k;
    SC_UNROLL
    for (s = 0; s < 2; s++) {
        picked *t = &x->of[s];
        t->numbers = window->numbers[s];
        SC_UNROLL
        for (k = 0; k < 2; k++) {
            const unsigned pair = window->pair[k];
            const uint64_t leaf = rows->leaf[s][pair];
            t->ready[k] = rows->ready[s][pair];
            t->points[k] = state->workspace->point_at + 4 * SC_LEAF_POINTS * leaf;
            t->corner[k] = sc_model_leaf_corner(state->model) + 3 * SC_LEAF_MAX * leaf;
            first[s][k] = sc_model_leaf_first(state->model)[leaf];
        }
    }
    x->split = window->split < window->count ? window->split : SC_LANES_COUNT;
    x->extent = lanes_choose(lanes_from(window->split), lanes_all(rows->extent[window->pair[1]]),
                             lanes_all(rows->extent[window->pair[0]]));
}

/* Collects those of pairs of triangles that are not certainly apart. What becomes of a pair does not
   depend on which others are in its sixteen: these are not the same with several workers. */
static void collect(sc_query_state *state, const leaf_rows *rows, const rows_window *window)
{
    sc_workspace *w = state->workspace;
    unsigned mask = (1u << window->count) - 1u;
    sixteen_pairs x;
    uint32_t first[2][2];
    fill_sixteen(state, rows, window, &x, first);
    mask &= ~part_pairs(&x, mask);
    w->candidate_count += lanes_list_pairs(
        mask, ~0u << window->split, window->numbers[0], first[0], window->numbers[1], first[1],
        (uint32_t *)(void *)(w->candidates + w->candidate_count));
}

/* The boxes of the triangles of a leaf cluster that overlap that of triangle i of another. */
static inline unsigned overlap_row(const sc_leaf_ready *a, uint32_t i, const lanes low[3],
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

static inline void load_boxes(const sc_leaf_ready *ready, lanes low[3], lanes high[3])
{
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        low[k] = lanes_load(ready->side[k]);
        high[k] = lanes_load(ready->side[k + 3]);
    }
}

/* Finds which boxes overlap in rows that wait. Without branches, as any row may have some. */
static void compare_boxes(leaf_rows *rows)
{
    unsigned count = rows->count, t;
    for (t = 0; t < rows->wait; t++) {
        unsigned pair = rows->wait_pair[t], row = rows->wait_row[t];
        lanes low[3], high[3];
        load_boxes(rows->ready[1][pair], low, high);
        rows->pair[count] = (uint8_t)pair;
        rows->row[count] = (uint8_t)row;
        rows->mask[count] = (uint16_t)overlap_row(rows->ready[0][pair], row, low, high);
        count += rows->mask[count] != 0;
    }
    rows->count = count;
    rows->wait = 0;
}

/* The same where these are rows of clusters that share points: without the pairs that do. */
static void compare_near_boxes(leaf_rows *rows)
{
    unsigned count = rows->count, t;
    for (t = 0; t < rows->wait; t++) {
        unsigned pair = rows->wait_pair[t], row = rows->wait_row[t], mask, shared;
        const uint16_t *list = rows->list[pair];
        lanes low[3], high[3];
        load_boxes(rows->ready[1][pair], low, high);
        mask = overlap_row(rows->ready[0][pair], row, low, high);
        shared = list[SC_SHARE_ROWS + sc_bits_count(list[SC_SHARE_TRIANGLES] & ((1u << row) - 1u))];
        mask &= ~(shared & (0u - ((unsigned)list[SC_SHARE_TRIANGLES] >> row & 1u)));
        rows->pair[count] = (uint8_t)pair;
        rows->row[count] = (uint8_t)row;
        rows->mask[count] = (uint16_t)mask;
        count += mask != 0;
    }
    rows->count = count;
    rows->wait = 0;
}

/* The same of a cluster against itself, or of two that are crowded, to come: pairs that share
   points are taken, and not in the rows. */
static void take_shared(sc_query_state *state, const sc_leaf_pair *p, const sc_leaf_ready *a,
                        const sc_leaf_ready *b, unsigned some, leaf_rows *rows)
{
    uint8_t near_a[SC_LEAF_PAIRS + 2 * SC_LANES_COUNT], near_b[SC_LEAF_PAIRS + 2 * SC_LANES_COUNT];
    const unsigned lower = p->a == p->b ? 0 : SC_LEAF_ALL;  /* of b, those below i, too */
    unsigned count = rows->count, near_count = 0, near = 0; /* triangles that are looked at */
    lanes low[3], high[3];
    if (p->wanted) near = p->a == p->b ? doubtful(state, p->a) : SC_LEAF_ALL;
    load_boxes(b, low, high);
    for (; some; some &= some - 1) {
        uint32_t i = sc_bits_lowest(some);
        unsigned mask = overlap_row(a, i, low, high), shared = p->shared[i];
        mask &= ~((2u << i) - 1u) | lower;
        memset(near_a + near_count, (int)i, SC_LANES_COUNT);
        near_count += lanes_list(mask & shared & (near >> i & 1u ? near : 0u), near_b + near_count);
        mask &= ~shared;
        rows->pair[count] = (uint8_t)rows->pairs;
        rows->row[count] = (uint8_t)i;
        rows->mask[count] = (uint16_t)mask;
        count += mask != 0;
    }
    rows->count = count;
    if (near_count) {
        take_neighbors(state, p, near_a, near_b, near_count, &rows->open);
        sc_candidates_make_room(state);
    }
}

/* Drops pairs of which the plane of the row's triangle has the other on one side. */
static void compare_planes(const sc_query_state *state, leaf_rows *rows)
{
    unsigned count = 0, r = 0;
    int k;
    while (r < rows->count) {
        const unsigned pair = rows->pair[r];
        const uint32_t leaf_a = rows->leaf[0][pair], leaf_b = rows->leaf[1][pair];
        const sc_leaf_ready *a = rows->ready[0][pair];
        const uint8_t *where =
            sc_model_leaf_corner(state->model) + 3 * SC_LEAF_MAX * (uint64_t)leaf_b;
        const float extent = pair_extent(state, leaf_a, leaf_b);
        lanes_index corner[3];
        lanes at[3];
        rows->extent[pair] = extent;
        lanes_turned(state->workspace->point_at + 4 * SC_LEAF_POINTS * (uint64_t)leaf_b, at);
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
        } while (++r < rows->count && rows->pair[r] == pair);
    }
    rows->count = count;
}

/* Tests what is left of all pairs of leaf clusters, and forgets them. */
static void test_rows(sc_query_state *state, leaf_rows *rows)
{
    uint8_t of_a[SC_ROWS_LIST], of_b[SC_ROWS_LIST], pair[SC_ROWS_PAIRS + 1];
    uint16_t end[SC_ROWS_PAIRS + 1];
    unsigned r = 0, k;
    if (rows->near)
        compare_near_boxes(rows);
    else if (rows->wait)
        compare_boxes(rows);
    if (rows->count) compare_planes(state, rows);
    while (r < rows->count && !state->stop) {
        unsigned count = 0, pairs = 0, at = 0;
        rows_window window;
        do {
            memset(of_a + count, rows->row[r], SC_LANES_COUNT);
            count += lanes_list(rows->mask[r], of_b + count);
            pair[pairs] = rows->pair[r];
            end[pairs] = (uint16_t)count;
            r++;
            pairs += r == rows->count || rows->pair[r] != rows->pair[r - 1];
        } while (r < rows->count && (count < SC_ROWS_LISTED || rows->pair[r] == rows->pair[r - 1]));
        memset(of_a + count, 0, SC_LANES_COUNT); /* fills the last sixteen */
        memset(of_b + count, 0, SC_LANES_COUNT);
        for (k = 0; at < count && !state->stop; at += window.count) {
            const unsigned next = k + (k + 1 < pairs && end[k] < at + SC_LANES_COUNT);
            window.numbers[0] = of_a + at;
            window.numbers[1] = of_b + at;
            window.pair[0] = pair[k];
            window.pair[1] = pair[next];
            window.split = end[k] - at;
            window.count = end[next] - at;
            if (window.split > SC_LANES_COUNT) window.split = SC_LANES_COUNT;
            if (window.count > SC_LANES_COUNT) window.count = SC_LANES_COUNT;
            collect(state, rows, &window);
            sc_candidates_make_room(state);
            while (k < pairs && end[k] <= at + window.count) k++;
        }
    }
    no_rows(rows);
}

/* Names two leaf clusters, a and b when they are ready, of which rows come next: triangles of a. */
static inline void name_pair(uint32_t leaf_a, uint32_t leaf_b, const sc_leaf_ready *a,
                             const sc_leaf_ready *b, leaf_rows *rows)
{
    const unsigned k = rows->pairs;
    rows->leaf[0][k] = leaf_a;
    rows->leaf[1][k] = leaf_b;
    rows->ready[0][k] = a;
    rows->ready[1][k] = b;
}

/* Has these triangles wait as rows of them. Returns how many. */
static inline unsigned add_waiting(unsigned some, leaf_rows *rows)
{
    unsigned count = lanes_list(some, rows->wait_row + rows->wait);
    memset(rows->wait_pair + rows->wait, (int)rows->pairs, SC_LANES_COUNT);
    rows->wait += count;
    return count;
}

/* Adds two leaf clusters, a and b when they are ready, or one; of a only some triangles may overlap
   b. */
static void add_rows(sc_query_state *state, const sc_leaf_pair *p, const sc_leaf_ready *a,
                     const sc_leaf_ready *b, unsigned some, leaf_rows *rows)
{
    name_pair(p->a, p->b, a, b, rows);
    rows->list[rows->pairs] = p->list;
    if (p->shares && !p->list) {
        take_shared(state, p, a, b, some, rows);
    } else {
        add_waiting(some, rows);
        if (p->list && p->wanted) {
            take_listed(state, p, &rows->open);
            sc_candidates_make_room(state);
        }
    }
    state->stats.counts[sc_state_box_task(state)] += sc_bits_count(some);
    rows->pairs++;
}

/* The triangles of a leaf cluster that is ready whose boxes overlap that of leaf b. */
static inline unsigned rows_at(const sc_query_state *state, const sc_leaf_ready *ready, uint32_t b)
{
    const sc_boxes *boxes = &state->workspace->patch_boxes;
    uint64_t i = (uint64_t)sc_model_first_leaf_patch(state->model) + b;
    lanes_mask m[3];
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++)
        m[k] = lanes_both(
            lanes_not_above(lanes_all(boxes->side[k][i]), lanes_load(ready->side[k + 3])),
            lanes_not_above(lanes_load(ready->side[k]), lanes_all(boxes->side[k + 3][i])));
    return lanes_bits(lanes_both(m[0], lanes_both(m[1], m[2])));
}

/* Whether the place of a leaf cluster is that of another one that the rows are of. */
static inline unsigned is_taken(const sc_query_state *state, uint32_t leaf, int is_upper,
                                const leaf_rows *rows)
{
    const sc_workspace *w = state->workspace;
    const sc_leaf_known *known = w->known + ready_place(state, leaf, is_upper);
    unsigned taken = 0, k;
    if (known->leaf == leaf || known->tick != w->pose_tick) return 0;
    for (k = 0; k < rows->pairs; k++)
        taken |= (unsigned)(rows->leaf[0][k] == known->leaf) |
                 (unsigned)(rows->leaf[1][k] == known->leaf);
    return taken;
}

static void leaf_pair(sc_query_state *state, uint32_t a, uint32_t b, int by_slabs, uint32_t shared,
                      leaf_rows *rows);

/* Two leaf clusters that have one place: they are made ready elsewhere. */
static void leaf_pair_elsewhere(sc_query_state *state, uint32_t a, uint32_t b, int by_slabs,
                                uint32_t shared, leaf_rows *rows)
{
    sc_workspace *w = state->workspace;
    sc_leaf_ready *ready = w->ready;
    sc_leaf_known *known = w->known;
    const uint32_t mask = w->ready_mask;
    test_rows(state, rows);
    sc_workspace_keep_some(state->model, w);
    leaf_pair(state, a, b, by_slabs, shared, rows);
    test_rows(state, rows);
    w->ready = ready;
    w->known = known;
    w->ready_mask = mask;
    w->ready_upper = 0;
}

/* Two leaf clusters, a <= b; by_slabs: slabs may tell them apart, and were not looked at; shared as
   sc_candidates_enter has it. What is made ready may take the place of a leaf cluster that the rows
   are of, so these are tested before. */
static void leaf_pair(sc_query_state *state, uint32_t a, uint32_t b, int by_slabs, uint32_t shared,
                      leaf_rows *rows)
{
    const sc_leaf_ready *ready_a, *ready_b;
    sc_leaf_pair p;
    unsigned some;
    if (rows->pairs == SC_ROWS_PAIRS) test_rows(state, rows);
    if (state->workspace->ready_mask != SC_KEEPS_ALL &&
        !(is_ready(state, a, 0) & is_ready(state, b, b > a))) {
        if (a != b && ready_place(state, a, 0) == ready_place(state, b, 1)) {
            leaf_pair_elsewhere(state, a, b, by_slabs, shared, rows);
            return;
        }
        if (is_taken(state, a, 0, rows) | is_taken(state, b, b > a, rows)) test_rows(state, rows);
    }
    ready_a = ready_b = ready_leaf(state, a, 0);
    if (a == b) {
        const uint32_t *first = sc_model_leaf_first(state->model) + a;
        some = (1u << (first[1] - first[0] - 1)) - 1u;
    } else {
        some = rows_at(state, ready_a, b);
        if (!some) return;
        ready_b = ready_leaf(state, b, 1);
        if (by_slabs && slabs_part(state, a, b)) return;
    }
    sc_candidates_enter(state, a, b, shared, &p);
    add_rows(state, &p, ready_a, ready_b, some, rows);
}

/* Two leaf clusters, a < b, that share no points or are crowded, and that slabs do not part. Those
   that are ready are added without branches, as boxes of triangles may be apart from the other in
   many. */
static inline void far_pair(sc_query_state *state, uint32_t a, uint32_t b, leaf_rows *rows)
{
    const sc_workspace *w = state->workspace;
    const uint8_t *crowded = sc_model_share_crowded(state->model);
    const sc_leaf_ready *ready_a = w->ready + ready_place(state, a, 0);
    const sc_leaf_ready *ready_b = w->ready + ready_place(state, b, 1);
    unsigned count;
    if ((crowded[a] & crowded[b]) | !(is_ready(state, a, 0) & is_ready(state, b, 1))) {
        leaf_pair(state, a, b, 0, SC_NONE, rows);
        return;
    }
    if (rows->pairs == SC_ROWS_PAIRS) test_rows(state, rows);
    name_pair(a, b, ready_a, ready_b, rows);
    count = add_waiting(rows_at(state, ready_a, b), rows);
    rows->pairs += count != 0;
    state->stats.counts[sc_state_box_task(state)] += count;
}

/* Asks for the memory of a leaf cluster that is made ready; or of its slab and points, and the
   former if there is no slab yet. */
static inline void fetch_ready(const sc_workspace *w, uint32_t leaf)
{
    const float *at = w->ready[leaf & w->ready_mask].side[0];
    int k;
    for (k = 0; k < SC_READY_ROWS; k++) sc_fetch(at + SC_LEAF_MAX * k);
}

static inline void fetch_points(const sc_workspace *w, uint32_t leaf)
{
    const float *at = w->point_at + 4 * SC_LEAF_POINTS * (uint64_t)leaf;
    int k;
    for (k = 0; k < 4; k++) sc_fetch(at + SC_LEAF_POINTS * k);
    if (w->slab[leaf].tick != w->pose_tick) fetch_ready(w, leaf);
}

/* The pairs of leaf clusters that wait and share no points, or are crowded. If they are many, slabs
   drop most of those that hold no pair of triangles; some pairs ahead, memory is asked for. If they
   are few, it does not pay to make slabs before boxes meet. */
static void far_pairs(sc_query_state *state, leaf_rows *rows)
{
    sc_workspace *w = state->workspace;
    uint32_t *lower = w->far_pairs[0], *upper = w->far_pairs[1];
    uint32_t count = w->far_count, kept = 0, i;
    int slabs_first = count >= SC_LEAF_SLABS_FIRST;
    w->far_count = 0;
    if (slabs_first) {
        if (w->ready_mask != SC_KEEPS_ALL) /* as in leaf_pair */
            test_rows(state, rows);
        for (i = 0; i < count; i++) {
            uint32_t a = lower[i], b = upper[i];
            if (i + SC_MADE_LEAVES < count) {
                sc_fetch(w->slab + lower[i + SC_MADE_LEAVES]);
                sc_fetch(w->slab + upper[i + SC_MADE_LEAVES]);
            }
            if (i % SC_MADE_LEAVES == 0 && w->ready_mask == SC_KEEPS_ALL) {
                const uint32_t some = count - i < SC_MADE_LEAVES ? count - i : SC_MADE_LEAVES;
                make_slabs(state, lower + i, some);
                make_slabs(state, upper + i, some);
            }
            if (i + SC_FETCH_POINTS < count) fetch_points(w, upper[i + SC_FETCH_POINTS]);
            lower[kept] = a;
            upper[kept] = b;
            kept += !slabs_part(state, a, b);
        }
        count = kept;
    }
    for (i = 0; i < count && !state->stop; i++) {
        if (i + SC_FETCH_READY < count) {
            fetch_ready(w, lower[i + SC_FETCH_READY]);
            fetch_ready(w, upper[i + SC_FETCH_READY]);
        }
        if (slabs_first)
            far_pair(state, lower[i], upper[i], rows);
        else
            leaf_pair(state, lower[i], upper[i], 1, SC_NONE, rows);
        if (i % SC_LEAF_PAIRS_UNASKED == 0) sc_state_stops(state);
    }
}

/* Whether normal cones are of this query. */
static inline int leaves_have_cones(const sc_query_state *state)
{
    return state->options.method == SC_METHOD_SCTT && state->options.contour == SC_CONTOUR_EXACT;
}

/* Takes the pairs of leaf clusters that share points from the list of what waits, and leaf clusters
   against themselves, and drops what some tests can tell; returns how many are left, and has asked
   for what tells whether they are ready, and where their lists begin. In steps with few branches,
   as any pair may be one of a kind. */
static SC_NOINLINE uint32_t take_near_list(sc_query_state *state)
{
    const uint32_t *leaf = sc_model_share_leaf(state->model);
    const uint32_t *begin = sc_model_share_begin(state->model);
    const uint16_t *touch = sc_model_share_touch(state->model);
    sc_workspace *w = state->workspace;
    sc_near_pair *pairs = w->near_pairs;
    const int has_cones = leaves_have_cones(state);
    uint32_t *touching = w->near_list[0]; /* what has been read of it makes room */
    uint32_t count = w->near_count, touch_count = 0, known = 0, kept = 0, i;
    w->near_count = 0;
    for (i = 0; i < count; i++) {
        const uint32_t a = w->near_list[0][i], shared = w->near_list[1][i];
        pairs[i].a = pairs[i].b = a;
        pairs[i].shared = shared;
        if (shared != SC_NONE) {
            pairs[i].b = leaf[shared];
            pairs[i].known = touch[shared];
        } else {
            pairs[i].known = has_two_chains(state->model, a) ? SC_TOUCH_CHAIN : 0;
        }
        touching[touch_count] = i;
        touch_count += (pairs[i].known & SC_TOUCHES) != 0;
        known |= pairs[i].known;
    }
    if (touch_count) drop_touching(state, touching, touch_count);
    if (known & SC_TOUCH_CHAIN) drop_bands(state, count);
    if (has_cones) drop_plain(state, count);
    for (i = 0; i < count; i++) {
        const sc_near_pair p = pairs[i];
        unsigned drops = p.known & SC_NEAR_DROPPED;
        if (p.a == p.b && has_cones) drops |= (unsigned)is_plain(state, p.a);
        sc_fetch(w->known + (p.a & w->ready_mask));
        sc_fetch(w->known + (p.b & w->ready_mask));
        sc_fetch(begin + (p.a == p.b ? 0 : p.shared));
        pairs[kept] = p;
        kept += !drops;
    }
    return kept;
}

/* Those that share points, and leaf clusters against themselves. */
static void near_pairs(sc_query_state *state, leaf_rows *rows)
{
    sc_workspace *w = state->workspace;
    const sc_near_pair *pairs = w->near_pairs;
    const uint32_t count = take_near_list(state);
    const uint32_t *begin = sc_model_share_begin(state->model);
    const uint8_t *corner = sc_model_leaf_corner(state->model);
    uint32_t i;
    rows->near = 1;
    for (i = 0; i < count && !state->stop; i++) {
        if (i + SC_FETCH_READY < count) {
            const sc_near_pair *next = pairs + i + SC_FETCH_READY;
            fetch_ready(w, next->a);
            fetch_ready(w, next->b);
            sc_fetch(corner + 3 * SC_LEAF_MAX * (uint64_t)next->b);
            if (next->shared != SC_NONE) {
                const uint16_t *list = sc_model_share_list(state->model) + begin[next->shared];
                sc_fetch(list);
                sc_fetch(list + 32);
            } else {
                sc_fetch(sc_model_share_own_rows(state->model) + SC_OWN_WORDS * (uint64_t)next->a);
            }
        }
        leaf_pair(state, pairs[i].a, pairs[i].b, 0, pairs[i].shared, rows);
        if (i % SC_LEAF_PAIRS_UNASKED == 0) sc_state_stops(state);
    }
    compare_near_boxes(rows);
    rows->near = 0;
}

/* Those pairs of leaf clusters that wait; the others, too, if that is asked for. */
static void take_leaf_pairs(sc_query_state *state, int far)
{
    leaf_rows rows;
    no_rows(&rows);
    memset(&rows.open, 0, sizeof rows.open);
    near_pairs(state, &rows);
    if (far) far_pairs(state, &rows);
    test_rows(state, &rows);
    if (rows.open.count && !state->stop) settle_neighbors(state, &rows.open);
}

static void leaf_pairs(sc_query_state *state)
{
    take_leaf_pairs(state, 1);
}

/* Has those pairs wait that share points: of leaf cluster a with those numbered from first on, all
   above it, of which bits of a mask are set. Returns the rest of the mask. */
static inline unsigned add_near_pairs(sc_query_state *state, uint32_t a, uint32_t first,
                                      unsigned mask)
{
    const uint32_t *share = sc_model_share_first(state->model) + a;
    const uint32_t *leaf = sc_model_share_leaf(state->model);
    sc_workspace *w = state->workspace;
    uint32_t i;
    int k;
    if (share[1] - share[0] < 2) { /* one, as in rods, or none */
        const uint32_t at = share[0] < share[1] ? leaf[share[0]] - first : SC_LEAF_MAX;
        const unsigned bit = at < SC_LEAF_MAX ? mask & 1u << at % SC_LEAF_MAX : 0u;
        w->near_list[0][w->near_count] = a;
        w->near_list[1][w->near_count] = share[0];
        w->near_count += bit != 0;
        return mask & ~bit;
    }
    sc_fetch(sc_model_share_touch(state->model) + share[0]);
    for (i = share[0]; i < share[1]; i += SC_LANES_COUNT) {
        const unsigned some = share[1] - i < SC_LANES_COUNT ? share[1] - i : SC_LANES_COUNT;
        uint32_t *lower = w->near_list[0] + w->near_count;
        unsigned found;
        for (k = 0; k < SC_LANES_COUNT; k++) lower[k] = a;
        w->near_count += lanes_list_among(leaf + i, some, first, mask, i,
                                          w->near_list[1] + w->near_count, &found);
        mask &= ~found;
    }
    return mask;
}

/* Has pairs of a leaf cluster wait: with those numbered from first on, of which bits of a mask are
   set. They are all above it; or all below it, of pairs that the test tree leaves to boxes: then
   they share no points with it, unless both are crowded (build/neighbors.h). */
static inline void add_leaf_pairs(sc_query_state *state, uint32_t leaf, uint32_t first,
                                  unsigned mask)
{
    sc_workspace *w = state->workspace;
    int is_upper = leaf > first, i;
    uint32_t *same = w->far_pairs[is_upper] + w->far_count;
    unsigned count = sc_bits_count(mask);
    state->stats.leaf_pairs += count;
    state->stats.counts[sc_state_box_task(state)] += count;
    if (!is_upper) mask = add_near_pairs(state, leaf, first, mask);
    for (i = 0; i < SC_LANES_COUNT; i++) same[i] = leaf;
    w->far_count += lanes_list_from(mask, first, w->far_pairs[!is_upper] + w->far_count);
}

/* To be called after SC_LEAF_MAX such or fewer: sees that so many more have room. */
static inline void make_leaf_room(sc_query_state *state)
{
    const uint32_t most = sc_state_may_end_early(state) ? 16 : SC_LEAF_QUEUE - SC_LEAF_MAX - 1;
    if (state->workspace->far_count > most || state->workspace->near_count > most)
        take_leaf_pairs(state, state->workspace->far_count > most);
}

static void leaf_pair_waits(sc_query_state *state, uint32_t a, uint32_t b)
{
    add_leaf_pairs(state, a, b, 1);
    make_leaf_room(state);
}

static void leaf_itself(sc_query_state *state, uint32_t leaf)
{
    sc_walk *walk = &state->workspace->walk;
    state->stats.leaf_pairs++;
    if (leaves_have_cones(state)) {
        walk->alone[walk->alone_count++] = 2 * leaf + (uint32_t)state->after_contour;
        return;
    }
    if (is_plain(state, leaf)) return;
    state->workspace->near_list[0][state->workspace->near_count] = leaf;
    state->workspace->near_list[1][state->workspace->near_count++] = SC_NONE;
    make_leaf_room(state);
}

/*
 * Stages of a step from leaf clusters to the narrow phase. See step_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 */

/* Adds what is left of two leaf clusters, or of one, the former with the bit for what follows a
   contour test, to the rows. */
static void add_step_rows(sc_worker *w, uint32_t item, uint32_t other, const step_rows *rows)
{
    const uint32_t bit = item & SC_AFTER_CONTOUR, leaf[2] = {item & SC_ITEM, other};
    const uint32_t turned = sc_worker_is_between(w) ? SC_STEP_TURNED : 0;
    const uint32_t first[2] = {sc_model_leaf_first(w->model)[leaf[0]],
                               sc_model_leaf_first(w->second->model)[leaf[1]]};
    uint32_t *count = &w->lists.count[SC_LIST_FACE_ROWS], r, k;
    sc_moving_row *to = w->lists.moving_rows[0] + *count;
    for (r = 0; r < rows->faces; r++, to++) {
        const uint32_t of = rows->of[r];
        to->of = (first[of] + rows->face[r]) | (of ? 0 : turned);
        to->leaf = leaf[1 - of] | bit;
        to->bits = rows->points[r];
    }
    *count += rows->faces;
    count = &w->lists.count[SC_LIST_EDGE_ROWS];
    to = w->lists.moving_rows[1] + *count;
    for (r = 0; r < rows->edges; r++) {
        const uint32_t edge = rows->edge[r];
        for (k = 0; k < 3; k++) {
            to->of = 3 * (first[0] + edge % SC_LEAF_MAX) + edge / SC_LEAF_MAX;
            to->leaf = leaf[1] | bit;
            to->bits = rows->others[r][k] | k << SC_LEAF_MAX;
            to += rows->others[r][k] != 0;
        }
    }
    *count = (uint32_t)(to - w->lists.moving_rows[1]);
}

/* Whether there is room for what two leaf clusters add. */
static inline int have_room_for_rows(const sc_worker *w)
{
    return w->lists.count[SC_LIST_FACE_ROWS] < SC_MOVING_ROWS_ENOUGH &&
           w->lists.count[SC_LIST_EDGE_ROWS] < SC_MOVING_ROWS_ENOUGH;
}

/* Vertices, edges and triangles of pairs of leaf clusters, by slabs and boxes that move. */
static void compare_moving_clusters(sc_worker *w, uint32_t most)
{
    uint32_t *left = &w->lists.count[SC_LIST_CLUSTERS];
    step_rows rows;
    for (; most && *left && have_room_for_rows(w); most--) {
        const sc_cluster_pair p = w->lists.clusters[--*left];
        const sc_leaf_motion *a = leaf_motion(w, p.a), *b = other_motion(w, p.a, p.b);
        sc_worker_count_boxes(w, sc_item_follows(p.known), find_rows(w, a, b, &rows));
        add_step_rows(w, p.a | p.known, p.b, &rows);
    }
}

/* The same of leaf clusters by themselves. */
static void compare_moving_leaves(sc_worker *w, uint32_t most)
{
    uint32_t *left = &w->lists.count[SC_LIST_NEAR];
    step_rows rows;
    for (; most && *left && have_room_for_rows(w); most--) {
        const uint32_t item = w->lists.near[0][--*left], leaf = item & SC_ITEM;
        sc_worker_count_boxes(w, sc_item_follows(item),
                              find_own_rows(w, leaf_motion(w, leaf), &rows));
        add_step_rows(w, item, leaf, &rows);
    }
}

/* The same of leaf clusters of two objects. */
static void compare_moving_between(sc_worker *w, uint32_t most)
{
    uint32_t *left = &w->lists.count[SC_LIST_CLUSTERS];
    step_rows rows;
    for (; most && *left && have_room_for_rows(w); most--) {
        const sc_cluster_pair p = w->lists.clusters[--*left];
        const sc_leaf_motion *a = leaf_motion(w, p.a), *b = leaf_motion(w->second, p.b);
        sc_worker_count_boxes(w, sc_item_follows(p.known), find_rows(w, a, b, &rows));
        add_step_rows(w, p.a | p.known, p.b, &rows);
    }
}

/* Lists the pairs of a row; returns how many. Between two objects a row of edges is one of the
   first with some of the second; one of faces, of either with vertices of the other, says so. */
static uint32_t list_moving_row(const sc_worker *w, const sc_moving_row *row, int kind, sc_pair *to)
{
    const int faces = kind == SC_STEP_VERTEX_FACE;
    const uint32_t turned = faces ? row->of & SC_STEP_TURNED : 0;
    const sc_model *model = faces && !turned ? w->model : w->second->model;
    const uint32_t leaf = row->leaf & SC_ITEM, first = sc_model_leaf_first(model)[leaf];
    const uint32_t *point = sc_model_leaf_point(model) + SC_LEAF_POINTS * (uint64_t)leaf;
    uint32_t bits = row->bits & ((1u << SC_LEAF_MAX) - 1u), count = 0;
    for (; bits; bits &= bits - 1, count++) {
        const uint32_t i = sc_bits_lowest(bits);
        if (kind == SC_STEP_VERTEX_FACE) {
            to[count].a = point[i] | turned;
            to[count].b = row->of & ~turned;
        } else {
            to[count].a = row->of;
            to[count].b = 3 * (first + i) + (row->bits >> SC_LEAF_MAX);
        }
    }
    return count;
}

/* The points of up to sixteen pairs; the last one fills them up. */
static void read_moving_pairs(const sc_worker *w, const sc_pair *pairs, uint32_t count, int kind,
                              sc_candidate_points *to)
{
    const uint32_t of_first = sc_step_points_of_first(kind);
    uint32_t i, k, point[4];
    for (i = 0; i < SC_LANES_COUNT; i++) {
        const sc_pair *pair = &pairs[i < count ? i : count - 1];
        const sc_pair_sides sides = sc_step_candidates_sides(w, kind, pair);
        sc_step_candidates_points(w, kind, pair, point);
        for (k = 0; k < 4; k++) {
            const sc_frame *frame = (k < of_first ? sides.a : sides.b)->frame;
            to->unit[k][i] = frame->motion.unit + 8 * (uint64_t)point[k];
        }
    }
}

/* Pairs of some rows: if collisions are wanted, those that do not stay apart along a direction,
   sixteen at a time. */
static void list_moving(sc_worker *w, uint32_t most, int kind)
{
    const int part = w->step->question->options.pairs == SC_STEP_COLLISIONS;
    sc_lists *l = &w->lists;
    uint32_t *left = &l->count[SC_LIST_FACE_ROWS + kind], *kept = &l->count[SC_LIST_FACES + kind];
    sc_pair pairs[SC_MOVING_LISTED + SC_LEAF_MAX];
    uint32_t count = 0, follow = 0, i;
    for (; most && *left && count < SC_MOVING_LISTED; most--) {
        const sc_moving_row *row = &l->moving_rows[kind][--*left];
        const uint32_t some = list_moving_row(w, row, kind, pairs + count);
        count += some;
        follow += sc_item_follows(row->leaf) * some;
    }
    sc_worker_count_primitives(w, 0, count - follow);
    sc_worker_count_primitives(w, 1, follow);
    for (i = 0; i < count; i += SC_LANES_COUNT) {
        const uint32_t some = count - i < SC_LANES_COUNT ? count - i : SC_LANES_COUNT;
        unsigned mask = (1u << some) - 1u;
        sc_candidate_points points;
        read_moving_pairs(w, pairs + i, some, kind, &points);
        if (part)
            mask &=
                ~stay_apart(w->frame->motion.distance, &points, (int)sc_step_points_of_first(kind));
        for (; mask; mask &= mask - 1) l->moving[kind][(*kept)++] = pairs[i + sc_bits_lowest(mask)];
    }
}

static void list_faces(sc_worker *w, uint32_t most)
{
    list_moving(w, most, SC_STEP_VERTEX_FACE);
}

static void list_edges(sc_worker *w, uint32_t most)
{
    list_moving(w, most, SC_STEP_EDGE_EDGE);
}

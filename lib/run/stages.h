/*
 * The stages of a query, of a step and of a search for what is near, in the order of their lists.
 *
 * SPDX-License-Identifier: MIT
 *
 * A stage takes so many of the last items of its list (query/lists.h), or fewer where the next list
 * might not have room for what one more adds, but one at least. It reads the model and the frame,
 * classifies what it can, adds the rest to lists behind its own, and calls no other stage.
 *
 * Stages whose inner loops are compiled for each instruction set make this a table for each of
 * them: simd/all_kernels.h includes it, and nothing else.
 */
static sc_stage *const query_stages[SC_LIST_COUNT] = {
    /* nodes of the test tree: the paper's boxes and star test, the exact contour test */
    [SC_LIST_SPANS] = sc_culling_take_spans,
    [SC_LIST_STARS] = sc_culling_take_stars,
    [SC_LIST_FAILED] = sc_culling_open,
    [SC_LIST_ORIENTED] = sc_culling_test,
    /* the broad phase: pairs of patches, down to leaf clusters */
    [SC_LIST_LEFT] = leave_patch_pairs,
    [SC_LIST_PATCHES] = open_patch_pairs,
    [SC_LIST_ROWS] = list_rows,
    /* pairs of leaf clusters: proofs, then boxes and planes of their triangles */
    [SC_LIST_FAR] = part_far,
    [SC_LIST_NEAR] = part_near,
    [SC_LIST_CLUSTERS] = compare_clusters,
    [SC_LIST_TRIANGLES] = compare_triangles,
    [SC_LIST_OPEN] = classify_open,
    /* the narrow phase: eight pairs of triangles in doubles, then exact signs */
    [SC_LIST_CANDIDATES] = sc_decide_candidates,
    [SC_LIST_NEIGHBORS] = sc_decide_neighbors,
    [SC_LIST_EXACT] = sc_decide_exactly,
};

/* Two objects: from a pair of roots on, what is far from each other in one. */
static sc_stage *const between_stages[SC_LIST_COUNT] = {
    [SC_LIST_PATCHES] = open_between,
    [SC_LIST_FAR] = part_far,
    [SC_LIST_CLUSTERS] = compare_clusters,
    [SC_LIST_TRIANGLES] = compare_triangles,
    [SC_LIST_CANDIDATES] = sc_decide_candidates,
    [SC_LIST_EXACT] = sc_decide_exactly,
};

/* The same in a step, and for what is near: of boxes that move, or stay where they are. */
static sc_stage *const step_between_stages[SC_LIST_COUNT] = {
    [SC_LIST_PATCHES] = open_moving_between,
    [SC_LIST_CLUSTERS] = compare_moving_between,
    [SC_LIST_FACE_ROWS] = list_faces,
    [SC_LIST_EDGE_ROWS] = list_edges,
    [SC_LIST_FACES] = sc_step_candidates_take_faces,
    [SC_LIST_EDGES] = sc_step_candidates_take_edges,
};

static sc_stage *const near_between_stages[SC_LIST_COUNT] = {
    [SC_LIST_PATCHES] = open_moving_between,
    [SC_LIST_CLUSTERS] = decide_near_between,
    [SC_LIST_FACES] = take_near_open_faces,
    [SC_LIST_EDGES] = take_near_open_edges,
};

static sc_stage *const step_stages[SC_LIST_COUNT] = {
    [SC_LIST_FAILED] = sc_culling_open,
    [SC_LIST_ORIENTED] = sc_culling_test,
    /* the broad phase, of boxes that move */
    [SC_LIST_LEFT] = leave_moving_pairs,
    [SC_LIST_PATCHES] = open_moving_pairs,
    [SC_LIST_ROWS] = list_moving_rows,
    /* leaf clusters by themselves and in pairs: slabs and boxes that move */
    [SC_LIST_NEAR] = compare_moving_leaves,
    [SC_LIST_CLUSTERS] = compare_moving_clusters,
    /* the narrow phase: sixteen pairs along a direction, then times of impact */
    [SC_LIST_FACE_ROWS] = list_faces,
    [SC_LIST_EDGE_ROWS] = list_edges,
    [SC_LIST_FACES] = sc_step_candidates_take_faces,
    [SC_LIST_EDGES] = sc_step_candidates_take_edges,
};

static sc_stage *const near_stages[SC_LIST_COUNT] = {
    [SC_LIST_FAILED] = sc_culling_open,
    [SC_LIST_ORIENTED] = sc_culling_test,
    /* the broad phase, of a step that stays where it is */
    [SC_LIST_LEFT] = leave_moving_pairs,
    [SC_LIST_PATCHES] = open_moving_pairs,
    [SC_LIST_ROWS] = list_moving_rows,
    /* leaf clusters by themselves and in pairs: boxes, slabs, distances sixteen at a time */
    [SC_LIST_NEAR] = decide_near_alone,
    [SC_LIST_CLUSTERS] = decide_near_clusters,
    /* what rounding leaves open, by exact signs */
    [SC_LIST_FACES] = take_near_open_faces,
    [SC_LIST_EDGES] = take_near_open_edges,
};

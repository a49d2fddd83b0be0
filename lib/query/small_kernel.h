/*
 * The exact contour test of small contours. See query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Most contours have few edges and are simple. Here some are looked at together that have as many
 * sixteens of edges, b of them, each step for all before the next: what was just written is read
 * slowly in other pieces. What is left open goes through query/simple_kernel.h.
 *
 * A loop in one piece of n edges is simple if each is apart from those 2 to n / 2 places on. None
 * folds back on the next then: one of the two would have the other's far end on it, where a third
 * begins or ends. n / 2 is no more than 8 b. Those 2 to 8 b - 1 on are always compared, some pairs
 * twice; that is at most n - 2, so that none of them follow each other: n is more than 16 (b - 1),
 * and 9 or more (SC_SMALL_EDGES) if b is 1. Contours of fewer edges are left open at once.
 *
 * Boxes tell most edges apart, in cells. A coordinate times 126 / s, s being size or 512 error,
 * whichever is larger, is at most 126.01 and off by 2^-18, then rounded and moved by 128: to 2 to
 * 254, off by 0.5 + 2^-18. If a cell is free between two boxes, numbers differ by 2, and
 * coordinates by 0.999 s / 126 or more: by more than 4 errors, as boxes are to be. Of other pairs
 * one edge has to be on one side of the other's line.
 */
enum {
    SMALL_POINTS = (SC_SMALL_BLOCKS + 1) * SC_LANES_COUNT,
    SMALL_REACHES = (SC_SMALL_BLOCKS + SC_SMALL_BLOCKS / 2) * SC_LANES_COUNT
};

/* A contour in the plane: its points and their cells, of which the first follow the last again; the
   boxes of its edges, and their reaches, of which those of the first edges follow again. */
typedef struct small_contour {
    lanes aligned;
    float at[2][SMALL_POINTS];
    uint32_t cell[SMALL_POINTS]; /* until it is projected, where its points are */
    uint32_t box[SMALL_POINTS];
    uint32_t reach[SMALL_REACHES];
    float error, size; /* of a coordinate */
    uint32_t count;
} small_contour;

/* The transposed places of a loop's points, and beyond its end the first again. What is read there
   stands in the model, too. */
static SC_INLINE void place_small(const sc_model *model, uint32_t node, uint32_t blocks,
                                  small_contour *c)
{
    const uint32_t *leaf = sc_model_leaf(model);
    const sc_node *n = sc_model_node(model) + node;
    const uint16_t *loop = sc_model_loop(model) + n->loop;
    const uint32_t first = SC_LEAF_POINTS * leaf[n->patches.a];
    const uint32_t split = SC_LEAF_POINTS * leaf[n->patches.a + 1] - first;
    const uint32_t second = SC_LEAF_POINTS * leaf[n->patches.b] - split;
    uint32_t b;
    SC_UNROLL
    for (b = 0; b < blocks; b++)
        lanes_numbers(c->cell + SC_LANES_COUNT * b, loop + SC_LANES_COUNT * b, split, first,
                      second);
    c->count = n->loop_length;
    memmove(c->cell + c->count, c->cell, /* overlaps if there are fewer */
            SC_LANES_COUNT * sizeof *c->cell);
}

/* Projects a contour, as project in simple_kernel.h does. The numbers of its axes are
   SC_DNC_VECTORS floats apart, as in sc_simple_some_axes. */
static SC_INLINE void see_small(const sc_worker *w, uint32_t blocks, const float *axes,
                                small_contour *c)
{
    const float *at = w->frame->point_at, *one, *other;
    lanes from[3], axis[2][3], d[3], x[2], size = lanes_all(0), flat_size = lanes_all(0);
    uint32_t b;
    int k, m;
    one = at + 4 * (uint64_t)c->cell[0];
    other = at + 4 * (uint64_t)c->cell[c->count / 2];
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        from[k] = lanes_all(one[k] / 2 + other[k] / 2);
        SC_UNROLL
        for (m = 0; m < 2; m++) axis[m][k] = lanes_all(axes[SC_DNC_VECTORS * (3 * m + k)]);
    }
    SC_UNROLL
    for (b = 0; b < blocks; b++) {
        lanes_rows(at, c->cell + SC_LANES_COUNT * b, &d[0], &d[1], &d[2]);
        SC_UNROLL
        for (k = 0; k < 3; k++) {
            d[k] = lanes_subtract(d[k], from[k]);
            size = lanes_larger(size, lanes_absolute(d[k]));
        }
        SC_UNROLL
        for (m = 0; m < 2; m++) {
            x[m] = lanes_add(lanes_multiply(axis[m][0], d[0]), lanes_multiply(axis[m][1], d[1]));
            x[m] = lanes_add(x[m], lanes_multiply(axis[m][2], d[2]));
            lanes_store(c->at[m] + SC_LANES_COUNT * b, x[m]);
        }
        flat_size = lanes_largest_size(flat_size, x[0], x[1]);
    }
    c->error = sc_bounds_contour(lanes_most(size));
    c->size = lanes_most(flat_size);
}

/* The cells of the points. */
static SC_INLINE void find_cells(small_contour *c, uint32_t blocks)
{
    const float least = 512 * c->error;
    const lanes scale = lanes_all(126 / (c->size > least ? c->size : least));
    const lanes middle = lanes_all(8388608.0f + 128); /* 2^23: beyond it are only whole numbers */
    uint32_t b;
    int k;
    SC_UNROLL
    for (b = 0; b < blocks; b++) {
        lanes x[2];
        SC_UNROLL
        for (k = 0; k < 2; k++) {
            x[k] = lanes_multiply(lanes_load(c->at[k] + SC_LANES_COUNT * b), scale);
            x[k] = lanes_add(x[k], middle);
        }
        lanes_cells_store(c->cell + SC_LANES_COUNT * b, lanes_cells_of(x[0], x[1]));
    }
    SC_UNROLL
    for (k = 0; k < 2; k++) {
        c->at[k][SC_LANES_COUNT * blocks] = 0; /* is read, and nothing depends on it */
        c->at[k][c->count] = c->at[k][0];
    }
    c->cell[c->count] = c->cell[0];
}

/* The boxes of the edges, and their reaches. */
static SC_INLINE void find_boxes(small_contour *c, uint32_t blocks)
{
    lanes_cells reach[SC_SMALL_BLOCKS];
    uint32_t b;
    SC_UNROLL
    for (b = 0; b < blocks; b++) {
        const uint32_t *cell = c->cell + SC_LANES_COUNT * b;
        lanes_cells box = lanes_cells_joined(lanes_cells_load(cell), lanes_cells_load(cell + 1));
        reach[b] = lanes_cells_reach(box);
        lanes_cells_store(c->box + SC_LANES_COUNT * b, box);
        lanes_cells_store(c->reach + SC_LANES_COUNT * b, reach[b]);
    }
    SC_UNROLL
    for (b = 0; 2 * b < blocks; b++)
        lanes_cells_store(c->reach + c->count + SC_LANES_COUNT * b, reach[b]);
}

/* Bits of edges of which boxes overlap those of edges further on. What is read behind the last
   reach is compared with what is no edge. */
static SC_INLINE uint64_t find_overlaps(const small_contour *c, uint32_t blocks)
{
    const uint32_t most = blocks * (SC_LANES_COUNT / 2);
    uint64_t overlaps = 0;
    uint32_t b, on;
    SC_UNROLL
    for (b = 0; b < blocks; b++) {
        const uint32_t *reach = c->reach + SC_LANES_COUNT * b;
        const lanes_cells box = lanes_cells_load(c->box + SC_LANES_COUNT * b);
        lanes_cells noted = lanes_cells_none(), last;
        unsigned some;
        SC_UNROLL
        for (on = 2; on < most; on++)
            noted = lanes_cells_note(noted, box, lanes_cells_load(reach + on));
        last = lanes_cells_note(lanes_cells_none(), box, lanes_cells_load(reach + most));
        some = lanes_cells_noted(noted) | (c->count == 2 * most ? lanes_cells_noted(last) : 0);
        some &= first_lanes(c->count - SC_LANES_COUNT * b);
        overlaps |= (uint64_t)some << SC_LANES_COUNT * b;
    }
    return overlaps;
}

/* Whether an edge is certainly apart from all but those before and behind it. */
static int is_edge_apart(const small_contour *c, uint32_t edge)
{
    const lanes_cells reach = lanes_cells_all(c->reach[edge]);
    const uint32_t last = c->count - 1;
    const uint64_t next = (uint64_t)1 << edge | (uint64_t)1 << (edge == last ? 0 : edge + 1) |
                          (uint64_t)1 << (edge ? edge - 1 : last);
    edge_lanes own, other;
    uint32_t i;
    int k;
    SC_UNROLL
    for (k = 0; k < 2; k++) {
        own.p[k] = lanes_all(c->at[k][edge]);
        own.q[k] = lanes_all(c->at[k][edge + 1]);
    }
    for (i = 0; i < c->count; i += SC_LANES_COUNT) {
        unsigned some = lanes_cells_noted(
            lanes_cells_note(lanes_cells_none(), lanes_cells_load(c->box + i), reach));
        some &= first_lanes(c->count - i) & ~(unsigned)(next >> i);
        if (!some) continue;
        SC_UNROLL
        for (k = 0; k < 2; k++) {
            other.p[k] = lanes_load(c->at[k] + i);
            other.q[k] = lanes_load(c->at[k] + i + 1);
        }
        if (some & ~lie_apart(c->error, &own, &other)) return 0;
    }
    return 1;
}

/* Bits of contours that are certainly simple, some of so many sixteens of edges. */
static SC_INLINE unsigned find_simple_of(sc_worker *w, const uint32_t *nodes, uint32_t count,
                                         uint32_t blocks, const float *const axes[])
{
    small_contour all[SC_DNC_VECTORS];
    unsigned simple = (1u << count) - 1u, i;
    sc_worker_switch(w, SC_TASK_UPDATE_CONTOURS);
    for (i = 0; i < count; i++) place_small(w->model, nodes[i], blocks, &all[i]);
    for (i = 0; i < count; i++) see_small(w, blocks, axes[i], &all[i]);
    sc_worker_switch(w, SC_TASK_CONTOUR);
    for (i = 0; i < count; i++) find_cells(&all[i], blocks);
    for (i = 0; i < count; i++) find_boxes(&all[i], blocks);
    for (i = 0; i < count; i++) {
        uint64_t some = find_overlaps(&all[i], blocks);
        for (; some; some &= some - 1)
            if (!is_edge_apart(&all[i], sc_bits_lowest64(some))) simple &= ~(1u << i);
    }
    return simple;
}

/* Compiled anew for each number of sixteens. */
static unsigned find_simple(sc_worker *w, const uint32_t *nodes, uint32_t count, uint32_t blocks,
                            const float *const axes[])
{
    if (blocks == 1) return find_simple_of(w, nodes, count, 1, axes);
    if (blocks == 2) return find_simple_of(w, nodes, count, 2, axes);
    if (blocks == 3) return find_simple_of(w, nodes, count, 3, axes);
    return find_simple_of(w, nodes, count, 4, axes);
}

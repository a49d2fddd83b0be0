/*
 * Whether two leaf clusters that share points have nothing in common but what they share, by the
 * contour of both: whether that is simple, all of its edges against all, sixteen at a time. See
 * query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * If all triangles of both face a direction, as their normal cones tell, so many are over a place
 * as the contour winds round it; and if that is one loop that is simple, they meet in no more than
 * points and edges that they share: see query/simple.h. This is so of any triangles, hence some may
 * be added that are not there: where the contour turns in at a point, the triangle of that and of
 * those before and behind it. Without the point, the contour is that of all. So such points are
 * dropped, of those that follow each other the first; most contours of two leaf clusters have
 * sixteen points or fewer then.
 *
 * A loop is simple if of each two edges that do not follow each other one is on one side of the
 * line of the other; or, where both lie in a straight row, as in a regular grid, ahead of the other
 * or behind it: on one side of the line across it at one of its ends. None folds back on the next
 * then: one of the two would have the other's far end on it, where a third begins or ends; and one
 * of three edges has an area, as all triangles have.
 *
 * The projection is as in query/simple.c: a coordinate is at most 1.01 D, where D is the largest
 * component of any point of the clusters relative to the middle, and off by d = error >= 4.1 v D, v
 * = 2^-24. Let e lead from point p to the next. On which side of its line a point q is tells e x q,
 * compared with e x p. Moving points changes e x (q - p) by 2 d (|e|1 + |q - p|1) + 8 d^2; by
 * rounding, e is off by v |e|1 times what it is multiplied with, and either product by 3.01 v |e|1
 * 1.01 D; to add a bound to one takes v (1.02 |e|1 D + bound). As |q - p|1 <= 4.04 D, all is below
 * d (4 |e|1 + 8.1 D + 8.1 d); what underflows is within a few FLT_MIN. All of this holds of e . q,
 * too, compared with e at its ends: its two products have the same factors. There twice the bound
 * is added, of which the second half is more than what rounding takes from it.
 */

/* Points of a contour that is looked at, at most; edges of one of which all are compared; pairs of
   clusters at a time. */
enum {
    SHORT_POINTS = 2 * SC_LANES_COUNT - 3,
    SHORT_EDGES = SC_LANES_COUNT,
    SHORT_PAIRS = SC_DNC_VECTORS
};

/* A contour in the plane: its points, of which the first follow the last again. */
typedef struct short_points {
    float x[3 * SC_LANES_COUNT], y[3 * SC_LANES_COUNT];
    float error, reach; /* of a coordinate; D */
    unsigned count;
} short_points;

/* Where its edges lead, and for which e x q a point may be on their line, between which numbers. */
typedef struct short_edges {
    float x[2 * SC_LANES_COUNT], y[2 * SC_LANES_COUNT];
    float from[2 * SC_LANES_COUNT], to[2 * SC_LANES_COUNT];
} short_edges;

/* Sixteen of those. */
typedef struct edges_at {
    lanes x, y, from, to;
} edges_at;

static SC_INLINE edges_at find_edges(const short_points *c, unsigned first)
{
    const lanes x = lanes_load(c->x + first), y = lanes_load(c->y + first);
    const lanes least = lanes_all(c->error * (8.2f * c->reach + 8.2f * c->error) + 16 * FLT_MIN);
    edges_at e;
    lanes at, bound;
    e.x = lanes_subtract(lanes_load(c->x + first + 1), x);
    e.y = lanes_subtract(lanes_load(c->y + first + 1), y);
    at = lanes_subtract(lanes_multiply(e.x, y), lanes_multiply(e.y, x));
    bound = lanes_multiply(lanes_add(lanes_absolute(e.x), lanes_absolute(e.y)),
                           lanes_all(4.1f * c->error));
    bound = lanes_add(bound, least);
    e.from = lanes_subtract(at, bound);
    e.to = lanes_add(at, bound);
    return e;
}

/* Where points are: e x q. */
static inline lanes place_of(lanes e_x, lanes e_y, lanes q_x, lanes q_y)
{
    return lanes_subtract(lanes_multiply(e_x, q_y), lanes_multiply(e_y, q_x));
}

/* How far along the edges: e . q. */
static inline lanes place_along(lanes e_x, lanes e_y, lanes q_x, lanes q_y)
{
    return lanes_add(lanes_multiply(e_x, q_x), lanes_multiply(e_y, q_y));
}

/* Lets the first sixteen of a row follow so many. */
static inline void repeat(float *row, unsigned count)
{
    lanes_store(row + count, lanes_load(row));
}

/* Sixteen points along one of the two axes of a projection. */
static inline lanes measure(const sc_simple_some_axes *axes, int one, unsigned projection,
                            const lanes d[3])
{
    lanes sum = lanes_multiply(lanes_all(axes->at[one][0][projection]), d[0]);
    sum = lanes_add(sum, lanes_multiply(lanes_all(axes->at[one][1][projection]), d[1]));
    return lanes_add(sum, lanes_multiply(lanes_all(axes->at[one][2][projection]), d[2]));
}

/* Sees a loop of c->count points of two leaf clusters, a < b. What is read beyond its end stands in
   the model, too. */
static inline void see_loop(const sc_worker *w, const sc_cluster_pair *p,
                            const sc_simple_some_axes *axes, unsigned projection,
                            const uint16_t *loop, short_points *c)
{
    const float *of_a = w->frame->point_at + 4 * SC_LEAF_POINTS * (uint64_t)p->a;
    const float *of_b = w->frame->point_at + 4 * SC_LEAF_POINTS * (uint64_t)p->b;
    lanes at[2][3], size = lanes_all(0), x[2], y[2];
    uint8_t number[2 * SC_LANES_COUNT];
    int i, k;
    for (i = 0; i < 2 * SC_LANES_COUNT; i++)
        number[i] = (uint8_t)((loop[i] & 16) | (loop[i] & 3) << 2 | (loop[i] >> 2 & 3));
    lanes_coordinates(of_a, at[0]);
    lanes_coordinates(of_b, at[1]);
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        const lanes middle = lanes_all(of_a[k] / 2 + of_b[k] / 2); /* of one point of each */
        SC_UNROLL
        for (i = 0; i < 2; i++) {
            at[i][k] = lanes_subtract(at[i][k], middle);
            size = lanes_larger(size, lanes_absolute(at[i][k]));
        }
    }
    SC_UNROLL
    for (i = 0; i < 2; i++) {
        x[i] = measure(axes, 0, projection, at[i]);
        y[i] = measure(axes, 1, projection, at[i]);
    }
    SC_UNROLL
    for (i = 0; i < 2; i++) {
        lanes_store(c->x + SC_LANES_COUNT * i, lanes_pick_both(x, number + SC_LANES_COUNT * i));
        lanes_store(c->y + SC_LANES_COUNT * i, lanes_pick_both(y, number + SC_LANES_COUNT * i));
    }
    lanes_store(c->x + 2 * SC_LANES_COUNT, lanes_all(0));
    lanes_store(c->y + 2 * SC_LANES_COUNT, lanes_all(0));
    c->reach = lanes_most(size);
    c->error = sc_bounds_contour(c->reach);
}

/* The points at which a contour certainly turns in, without those that follow another one. */
static inline unsigned find_turns(const short_points *c)
{
    const unsigned all = (1u << c->count) - 1u, last = c->count - 1;
    unsigned in = 0, first;
    SC_UNROLL
    for (first = 0; first < 2 * SC_LANES_COUNT; first += SC_LANES_COUNT) {
        const edges_at e = find_edges(c, first);
        const lanes x = lanes_load(c->x + first + 2), y = lanes_load(c->y + first + 2);
        in |= lanes_bits(lanes_below(place_of(e.x, e.y, x, y), e.from)) << first;
    }
    in &= all; /* edges; now the points they lead to */
    in = (in << 1 | in >> last) & all;
    return in & ~(in << 1 | in >> last);
}

static inline void drop_turns(const short_points *c, short_points *kept)
{
    const unsigned left = ((1u << c->count) - 1u) & ~find_turns(c);
    uint8_t number[2][SC_LANES_COUNT + 4] = {{0}, {0}};
    unsigned first = lanes_list(left & 0xffffu, number[0]), i;
    kept->count = first + lanes_list(left >> SC_LANES_COUNT, number[1]);
    SC_UNROLL
    for (i = 0; i < 2; i++) {
        const lanes_index some = lanes_index_load(number[i]);
        lanes_store(kept->x + first * i, lanes_pick(c->x + SC_LANES_COUNT * i, some));
        lanes_store(kept->y + first * i, lanes_pick(c->y + SC_LANES_COUNT * i, some));
    }
    kept->error = c->error;
    kept->reach = c->reach;
}

static inline void write_edges(const short_points *c, short_edges *edges)
{
    const edges_at e = find_edges(c, 0);
    int i;
    SC_UNROLL
    for (i = 0; i < 2; i++) {
        const unsigned at = i ? c->count : 0;
        lanes_store(edges->x + at, e.x);
        lanes_store(edges->y + at, e.y);
        lanes_store(edges->from + at, e.from);
        lanes_store(edges->to + at, e.to);
    }
}

/* Above 0 where each of sixteen edges certainly is on one side of the line of that so many further
   on, or that of its own; at is where the other begins, and then where it ends. */
static SC_INLINE lanes room_between(const short_points *c, const short_edges *e, unsigned on,
                                    lanes *at)
{
    const lanes end = place_of(lanes_load(e->x), lanes_load(e->y), lanes_load(c->x + on + 1),
                               lanes_load(c->y + on + 1));
    const lanes x = lanes_load(e->x + on), y = lanes_load(e->y + on);
    const lanes p = place_of(x, y, lanes_load(c->x), lanes_load(c->y));
    const lanes q = place_of(x, y, lanes_load(c->x + 1), lanes_load(c->y + 1));
    lanes room = lanes_subtract(lanes_smaller(*at, end), lanes_load(e->to));
    room = lanes_larger(room, lanes_subtract(lanes_load(e->from), lanes_larger(*at, end)));
    room = lanes_larger(room, lanes_subtract(lanes_smaller(p, q), lanes_load(e->to + on)));
    room = lanes_larger(room, lanes_subtract(lanes_load(e->from + on), lanes_larger(p, q)));
    *at = end;
    return room;
}

/* The same along edges in place of across: above 0 where each certainly lies behind or ahead of
   that so many further on, or that one of it. */
static SC_INLINE lanes room_along(const short_points *c, const short_edges *e, unsigned on)
{
    lanes room = lanes_all(-INFINITY);
    int s;
    SC_UNROLL
    for (s = 0; s < 2; s++) {
        const unsigned own = s ? on : 0, other = s ? 0 : on;
        const lanes x = lanes_load(e->x + own), y = lanes_load(e->y + own);
        const lanes bound = lanes_subtract(lanes_load(e->to + own), lanes_load(e->from + own));
        const lanes begin = place_along(x, y, lanes_load(c->x + own), lanes_load(c->y + own));
        const lanes end = place_along(x, y, lanes_load(c->x + own + 1), lanes_load(c->y + own + 1));
        const lanes p = place_along(x, y, lanes_load(c->x + other), lanes_load(c->y + other));
        const lanes q =
            place_along(x, y, lanes_load(c->x + other + 1), lanes_load(c->y + other + 1));
        room = lanes_larger(room, lanes_subtract(lanes_smaller(p, q), lanes_add(end, bound)));
        room = lanes_larger(room, lanes_subtract(lanes_subtract(begin, bound), lanes_larger(p, q)));
    }
    return room;
}

/* Whether each edge is certainly apart from that so many further on. Along edges few have to be
   looked at: those in a straight row. */
static inline int edges_are_apart(const short_points *c, const short_edges *e, unsigned on,
                                  lanes *at)
{
    const lanes none = lanes_all(0);
    const unsigned all = (1u << c->count) - 1u;
    const unsigned open = ~lanes_bits(lanes_below(none, room_between(c, e, on, at))) & all;
    return !open || !(open & ~lanes_bits(lanes_below(none, room_along(c, e, on))));
}

/* Whether a contour of SHORT_EDGES edges or fewer is certainly simple. */
static inline int is_simple(const short_points *c, const short_edges *e)
{
    lanes at =
        place_of(lanes_load(e->x), lanes_load(e->y), lanes_load(c->x + 2), lanes_load(c->y + 2));
    unsigned on;
    for (on = 2; 2 * on <= c->count; on++)
        if (!edges_are_apart(c, e, on, &at)) return 0;
    return 1;
}

/* The contour of two leaf clusters that share points: a loop, and how many points it has, 0 if it
   will not do. */
static inline unsigned find_loop(const sc_model *model, const sc_cluster_pair *p,
                                 const uint16_t **loop)
{
    const sc_node *n = sc_model_node(model) + sc_model_share_node(model)[p->shared];
    if (n->kind & (SC_NODE_TOUCHES | SC_NODE_PIECES)) return 0;
    *loop = sc_model_loop(model) + n->loop;
    return n->loop_length > 2 && n->loop_length <= SHORT_POINTS ? n->loop_length : 0;
}

/* Of some pairs, of which all triangles face a direction, those that have certainly nothing in
   common but what they share. Each step is made for all of them before the next: what was just
   written is read slowly in other pieces. */
static unsigned find_certified(const sc_worker *w, sc_cluster_pair *const pair[], unsigned count)
{
    const uint16_t *mask = w->frame->mask + sc_model_first_leaf_patch(w->model);
    short_points all[SHORT_PAIRS], kept[SHORT_PAIRS];
    short_edges edges[SHORT_PAIRS];
    unsigned number[SHORT_PAIRS] = {0}, seen = 0, fit = 0, i, certified = 0;
    uint16_t both[SC_DNC_VECTORS] = {0};
    sc_simple_some_axes axes;
    for (i = 0; i < count; i++) both[i] = mask[pair[i]->a] & mask[pair[i]->b];
    sc_simple_axes_of(both, &axes);
    for (i = 0; i < count; i++) {
        const sc_cluster_pair *p = pair[i];
        const uint16_t *loop;
        number[seen] = i;
        all[seen].count = find_loop(w->model, p, &loop);
        if (!all[seen].count) continue;
        see_loop(w, p, &axes, i, loop, &all[seen++]);
    }
    for (i = 0; i < seen; i++) {
        repeat(all[i].x, all[i].count);
        repeat(all[i].y, all[i].count);
    }
    for (i = 0; i < seen; i++) {
        number[fit] = number[i];
        drop_turns(&all[i], &kept[fit]);
        fit += kept[fit].count <= SHORT_EDGES;
    }
    for (i = 0; i < fit; i++) {
        repeat(kept[i].x, kept[i].count);
        repeat(kept[i].y, kept[i].count);
    }
    for (i = 0; i < fit; i++) write_edges(&kept[i], &edges[i]);
    for (i = 0; i < fit; i++) certified |= (unsigned)is_simple(&kept[i], &edges[i]) << number[i];
    return certified;
}

/* Asks for memory that two leaf clusters need here, in steps, of which each reads what the one
   before asked for. */
enum { SHORT_FETCHES = 3 };
static inline void fetch_loop(const sc_worker *w, const sc_cluster_pair *p, int step)
{
    const sc_model *model = w->model;
    const uint32_t *node = sc_model_share_node(model) + p->shared;
    const float *at = w->frame->point_at;
    int k;
    if (step == 0) {
        sc_fetch(node);
        return;
    }
    if (step == 2) {
        SC_UNROLL
        for (k = 0; k < 4; k++) {
            sc_fetch(at + SC_LEAF_POINTS * (4 * (uint64_t)p->a + (unsigned)k));
            sc_fetch(at + SC_LEAF_POINTS * (4 * (uint64_t)p->b + (unsigned)k));
        }
    }
    if (step == 1) {
        sc_fetch(sc_model_node(model) + *node);
    } else {
        const uint16_t *loop = sc_model_loop(model) + sc_model_node(model)[*node].loop;
        sc_fetch(loop);
        sc_fetch(loop + 2 * SC_LANES_COUNT - 1);
    }
}

/* Of so many pairs of leaf clusters drops two that have certainly nothing in common but
   what they share, and marks them: then neither is to be looked at by itself. */
static SC_NOINLINE void drop_certified(sc_worker *w, sc_cluster_pair *pairs, uint32_t pair_count)
{
    enum { DISTANCE = 8 }; /* pairs between two steps of fetching */
    const unsigned told = SC_TOUCHES | SC_CLUSTERS_DROPPED; /* by other tests, or not at all */
    sc_cluster_pair *some[SHORT_PAIRS];
    const uint32_t first = sc_model_first_leaf_patch(w->model);
    const uint16_t *mask = w->frame->mask + first;
    uint8_t *marks = w->last.marks + first;
    uint32_t *oriented = w->lists.scratch;
    uint32_t count = 0, i;
    unsigned bits, taken = 0;
    int step;
    for (i = 0; i < pair_count; i++) {
        const sc_cluster_pair *p = pairs + i;
        oriented[count] = i;
        count += (p->a != p->b) & ((mask[p->a] & mask[p->b]) != 0) & !(p->known & told);
    }
    for (step = 0; step < SHORT_FETCHES; step++) {
        const uint32_t ahead = DISTANCE * (uint32_t)(SHORT_FETCHES + 1 - step);
        for (i = 0; i < ahead && i < count; i++) fetch_loop(w, pairs + oriented[i], step);
    }
    for (i = 0; i < count; i++) {
        for (step = 0; step < SHORT_FETCHES; step++) {
            uint32_t ahead = i + DISTANCE * (uint32_t)(SHORT_FETCHES + 1 - step);
            if (ahead < count) fetch_loop(w, pairs + oriented[ahead], step);
        }
        some[taken++] = pairs + oriented[i];
        if (taken < SHORT_PAIRS && i + 1 < count) continue;
        for (bits = find_certified(w, some, taken); bits; bits &= bits - 1) {
            sc_cluster_pair *p = some[sc_bits_lowest(bits)];
            marks[p->a] = marks[p->b] = 1;
            p->known |= SC_CLUSTERS_DROPPED;
        }
        taken = 0;
    }
}

/*
 * Contacts are where the two of a pair meet: against an oracle in rational numbers that knows
 * nothing of planes and sides, on triangles in general, degenerate, nearly degenerate and extreme
 * positions; on whole meshes; and arguments that cannot be.
 *
 * The oracle: weights l of a and m of b with sum l a = sum m b, sum l = 1, sum m = 1, l and m not
 * negative, form a polytope, whose corners have linearly independent columns. All 63 sets of
 * columns are tried; the points of these corners have the intersection as their hull.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <gmp.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "query/contacts.h"
#include "shapes.h"
#include "starcontour.h"

enum { ROWS = 5, COLUMNS = 6, CORNERS_MAX = 64 };

/* What is promised, and below what coordinates may be off by more. */
static const double relative = 0x1p-49, absolute = 0x1p-1070, weight_absolute = 0x1p-1000;

typedef struct rational_point {
    mpq_t x[3];
} rational_point;

typedef struct oracle {
    mpq_t triangle[2][3][3];
    mpq_t table[ROWS][COLUMNS + 1];
    mpq_t t, s;
    rational_point corners[CORNERS_MAX];
    int count;
    int ends[2]; /* of a segment */
    uint32_t kind;
} oracle;

static void oracle_start(oracle *o)
{
    for (int h = 0; h < 2; ++h)
        for (int i = 0; i < 9; ++i) mpq_init(o->triangle[h][i / 3][i % 3]);
    for (int i = 0; i < ROWS * (COLUMNS + 1); ++i)
        mpq_init(o->table[i / (COLUMNS + 1)][i % (COLUMNS + 1)]);
    for (int i = 0; i < 3 * CORNERS_MAX; ++i) mpq_init(o->corners[i / 3].x[i % 3]);
    mpq_inits(o->t, o->s, NULL);
}

static void oracle_stop(oracle *o)
{
    for (int h = 0; h < 2; ++h)
        for (int i = 0; i < 9; ++i) mpq_clear(o->triangle[h][i / 3][i % 3]);
    for (int i = 0; i < ROWS * (COLUMNS + 1); ++i)
        mpq_clear(o->table[i / (COLUMNS + 1)][i % (COLUMNS + 1)]);
    for (int i = 0; i < 3 * CORNERS_MAX; ++i) mpq_clear(o->corners[i / 3].x[i % 3]);
    mpq_clears(o->t, o->s, NULL);
}

static int is_same_point(const rational_point *p, const rational_point *q)
{
    return mpq_equal(p->x[0], q->x[0]) && mpq_equal(p->x[1], q->x[1]) &&
           mpq_equal(p->x[2], q->x[2]);
}

/* Solves for the weights of the chosen columns; adds the point if there is one new. */
static void try_columns(oracle *o, unsigned chosen)
{
    uint32_t used = 0;
    int row_of[COLUMNS], row, c;
    rational_point *p = &o->corners[o->count];
    for (c = 0; c < COLUMNS; ++c)
        for (row = 0; row < ROWS; ++row) {
            if (row < 3) {
                mpq_set(o->table[row][c], o->triangle[c / 3][c % 3][row]);
                if (c >= 3) mpq_neg(o->table[row][c], o->table[row][c]);
            } else {
                mpq_set_si(o->table[row][c], (row == 3) == (c < 3), 1);
            }
            mpq_set_si(o->table[row][COLUMNS], row >= 3, 1);
        }
    for (c = 0; c < COLUMNS; ++c) {
        if (!(chosen >> c & 1)) continue;
        for (row = 0; row < ROWS; ++row)
            if (!(used >> row & 1) && mpq_sgn(o->table[row][c]) != 0) break;
        if (row == ROWS) return; /* dependent */
        used |= 1u << row;
        row_of[c] = row;
        for (int r = 0; r < ROWS; ++r) {
            if (r == row || mpq_sgn(o->table[r][c]) == 0) continue;
            mpq_div(o->t, o->table[r][c], o->table[row][c]);
            for (int k = 0; k <= COLUMNS; ++k) {
                mpq_mul(o->s, o->t, o->table[row][k]);
                mpq_sub(o->table[r][k], o->table[r][k], o->s);
            }
        }
    }
    for (row = 0; row < ROWS; ++row) /* no solution with these alone */
        if (!(used >> row & 1) && mpq_sgn(o->table[row][COLUMNS]) != 0) return;
    for (int k = 0; k < 3; ++k) mpq_set_ui(p->x[k], 0, 1);
    for (c = 0; c < COLUMNS; ++c) {
        if (!(chosen >> c & 1)) continue;
        mpq_div(o->t, o->table[row_of[c]][COLUMNS], o->table[row_of[c]][c]);
        if (mpq_sgn(o->t) < 0) return;
        for (int k = 0; k < 3 && c < 3; ++k) {
            mpq_mul(o->s, o->t, o->triangle[0][c][k]);
            mpq_add(p->x[k], p->x[k], o->s);
        }
    }
    for (int i = 0; i < o->count; ++i)
        if (is_same_point(&o->corners[i], p)) return;
    o->count++;
}

/* Whether r is on the line of p and q, which differ. */
static int is_collinear(oracle *o, const rational_point *p, const rational_point *q,
                        const rational_point *r)
{
    mpq_t u[3], v[3];
    int ok = 1;
    for (int k = 0; k < 3; ++k) {
        mpq_inits(u[k], v[k], NULL);
        mpq_sub(u[k], q->x[k], p->x[k]);
        mpq_sub(v[k], r->x[k], p->x[k]);
    }
    for (int k = 0; k < 3; ++k) {
        mpq_mul(o->t, u[k], v[(k + 1) % 3]);
        mpq_mul(o->s, v[k], u[(k + 1) % 3]);
        ok &= mpq_equal(o->t, o->s) != 0;
    }
    for (int k = 0; k < 3; ++k) mpq_clears(u[k], v[k], NULL);
    return ok;
}

static int is_before(const rational_point *p, const rational_point *q)
{
    for (int k = 0; k < 3; ++k)
        if (!mpq_equal(p->x[k], q->x[k])) return mpq_cmp(p->x[k], q->x[k]) < 0;
    return 0;
}

static void oracle_find(oracle *o, double triangles[2][3][3])
{
    for (int h = 0; h < 2; ++h)
        for (int i = 0; i < 9; ++i)
            mpq_set_d(o->triangle[h][i / 3][i % 3], triangles[h][i / 3][i % 3]);
    o->count = 0;
    for (unsigned chosen = 1; chosen < 1u << COLUMNS; ++chosen) try_columns(o, chosen);
    o->ends[0] = o->ends[1] = 0;
    o->kind = o->count == 0 ? SC_MEET_NONE : o->count == 1 ? SC_MEET_POINT : SC_MEET_SEGMENT;
    for (int i = 1; i < o->count; ++i) {
        if (!is_collinear(o, &o->corners[0], &o->corners[1], &o->corners[i]))
            o->kind = SC_MEET_AREA;
        if (is_before(&o->corners[i], &o->corners[o->ends[0]])) o->ends[0] = i;
        if (is_before(&o->corners[o->ends[1]], &o->corners[i])) o->ends[1] = i;
    }
}

/* ---- comparing ---- */

/* Whether |value - truth| is at most bound. */
static int is_close(oracle *o, double value, mpq_t truth, double bound)
{
    if (!(value - value <= 0)) return 0; /* NaN or infinite */
    mpq_set_d(o->t, value);
    mpq_sub(o->t, o->t, truth);
    mpq_abs(o->t, o->t);
    mpq_set_d(o->s, bound);
    return mpq_cmp(o->t, o->s) <= 0;
}

static int is_close_point(oracle *o, double triangles[2][3][3], const double point[3],
                          rational_point *truth)
{
    for (int k = 0; k < 3; ++k) {
        double largest = 0;
        for (int i = 0; i < 6; ++i) {
            double x = fabs(triangles[i / 3][i % 3][k]);
            if (x > largest) largest = x;
        }
        if (!is_close(o, point[k], truth->x[k], relative * largest + absolute)) return 0;
    }
    return 1;
}

/* The true weights of a point of a triangle's plane, if the triangle has an area: 1; else 0. */
static int find_weights(oracle *o, mpq_t corner[3][3], rational_point *p, mpq_t weights[3])
{
    for (int k = 0; k < 3; ++k) {
        int l = (k + 1) % 3;
        mpq_t area;
        mpq_init(area);
        for (int w = 0; w < 4; ++w) { /* 3: that of the whole */
            mpq_t *q[3];
            for (int i = 0; i < 3; ++i) q[i] = i == w ? p->x : corner[i];
            mpq_set_ui(area, 0, 1);
            for (int i = 0; i < 3; ++i) {
                int j = (i + 1) % 3;
                mpq_mul(o->t, q[i][k], q[j][l]);
                mpq_add(area, area, o->t);
                mpq_mul(o->t, q[i][l], q[j][k]);
                mpq_sub(area, area, o->t);
            }
            if (w < 3) mpq_set(weights[w], area);
        }
        if (mpq_sgn(area) != 0) {
            for (int w = 0; w < 3; ++w) mpq_div(weights[w], weights[w], area);
            mpq_clear(area);
            return 1;
        }
        mpq_clear(area);
    }
    return 0;
}

/* Weights of one end. */
static int are_weights(oracle *o, double triangles[2][3][3], int of, const double weights[3],
                       rational_point *truth)
{
    mpq_t w[3];
    int ok = 1, unique;
    mpq_inits(w[0], w[1], w[2], NULL);
    unique = find_weights(o, o->triangle[of], truth, w);
    for (int i = 0; i < 3; ++i) {
        ok &= weights[i] >= 0 && weights[i] <= 1;
        if (!unique || !ok) continue;
        ok &= is_close(o, weights[i], w[i], relative * mpq_get_d(w[i]) + weight_absolute) &&
              (mpq_sgn(w[i]) != 0 || !(weights[i] > 0));
    }
    if (!unique && ok) /* whatever they are, their mean is the point */
        for (int k = 0; k < 3; ++k) {
            double largest = 0;
            mpq_set_ui(w[0], 0, 1);
            for (int i = 0; i < 3; ++i) {
                double x = fabs(triangles[of][i][k]);
                if (x > largest) largest = x;
                mpq_set_d(w[1], weights[i]);
                mpq_mul(w[1], w[1], o->triangle[of][i][k]);
                mpq_add(w[0], w[0], w[1]);
            }
            mpq_sub(w[0], w[0], truth->x[k]);
            ok &= is_close(o, 0, w[0], relative * largest + absolute);
        }
    mpq_clears(w[0], w[1], w[2], NULL);
    return ok;
}

static int is_close_end(oracle *o, double triangles[2][3][3], const sc_contact *c, int end,
                        int corner)
{
    return is_close_point(o, triangles, c->points[end], &o->corners[corner]) &&
           are_weights(o, triangles, 0, c->weights_a[end], &o->corners[corner]) &&
           are_weights(o, triangles, 1, c->weights_b[end], &o->corners[corner]);
}

/* The corner that an end is, -1 if none. */
static int find_corner(oracle *o, double triangles[2][3][3], const sc_contact *c, int end)
{
    for (int i = 0; i < o->count; ++i)
        if (is_close_end(o, triangles, c, end, i)) return i;
    return -1;
}

static int is_zero(const sc_contact *c)
{
    const double *numbers = &c->points[0][0];
    for (int i = 0; i < 6; ++i)
        if (numbers[i] != 0 || c->weights_a[i / 3][i % 3] != 0 || c->weights_b[i / 3][i % 3] != 0)
            return 0;
    return 1;
}

/* Whether a contact is right. */
static int is_right(oracle *o, double triangles[2][3][3], const sc_contact *c)
{
    int first, last;
    double spread = 0, largest = 0;
    for (int i = 0; i < 18; ++i) largest = fmax(largest, fabs(triangles[i / 9][i / 3 % 3][i % 3]));
    oracle_find(o, triangles);
    if (c->kind != o->kind || c->reserved != 0) return 0;
    if (c->kind == SC_MEET_NONE) return is_zero(c);
    if (c->kind == SC_MEET_POINT)
        return is_close_end(o, triangles, c, 0, 0) && is_close_end(o, triangles, c, 1, 0);
    if (c->kind == SC_MEET_SEGMENT)
        return (is_close_end(o, triangles, c, 0, o->ends[0]) &&
                is_close_end(o, triangles, c, 1, o->ends[1])) ||
               (is_close_end(o, triangles, c, 0, o->ends[1]) &&
                is_close_end(o, triangles, c, 1, o->ends[0]));
    first = find_corner(o, triangles, c, 0);
    last = find_corner(o, triangles, c, 1);
    if (first < 0 || last < 0) return 0;
    for (int k = 0; k < 3; ++k) spread += fabs(c->points[0][k] - c->points[1][k]);
    for (int i = 0; i < o->count; ++i) /* no corner is farther from the first, but for rounding */
        for (int k = 0; k < 3; ++k) {
            mpq_sub(o->t, o->corners[i].x[k], o->corners[first].x[k]);
            if (fabs(mpq_get_d(o->t)) > spread + 8 * relative * largest + absolute) return 0;
        }
    return 1;
}

static int check_pair(oracle *o, double triangles[2][3][3], const char *what, uint64_t seen[4])
{
    const double *a[3] = {triangles[0][0], triangles[0][1], triangles[0][2]};
    const double *b[3] = {triangles[1][0], triangles[1][1], triangles[1][2]};
    sc_contact c;
    int right;
    memset(&c, 0xff, sizeof(c));
    sc_contacts_find(a, b, &c);
    if (c.kind < 4) seen[c.kind]++;
    right = is_right(o, triangles, &c);
    if (CHECK_MSG(right, "%s: kind %" PRIu32 ", should be %" PRIu32, what, c.kind, o->kind))
        return 1;
    if (test_failures() <= 3) {
        for (int i = 0; i < 6; ++i)
            test_note("%c %.17g %.17g %.17g", i < 3 ? 'a' : 'b', triangles[i / 3][i % 3][0],
                      triangles[i / 3][i % 3][1], triangles[i / 3][i % 3][2]);
        for (int e = 0; e < 2; ++e)
            test_note("end %.17g %.17g %.17g, weights %.17g %.17g %.17g, %.17g %.17g %.17g",
                      c.points[e][0], c.points[e][1], c.points[e][2], c.weights_a[e][0],
                      c.weights_a[e][1], c.weights_a[e][2], c.weights_b[e][0], c.weights_b[e][1],
                      c.weights_b[e][2]);
    }
    return 0;
}

static void check_seen(const uint64_t seen[4], uint64_t least)
{
    for (int i = 0; i < 4; ++i) CHECK_MSG(seen[i] >= least, "kind %d: only %" PRIu64, i, seen[i]);
}

/* ---- makers ---- */

static void make_random(double triangles[2][3][3])
{
    for (int i = 0; i < 18; ++i) triangles[i / 9][i / 3 % 3][i % 3] = test_random_range(-1, 1);
}

static void make_on_grid(double triangles[2][3][3], uint32_t range)
{
    for (int i = 0; i < 18; ++i)
        triangles[i / 9][i / 3 % 3][i % 3] = (double)test_random_below(range + 1);
}

static double nudged(double x)
{
    static const double sizes[] = {0, 0, 0x1p-52, 0x1p-50, 1e-12, 1e-8};
    return x + sizes[test_random_below(6)] * test_random_range(-1, 1);
}

/* The second is the first moved along its plane, turned round a line in it by next to nothing. */
static void make_nearly_parallel(double triangles[2][3][3])
{
    double w[2];
    make_random(triangles);
    for (int i = 0; i < 3; ++i) {
        w[0] = test_random_range(-1, 1);
        w[1] = test_random_range(-1, 1);
        for (int k = 0; k < 3; ++k) {
            double x = triangles[0][0][k] + w[0] * (triangles[0][1][k] - triangles[0][0][k]) +
                       w[1] * (triangles[0][2][k] - triangles[0][0][k]);
            triangles[1][i][k] = nudged(x);
        }
    }
}

/* Both thin, along directions that are nearly the same. */
static void make_slivers(double triangles[2][3][3])
{
    make_random(triangles);
    for (int h = 0; h < 2; ++h)
        for (int k = 0; k < 3; ++k) {
            double t = test_random_unit();
            if (h == 1 && k == 0 && test_random_below(2))
                memcpy(triangles[1], triangles[0], 2 * sizeof(triangles[1][0]));
            triangles[h][2][k] = nudged(triangles[h][0][k] * t + triangles[h][1][k] * (1 - t));
        }
}

/* Lets the second share vertices with the first, or have some in its plane or on its sides. */
static void share(double triangles[2][3][3])
{
    uint32_t how = test_random_below(6);
    for (uint32_t i = 0; i < how && i < 3; ++i) {
        double w[3] = {1, 0, 0};
        uint32_t shift = test_random_below(3);
        if (how > 3) {
            w[1] = test_random_below(5) / 4.0;
            w[2] = how > 4 ? (1 - w[1]) * test_random_below(3) / 2 : 0;
            w[0] = 1 - w[1] - w[2];
        }
        for (int k = 0; k < 3; ++k)
            triangles[1][i][k] = w[0] * triangles[0][shift][k] +
                                 w[1] * triangles[0][(shift + 1) % 3][k] +
                                 w[2] * triangles[0][(shift + 2) % 3][k];
    }
}

/* Lets a corner be repeated, or lie between the others. */
static void flatten(double triangle[3][3])
{
    uint32_t how = test_random_below(3);
    for (int k = 0; k < 3; ++k) {
        triangle[2][k] = how == 0 ? triangle[0][k] : (triangle[0][k] + triangle[1][k]) / 2;
        if (how == 2) triangle[0][k] = triangle[1][k] = triangle[2][k];
    }
}

static void make_any(double triangles[2][3][3])
{
    switch (test_random_below(6)) {
    case 0:
        make_random(triangles);
        break;
    case 1:
        make_on_grid(triangles, 2);
        break;
    case 2:
        make_on_grid(triangles, 8);
        break;
    case 3:
        make_nearly_parallel(triangles);
        break;
    case 4:
        make_slivers(triangles);
        break;
    default:
        make_on_grid(triangles, 4);
        for (int i = 0; i < 6; ++i) triangles[i / 3][i % 3][2] = 0.1;
        break;
    }
    if (test_random_below(2)) share(triangles);
    if (test_random_below(8) == 0) flatten(triangles[test_random_below(2)]);
}

/* ---- tests ---- */

static void against_rationals(void)
{
    uint64_t seen[4] = {0, 0, 0, 0};
    oracle o;
    oracle_start(&o);
    for (uint32_t i = 0; i < test_iterations(6000); ++i) {
        double triangles[2][3][3];
        make_any(triangles);
        check_pair(&o, triangles, "triangles", seen);
    }
    check_seen(seen, test_iterations(6000) / 60);
    oracle_stop(&o);
}

/* The same at every scale, far from the origin, and scaled in one coordinate only. */
static void scaled(void)
{
    static const double factors[] = {1e-30,    1e30,   0x1p-40,           0x1p-500, 0x1p500,
                                     0x1p-990, 1e-308, 4.9406564584e-324, 0x1p1020};
    uint64_t seen[4] = {0, 0, 0, 0};
    oracle o;
    oracle_start(&o);
    for (uint32_t i = 0; i < test_iterations(3000); ++i) {
        double triangles[2][3][3], factor = factors[i % 9], offset = 0;
        uint32_t axis = test_random_below(6); /* above 2: all */
        make_any(triangles);
        if (i % 5 == 0) offset = test_random_range(1e3, 1e12);
        for (int k = 0; k < 18; ++k)
            if (axis > 2 || axis == (uint32_t)k % 3)
                triangles[k / 9][k / 3 % 3][k % 3] = (triangles[k / 9][k / 3 % 3][k % 3] +
                                                      (offset < 1e9 || factor < 1 ? offset : 0)) *
                                                     (offset > 0 && factor > 1 ? 1 : factor);
        check_pair(&o, triangles, "scaled", seen);
    }
    check_seen(seen, test_iterations(3000) / 60);
    oracle_stop(&o);
}

static void edges(void)
{
    uint64_t seen[4] = {0, 0, 0, 0};
    oracle o;
    oracle_start(&o);
    for (uint32_t i = 0; i < test_iterations(3000); ++i) {
        double triangles[2][3][3];
        make_any(triangles);
        memcpy(triangles[0][2], triangles[0][1], sizeof(triangles[0][2]));
        if (check_pair(&o, triangles, "edge", seen)) {
            const double *a[3] = {triangles[0][0], triangles[0][1], triangles[0][2]};
            const double *b[3] = {triangles[1][0], triangles[1][1], triangles[1][2]};
            sc_contact c;
            sc_contacts_find(a, b, &c);
            CHECK(!(c.weights_a[0][2] > 0) && !(c.weights_a[1][2] > 0));
        }
    }
    CHECK(seen[SC_MEET_AREA] == 0);
    seen[SC_MEET_AREA] = UINT64_MAX;
    check_seen(seen, test_iterations(3000) / 60);
    oracle_stop(&o);
}

/* Pairs of a query, of meshes in every type, order and welding: what is in the list meets. */
static void pairs_of_meshes(void)
{
    uint64_t seen[4] = {0, 0, 0, 0};
    oracle o;
    oracle_start(&o);
    for (uint32_t round = 0; round < test_iterations_at_least(40, 20); ++round) {
        const char *name;
        soup mesh = shape_any(80, &name), posed = soup_copy(&mesh);
        input_choices choices = input_choose(&mesh, test_random_below(3), test_random_below(4));
        uint32_t *weld = input_weld_of(&choices, &mesh);
        sc_mesh input = input_plain_mesh(&mesh);
        uint32_t type = round % 2 ? SC_FLOAT : SC_DOUBLE;
        input_array positions;
        sc_model *model;
        sc_workspace *workspace;
        soup_any_pose(posed.positions, posed.vertex_count);
        if (type == SC_FLOAT) soup_round_to_float(posed.positions, posed.vertex_count);
        positions = input_positions(posed.positions, posed.vertex_count, type, round % 3 * 4);
        if (CHECK(sc_build(&input, &choices.options, &model) == SC_OK) &&
            CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK)) {
            sc_pose pose = input_pose(posed.vertex_count, &positions);
            for (uint32_t kind = 0; kind < 2; ++kind)
                for (uint32_t contact = 0; contact < 2; ++contact) {
                    enum { ROOM = 400 };
                    static sc_pair pairs[ROOM];
                    static sc_contact contacts[ROOM + 1];
                    uint64_t count;
                    sc_query_options options;
                    sc_result r;
                    memset(&options, 0, sizeof(options));
                    options.struct_size = sizeof(options);
                    options.pairs = kind;
                    options.contact = contact;
                    memset(&r, 0, sizeof(r));
                    r.struct_size = sizeof(r);
                    r.pairs = pairs;
                    r.capacity = ROOM;
                    sc_query(model, workspace, &pose, &options, &r);
                    count = r.count < ROOM ? r.count : ROOM;
                    contacts[count].kind = 0x77777777;
                    CHECK(sc_contacts(model, &pose, kind, pairs, count, contacts) == SC_OK);
                    CHECK(contacts[count].kind == 0x77777777);
                    for (uint64_t i = 0; i < count; ++i) {
                        double triangles[2][3][3];
                        uint32_t a = kind ? pairs[i].a / 3 : pairs[i].a;
                        uint32_t shift = kind ? pairs[i].a % 3 : 0;
                        for (uint32_t k = 0; k < 3; ++k) {
                            uint32_t corner = kind && k == 2 ? 1 : k;
                            uint32_t va = posed.triangles[3 * a + (shift + corner) % 3];
                            uint32_t vb = posed.triangles[3 * pairs[i].b + k];
                            memcpy(triangles[0][k], posed.positions + 3 * (size_t)weld[va],
                                   sizeof(triangles[0][k]));
                            memcpy(triangles[1][k], posed.positions + 3 * (size_t)weld[vb],
                                   sizeof(triangles[1][k]));
                        }
                        if (i % 8 == 0 || contacts[i].kind > 3)
                            CHECK_MSG(is_right(&o, triangles, &contacts[i]), "%s", name);
                        CHECK(contacts[i].kind != SC_MEET_NONE);
                        if (contact == SC_CONTACT_PROPER) {
                            CHECK(contacts[i].kind == SC_MEET_POINT || /* of one without area */
                                  (contacts[i].kind == SC_MEET_SEGMENT && kind == 0));
                        } else if (contacts[i].kind < 4) {
                            seen[contacts[i].kind]++;
                        }
                    }
                }
            sc_workspace_free(workspace);
        }
        sc_model_free(model);
        input_free(&positions);
        free(weld);
        input_free_choices(&choices);
        soup_free(&mesh);
        soup_free(&posed);
    }
    CHECK(seen[SC_MEET_POINT] > 0 && seen[SC_MEET_SEGMENT] > 0 && seen[SC_MEET_AREA] > 0);
    oracle_stop(&o);
}

static void wrong_arguments(void)
{
    soup mesh = soup_cloth(2, 2); /* 8 triangles, 9 vertices */
    sc_mesh input = input_plain_mesh(&mesh);
    sc_pose pose = input_plain_pose(mesh.positions, mesh.vertex_count);
    sc_pair pair = {0, 1};
    sc_contact c;
    sc_model *model;
    if (!CHECK(sc_build(&input, NULL, &model) == SC_OK)) return;
    CHECK(sc_contacts(model, &pose, 0, &pair, 1, &c) == SC_OK);
    CHECK(sc_contacts(model, &pose, 0, NULL, 0, NULL) == SC_OK);
    CHECK(sc_contacts(NULL, &pose, 0, &pair, 1, &c) == SC_ERROR_NULL);
    CHECK(sc_contacts(model, NULL, 0, &pair, 1, &c) == SC_ERROR_NULL);
    CHECK(sc_contacts(model, &pose, 0, NULL, 1, &c) == SC_ERROR_NULL);
    CHECK(sc_contacts(model, &pose, 0, &pair, 1, NULL) == SC_ERROR_NULL);
    CHECK(sc_contacts(model, &pose, 2, &pair, 1, &c) == SC_ERROR_OPTION);
    for (uint32_t kind = 0; kind < 2; ++kind) {
        pair.a = kind ? 24 : 8;
        pair.b = 1;
        CHECK(sc_contacts(model, &pose, kind, &pair, 1, &c) == SC_ERROR_PAIRS);
        pair.a = 1;
        pair.b = 8;
        CHECK(sc_contacts(model, &pose, kind, &pair, 1, &c) == SC_ERROR_PAIRS);
        pair.a = pair.b = UINT32_MAX;
        CHECK(sc_contacts(model, &pose, kind, &pair, 1, &c) == SC_ERROR_PAIRS);
        pair.a = pair.b = 1;
        CHECK(sc_contacts(model, &pose, kind, &pair, 1, &c) == (kind ? SC_OK : SC_ERROR_PAIRS));
        pair.a = 5;
        CHECK(sc_contacts(model, &pose, kind, &pair, 1, &c) == SC_OK);
    }
    pair.a = 0;
    pair.b = 1;
    for (uint32_t k = 0; k < 3; ++k) {
        double *x = &mesh.positions[3 * (size_t)mesh.triangles[k] + k], kept = *x;
        *x = k == 0 ? (double)NAN : k == 1 ? HUGE_VAL : -HUGE_VAL;
        CHECK(sc_contacts(model, &pose, 0, &pair, 1, &c) == SC_ERROR_NOT_FINITE);
        *x = kept;
    }
    mesh.positions[3 * 8] = (double)NAN; /* a vertex of neither */
    CHECK(sc_contacts(model, &pose, 0, &pair, 1, &c) == SC_OK);
    pose.vertex_count--;
    CHECK(sc_contacts(model, &pose, 0, &pair, 1, &c) == SC_ERROR_VERTEX_COUNT);
    pose.vertex_count++;
    pose.struct_size = 4;
    CHECK(sc_contacts(model, &pose, 0, &pair, 1, &c) == SC_ERROR_STRUCT_SIZE);
    pose.struct_size = sizeof(pose);
    pose.position_stride = 1;
    CHECK(sc_contacts(model, &pose, 0, &pair, 1, &c) == SC_ERROR_STRIDE);
    pose.position_stride = 0;
    pose.positions = NULL;
    CHECK(sc_contacts(model, &pose, 0, &pair, 1, &c) == SC_ERROR_NULL);
    sc_model_free(model);
    soup_free(&mesh);
}

SC_TEST_MAIN(SC_TEST(against_rationals), SC_TEST(scaled), SC_TEST(edges), SC_TEST(pairs_of_meshes),
             SC_TEST(wrong_arguments))

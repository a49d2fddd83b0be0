/*
 * Tests of the narrow phase of continuous collision, lib/step/impact, against exact arithmetic.
 *
 * SPDX-License-Identifier: MIT
 *
 * Nothing that touches is missed; no reported time is after the first contact; and at the reported
 * time the distance is within the tolerance. Separations other than 0 are compared with exact
 * distances at some times.
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "harness.h"
#include "step/impact.h"
#include "step_oracle.h"

typedef struct query {
    double start[4][3], end[4][3];
} query;

typedef struct tally {
    uint64_t asked, touching, reported, extra;
} tally;

static int ask_until(const query *q, step_oracle_kind kind, const sc_impact_limits *limits,
                     double *time)
{
    if (kind == STEP_ORACLE_VERTEX_FACE)
        return sc_impact_vertex_face(q->start, q->end, limits, time);
    return sc_impact_edge_edge(q->start, q->end, limits, time);
}

static int is_within(const query *q, step_oracle_kind kind, double time, double a, double b)
{
    return step_oracle_is_within(kind, q->start, q->end, time, a, b);
}

static int ask(const query *q, step_oracle_kind kind, double separation, double tolerance,
               double *time)
{
    sc_impact_limits limits = {separation, tolerance, 1};
    return ask_until(q, kind, &limits, time);
}

static int touches(const query *q, step_oracle_kind kind, double *low, double *high)
{
    return step_oracle_touches(kind, q->start, q->end, low, high);
}

static void print_query(const query *q, step_oracle_kind kind)
{
    test_note("kind %d", (int)kind);
    for (int i = 0; i < 4; ++i)
        test_note("{%a, %a, %a} -> {%a, %a, %a}", q->start[i][0], q->start[i][1], q->start[i][2],
                  q->end[i][0], q->end[i][1], q->end[i][2]);
}

/* The largest difference of coordinates between a point of one and a point of the other. */
static double size_of(const query *q, step_oracle_kind kind)
{
    int split = kind == STEP_ORACLE_VERTEX_FACE ? 1 : 2;
    double size = 0;
    for (int i = 0; i < split; ++i) {
        for (int j = split; j < 4; ++j) {
            for (int k = 0; k < 3; ++k) {
                double a = q->start[j][k] / 4 - q->start[i][k] / 4;
                double b = q->end[j][k] / 4 - q->end[i][k] / 4;
                size = fmax(size, fmax(fabs(a), fabs(b)));
            }
        }
    }
    return size; /* a quarter of it, which is finite */
}

/* Asks once and compares with all that is promised. */
static void check_query(const query *q, step_oracle_kind kind, double separation, double tolerance,
                        tally *t)
{
    double quarter = size_of(q, kind), allowed = fmax(tolerance, 4 * SC_IMPACT_FLOOR * quarter);
    double time = -1, low = 2, high = 2, until = -1;
    sc_impact_limits limits = {separation, tolerance, 1};
    uint64_t failures = test_failures();
    int answer = ask(q, kind, separation, tolerance, &time), early;
    int meets = touches(q, kind, &low, &high);
    allowed *= 1 + 0x1p-50;
    ++t->asked;
    t->touching += meets != 0;
    t->reported += answer != 0;
    t->extra += answer && !meets;
    CHECK(answer == 1 || (answer == 0 && time == 1));
    if (meets) CHECK_MSG(answer && time <= high, "touches at %g, reported at %g", low, time);
    if (answer) {
        CHECK_MSG(time >= 0 && time <= 1, "%g", time);
        CHECK_MSG(is_within(q, kind, time, separation, allowed), "too far apart at %g, %g", time,
                  allowed);
    }
    for (int i = separation > 0 ? 0 : 7; i < 8; ++i) {
        double s = i < 2 ? i : test_random_unit();
        if (answer && i > 2) s *= time;
        if (is_within(q, kind, s, separation, 0))
            CHECK_MSG(answer && time <= s, "near at %g, answer %d at %g", s, answer, time);
    }
    limits.latest =
        answer && test_random_below(2) ? time * 1.25 * test_random_unit() : test_random_unit();
    early = ask_until(q, kind, &limits, &until);
    CHECK_MSG(early == (answer && time <= limits.latest), "until %g: %d", limits.latest, early);
    CHECK(until == (early ? time : 1));
    if (test_failures() > failures) {
        print_query(q, kind);
        test_note("separation %a, tolerance %a", separation, tolerance);
    }
}

/* ------------------------------------------------------------------------------------------------
 * Steps
 */

static double grid(int range)
{
    return (double)test_random_below((uint32_t)(2 * range + 1)) - range;
}

static void make_random(query *q)
{
    double speed = exp2(-(double)test_random_below(8));
    for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 3; ++k) {
            q->start[i][k] = test_random_range(-1, 1);
            q->end[i][k] = q->start[i][k] + speed * test_random_range(-2, 2);
        }
    }
}

static void make_on_grid(query *q)
{
    int range = 1 + (int)test_random_below(4);
    for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 3; ++k) {
            q->start[i][k] = grid(range);
            q->end[i][k] = grid(range);
        }
    }
}

/* What is added to all points: a place and a motion. */
static void move_all(query *q, double place, double motion)
{
    for (int k = 0; k < 3; ++k) {
        double a = place * test_random_range(-1, 1), b = a + motion * test_random_range(-1, 1);
        for (int i = 0; i < 4; ++i) {
            q->start[i][k] += a;
            q->end[i][k] += b;
        }
    }
}

/*
 * Two that touch at a time in an exactly representable point: inside, on a border, or at corners;
 * then perhaps moved apart a little.
 */
static void make_touching(query *q, step_oracle_kind kind)
{
    double t = (double)(1 + test_random_below(15)) / 16, u, v;
    int corner = test_random_below(3) == 0;
    make_on_grid(q);
    u = (double)test_random_below(corner ? 2 : 9) / (corner ? 1 : 8);
    v = (double)test_random_below(corner ? 2 : 9) / (corner ? 1 : 8);
    for (int k = 0; k < 3; ++k) {
        double at[4], target;
        for (int i = 0; i < 4; ++i) at[i] = q->start[i][k] + t * (q->end[i][k] - q->start[i][k]);
        if (kind == STEP_ORACLE_VERTEX_FACE) {
            double w = (1 - u) * v;
            target = at[1] + u * (at[2] - at[1]) + w * (at[3] - at[1]) - at[0];
            q->start[0][k] += target;
            q->end[0][k] += target;
        } else {
            target = at[2] + v * (at[3] - at[2]) - at[0] - u * (at[1] - at[0]);
            q->start[0][k] += target;
            q->end[0][k] += target;
            q->start[1][k] += target;
            q->end[1][k] += target;
        }
    }
    if (test_random_below(2)) {
        double step = exp2(-(double)(10 + test_random_below(42)));
        int k = (int)test_random_below(3);
        q->start[0][k] += grid(1) * step;
        q->end[0][k] += grid(1) * step;
    }
}

/* Everything in a plane or line that does not move, or all moving with one motion. */
static void make_flat(query *q)
{
    int m[3][3], lines = 1 + (int)test_random_below(2);
    int is_random = test_random_below(2) == 0;
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) m[i][k] = (int)grid(2);
    }
    for (int i = 0; i < 4; ++i) {
        double a[2], b[2];
        for (int k = 0; k < 2; ++k) {
            a[k] = is_random ? ldexp(grid(1 << 20), -18) : grid(3);
            b[k] = is_random ? ldexp(grid(1 << 20), -18) : grid(3);
        }
        for (int k = 0; k < 3; ++k) {
            q->start[i][k] = a[0] * m[0][k] + (lines == 2 ? a[1] * m[1][k] : 0);
            q->end[i][k] = b[0] * m[0][k] + (lines == 2 ? b[1] * m[1][k] : 0);
        }
    }
}

/* Points that coincide, stand still, share a trajectory, or lie on a line. */
static void make_degenerate(query *q)
{
    if (test_random_below(2)) {
        make_random(q);
    } else {
        make_on_grid(q);
    }
    for (uint32_t changes = 1 + test_random_below(3); changes > 0; --changes) {
        uint32_t a = test_random_below(4), b = test_random_below(4), c = test_random_below(4);
        uint32_t shape = test_random_below(6);
        double s = (double)test_random_below(5) / 4;
        for (int k = 0; k < 3; ++k) {
            if (shape == 0 || shape == 1) q->start[a][k] = q->start[b][k];
            if (shape == 1 || shape == 2) q->end[a][k] = q->end[b][k];
            if (shape == 3) q->end[a][k] = q->start[a][k];
            if (shape == 4) q->start[a][k] = q->start[b][k] + s * (q->start[c][k] - q->start[b][k]);
            if (shape == 5) {
                q->start[a][k] = q->start[b][k] + s * (q->start[c][k] - q->start[b][k]);
                q->end[a][k] = q->end[b][k] + s * (q->end[c][k] - q->end[b][k]);
            }
        }
    }
}

/* A thin gap that stays: layers, of a thickness of any order, that slide along each other and
   bend. */
static void make_layers(query *q, step_oracle_kind kind)
{
    double gap = exp2(-(double)test_random_below(30)),
           bend = gap * exp2(4 - (double)test_random_below(8));
    int split = kind == STEP_ORACLE_VERTEX_FACE ? 1 : 2;
    for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 2; ++k) {
            q->start[i][k] = test_random_range(-1, 1);
            q->end[i][k] = q->start[i][k] + test_random_range(-1, 1);
        }
        q->start[i][2] = (i < split ? gap : 0) + bend * test_random_range(-0.1, 0.1);
        q->end[i][2] = (i < split ? gap : 0) + bend * test_random_range(-0.1, 0.1);
        if (test_random_below(2)) { /* turned, with exact sums */
            double x = q->start[i][0], y = q->end[i][0];
            q->start[i][0] = x + q->start[i][2];
            q->end[i][0] = y + q->end[i][2];
        }
    }
}

/* Other sizes of everything, of one axis, or of one point; and very small and large doubles. */
static void make_wide(query *q, step_oracle_kind kind)
{
    int far = (int)test_random_below(3);
    if (test_random_below(2)) {
        make_touching(q, kind);
    } else {
        make_random(q);
    }
    for (int k = 0; k < 3; ++k) {
        int exponent = (int)test_random_below(far == 0 ? 40 : 1000) - (far == 0 ? 20 : 500);
        for (int i = 0; i < 4; ++i) {
            int own = test_random_below(4) == 0 ? (int)test_random_below(60) - 30 : 0;
            q->start[i][k] = ldexp(q->start[i][k], exponent + own);
            q->end[i][k] = ldexp(q->end[i][k], exponent + own);
        }
    }
    if (far == 2) {
        int exponent = test_random_below(2) ? -560 : 470;
        for (int i = 0; i < 4; ++i) {
            for (int k = 0; k < 3; ++k) {
                double a = ldexp(q->start[i][k], exponent), b = ldexp(q->end[i][k], exponent);
                q->start[i][k] = fmax(-DBL_MAX, fmin(DBL_MAX, a));
                q->end[i][k] = fmax(-DBL_MAX, fmin(DBL_MAX, b));
            }
        }
    }
}

/*
 * Two that keep their place to each other while they turn and stretch: in one plane, a little
 * outside or inside, or at a small distance from it.
 */
static void make_rolling(query *q, step_oracle_kind kind)
{
    double gap = exp2(-(double)test_random_below(45)) * grid(1), u, v;
    double lift = test_random_below(2) ? exp2(-(double)test_random_below(45)) : 0;
    make_random(q);
    u = test_random_unit();
    v = test_random_below(2) ? test_random_unit() * (1 - u) : -gap;
    if (test_random_below(4) == 0) u = -gap;
    for (int k = 0; k < 3; ++k) {
        double *points[2][4];
        for (int i = 0; i < 4; ++i) {
            points[0][i] = &q->start[i][k];
            points[1][i] = &q->end[i][k];
        }
        for (int end = 0; end < 2; ++end) {
            double **p = points[end];
            if (kind == STEP_ORACLE_VERTEX_FACE) {
                *p[0] = *p[1] + u * (*p[2] - *p[1]) + v * (*p[3] - *p[1]) + lift;
            } else {
                double target = *p[2] + u * (*p[3] - *p[2]) + lift;
                *p[1] = target + v * (target - *p[0]);
            }
        }
    }
}

/*
 * Two edges nearly parallel, or a face nearly without width, where a point of one stays within some
 * of the least tolerances of a point of the other, goes through it, or leaves it. The nearest
 * points are then found badly.
 */
static void make_sliver(query *q, step_oracle_kind kind)
{
    double width = exp2(-(double)(20 + test_random_below(13))), s = test_random_unit();
    double t = test_random_unit(), turning = exp2(-(double)test_random_below(20));
    double side[2][3], across[2][3], gap[2], size = 0;
    uint32_t shape = test_random_below(4);
    for (int k = 0; k < 3; ++k) {
        side[0][k] = test_random_range(-1, 1);
        across[0][k] = test_random_range(-1, 1);
        side[1][k] = side[0][k] + turning * test_random_range(-1, 1);
        across[1][k] = across[0][k] + turning * test_random_range(-1, 1);
        size = fmax(size, fmax(fabs(side[0][k]), fabs(side[1][k])));
    }
    gap[0] = (shape == 0 ? 0 : test_random_range(-2, 2)) * size * SC_IMPACT_FLOOR;
    gap[1] = shape == 1 ? gap[0] : test_random_range(-2, 2) * size * SC_IMPACT_FLOOR;
    if (shape % 2 == 0) gap[1] *= exp2((double)test_random_below(24));
    for (int end = 0; end < 2; ++end) {
        double(*p)[3] = end ? q->end : q->start;
        const double *u = side[end], *v = across[end];
        double normal[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                            u[0] * v[1] - u[1] * v[0]};
        double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
        for (int k = 0; k < 3; ++k) {
            double away = length > 0 ? gap[end] * normal[k] / length : 0;
            double other = u[k] + width * v[k];
            if (kind == STEP_ORACLE_VERTEX_FACE) {
                double half = 0.5 * u[k] + width * v[k];
                p[0][k] = 0;
                p[1][k] = away - s * (1 - t) * u[k] - t * half;
                p[2][k] = p[1][k] + u[k];
                p[3][k] = p[1][k] + half;
            } else {
                p[0][k] = -s * u[k];
                p[1][k] = (1 - s) * u[k];
                p[2][k] = away - t * other;
                p[3][k] = away + (1 - t) * other;
            }
        }
    }
}

static double choose_tolerance(double size)
{
    static const double orders[] = {0, 1e-11, 1e-8, 1e-6, 1e-6, 1e-3};
    return fmin(DBL_MAX / 4, orders[test_random_below(6)] * 4 * size);
}

/* ------------------------------------------------------------------------------------------------
 * Tests
 */

typedef void maker(query *q, step_oracle_kind kind);

static void print_tally(const tally *sums)
{
    test_note("%lu asked, %lu touch, %lu reported, %lu of them for tolerance or separation",
              (unsigned long)sums->asked, (unsigned long)sums->touching,
              (unsigned long)sums->reported, (unsigned long)sums->extra);
}

static void run_queries(maker *make, uint32_t count, tally *sums)
{
    memset(sums, 0, sizeof(*sums));
    for (uint32_t i = 0; i < test_iterations(count); ++i) {
        step_oracle_kind kind = (step_oracle_kind)test_random_below(2);
        double separation = 0, size;
        query q;
        make(&q, kind);
        size = size_of(&q, kind);
        if (test_random_below(4) == 0)
            separation = fmin(DBL_MAX / 4, size * exp2(2 - (double)test_random_below(20)));
        check_query(&q, kind, separation, choose_tolerance(size), sums);
    }
    print_tally(sums);
}

static void random_or_translated(query *q, step_oracle_kind kind)
{
    (void)kind;
    make_random(q);
    if (test_random_below(4) == 0) move_all(q, 1000, 100);
}

static void random_steps(void)
{
    tally t;
    run_queries(random_or_translated, 40000, &t);
    CHECK(t.touching > t.asked / 100 && t.touching < t.asked / 2);
}

static void on_grid(query *q, step_oracle_kind kind)
{
    (void)kind;
    make_on_grid(q);
}

static void steps_on_a_grid(void)
{
    tally t;
    run_queries(on_grid, 20000, &t);
    CHECK(t.touching > t.asked / 20 && t.touching < t.asked * 9 / 10);
}

static void steps_that_just_touch(void)
{
    tally t;
    run_queries(make_touching, 20000, &t);
    CHECK(t.touching > t.asked / 2 && t.extra > t.asked / 100);
}

static void flat(query *q, step_oracle_kind kind)
{
    (void)kind;
    make_flat(q);
}

static void flat_steps(void)
{
    tally t;
    run_queries(flat, 3000, &t);
    CHECK(t.touching > t.asked / 20 && t.touching < t.asked * 9 / 10);
}

static void degenerate(query *q, step_oracle_kind kind)
{
    (void)kind;
    make_degenerate(q);
}

static void degenerate_steps(void)
{
    tally t;
    run_queries(degenerate, 20000, &t);
    CHECK(t.touching > t.asked / 100 && t.touching < t.asked * 9 / 10);
}

static void thin_layers(void)
{
    tally t;
    run_queries(make_layers, 20000, &t);
    CHECK(t.touching > t.asked / 1000 && t.extra > t.asked / 100);
}

static void rolling_steps(void)
{
    tally t;
    run_queries(make_rolling, 10000, &t);
    CHECK(t.touching > t.asked / 20 && t.extra > t.asked / 20);
}

/* At the least tolerance. No direction gets on in a tenth of these: they are decided by splitting
   the polygon. */
static void slivers(void)
{
    tally t = {0, 0, 0, 0};
    for (uint32_t i = 0; i < test_iterations(10000); ++i) {
        step_oracle_kind kind = (step_oracle_kind)test_random_below(2);
        query q;
        make_sliver(&q, kind);
        check_query(&q, kind, 0, 0, &t);
    }
    print_tally(&t);
    CHECK(t.touching > t.asked / 20 && t.extra > t.asked / 20 && t.reported < t.asked * 9 / 10);
}

/* The same, nearly at rest: they come near enough at the end of the step only, which may be nearer
   than a slab is long. */
static void slivers_nearly_at_rest(void)
{
    tally t = {0, 0, 0, 0};
    for (uint32_t i = 0; i < test_iterations(3000); ++i) {
        step_oracle_kind kind = (step_oracle_kind)test_random_below(2);
        double width = exp2(-(double)(20 + test_random_below(13))), s = test_random_unit();
        double u[3], v[3], normal[3], gap[2], length = 0, size = 0, part = test_random_unit();
        query q;
        for (int k = 0; k < 3; ++k) {
            u[k] = test_random_range(-1, 1);
            v[k] = test_random_range(-1, 1);
            size = fmax(size, fabs(u[k]));
        }
        for (int k = 0; k < 3; ++k) {
            normal[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
            length += normal[k] * normal[k];
        }
        gap[0] = test_random_range(0.3, 0.8) * size * SC_IMPACT_FLOOR / sqrt(length);
        gap[1] = test_random_range(0.2, 0.35) * size * SC_IMPACT_FLOOR / sqrt(length);
        for (int k = 0; k < 12; ++k) {
            double(*p)[3] = k < 6 ? q.start : q.end;
            double away = gap[k / 6] * normal[k % 3];
            int c = k % 3;
            if (k % 6 > 2) continue;
            if (kind == STEP_ORACLE_VERTEX_FACE) {
                double half = 0.5 * u[c] + width * v[c];
                p[0][c] = 0;
                p[1][c] = away - s * (1 - part) * u[c] - part * half;
                p[2][c] = p[1][c] + u[c];
                p[3][c] = p[1][c] + half;
            } else {
                double other = u[c] + width * v[c];
                p[0][c] = -s * u[c];
                p[1][c] = (1 - s) * u[c];
                p[2][c] = away - part * other;
                p[3][c] = away + (1 - part) * other;
            }
        }
        check_query(&q, kind, 0, 0, &t);
    }
    print_tally(&t);
    CHECK(t.extra > t.asked / 20 && t.reported < t.asked);
}

/* Coordinates that are a few times the smallest double there is. */
/* Two edges that come so near to each other for so long that the search looks ahead at as many
   times as it has room for. */
static void as_many_guards_as_there_are(void)
{
    static const query edges = {
        .start = {{0x1.40455210a62b2p-4, 0x1.5576313db9775p-5, -0x1.29a4b63d6219dp-4},
                  {-0x1.69a325ba2c242p+1, -0x1.4d738ec6623fcp-1, 0x1.2c8f1521b591ap+0},
                  {-0x1.e6d1257d24c5bp+0, 0x1.ffdb7a8f50bdfp+0, 0x1.4d4e24ad57d75p+0},
                  {0x1.0e1234589e388p+1, -0x1.e73ba8b807a2bp+0, -0x1.df853841a77c6p+0}},
        .end = {{0x1.06d595e2f8749p-4, 0x1.1ceceeede8c8p-3, 0x1.1bd3e79ee45e4p-9},
                {-0x1.dbb4c4a356aedp+1, 0x1.a5fdd65fbbc1bp+1, -0x1.72bd6c0b87689p-1},
                {0x1.eb122840325c5p+0, -0x1.84a542492e0f1p+1, 0x1.2f06d5d741f3fp+1},
                {-0x1.6ce89239d0e5cp-9, 0x1.5f59ca124f6eap-1, 0x1.d972e70eb76e7p+0}},
    };
    query q = edges;
    tally t = {0, 0, 0, 0};
    check_query(&q, STEP_ORACLE_EDGE_EDGE, 0, 0, &t);
    CHECK(t.asked == 1);
}

static void denormal_steps(void)
{
    tally t = {0, 0, 0, 0};
    for (uint32_t i = 0; i < test_iterations(4000); ++i) {
        step_oracle_kind kind = (step_oracle_kind)test_random_below(2);
        int exponent =
            -1036 + (int)test_random_below(36); /* so that the least tolerance is a number */
        double separation = ldexp((double)test_random_below(4), exponent);
        query q;
        make_on_grid(&q);
        for (int k = 0; k < 12; ++k) {
            q.start[k / 3][k % 3] = ldexp(q.start[k / 3][k % 3], exponent);
            q.end[k / 3][k % 3] = ldexp(q.end[k / 3][k % 3], exponent);
        }
        check_query(&q, kind, separation, 0, &t);
    }
    print_tally(&t);
    CHECK(t.touching > t.asked / 20 && t.reported < t.asked * 9 / 10);
}

static void wide_ranges(void)
{
    tally t;
    run_queries(make_wide, 15000, &t);
    CHECK(t.touching > t.asked / 100);
}

/* Separations that some distance during the step equals or just exceeds. */
static void separations_just_reached(void)
{
    uint64_t reached = 0, found = 0;
    for (uint32_t i = 0; i < test_iterations(12000); ++i) {
        step_oracle_kind kind = (step_oracle_kind)test_random_below(2);
        double s = (double)test_random_below(33) / 32, low = 0, high, time, size, tolerance;
        query q;
        int answer;
        if (test_random_below(2)) {
            make_on_grid(&q);
        } else {
            make_random(&q);
        }
        size = 4 * size_of(&q, kind);
        tolerance = size * exp2(-(double)test_random_below(40));
        high = 2 * size;
        /* The least double that the distance at s does not exceed. */
        if (is_within(&q, kind, s, 0, 0)) continue;
        while (nextafter(low, high) < high) {
            double middle = low + 0.5 * (high - low);
            if (is_within(&q, kind, s, middle, 0)) {
                high = middle;
            } else {
                low = middle;
            }
        }
        ++reached;
        answer = ask(&q, kind, high, tolerance, &time);
        if (!CHECK_MSG(answer && time <= s, "distance %a at %g, answer %d at %g", high, s, answer,
                       time))
            print_query(&q, kind);
        tolerance = fmax(tolerance, SC_IMPACT_FLOOR * size) * (1 + 0x1p-50);
        CHECK(!answer || is_within(&q, kind, time, high, tolerance));
        /* Half of that is reached elsewhere or not at all. */
        found += ask(&q, kind, 0.5 * high, tolerance, &time) != 0;
    }
    CHECK(reached > 0 && found > 0 && found < reached);
}

/* How far apart the two are at a time, but for rounding. */
static double distance_at(const query *q, step_oracle_kind kind, double time)
{
    int face = kind == STEP_ORACLE_VERTEX_FACE, count = face ? 3 : 4, is_inside = 1;
    double c[4][3], n[3], u[3], v[3], least = HUGE_VAL, height = 0, square = 0;
    for (int i = 0; i < count; ++i) {
        int a = face ? 0 : i == 1 || i == 2, b = face ? i + 1 : i < 2 ? 2 : 3;
        for (int k = 0; k < 3; ++k)
            c[i][k] = (1 - time) * (q->start[b][k] - q->start[a][k]) +
                      time * (q->end[b][k] - q->end[a][k]);
    }
    for (int k = 0; k < 3; ++k) {
        u[k] = c[1][k] - c[0][k];
        v[k] = c[count - 1][k] - c[0][k];
    }
    for (int k = 0; k < 3; ++k)
        n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    for (int i = 0; i < count; ++i) {
        const double *a = c[i], *b = c[(i + 1) % count];
        double along = 0, length = 0, area = 0, d = 0;
        for (int k = 0; k < 3; ++k) {
            along -= a[k] * (b[k] - a[k]);
            length += (b[k] - a[k]) * (b[k] - a[k]);
            area += n[k] * (a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
        }
        along = length > 0 ? fmax(0, fmin(1, along / length)) : 0;
        for (int k = 0; k < 3; ++k) {
            double x = a[k] + along * (b[k] - a[k]);
            d += x * x;
        }
        least = fmin(least, sqrt(d));
        is_inside &= area > 0;
    }
    for (int k = 0; k < 3; ++k) {
        height += n[k] * c[0][k];
        square += n[k] * n[k];
    }
    return is_inside ? fabs(height) / sqrt(square) : least;
}

/* Separations that are a little more than the distance where the two pass by each other. */
static void separations_in_passing(void)
{
    uint64_t passed = 0;
    for (uint32_t i = 0; i < test_iterations(60000); ++i) {
        step_oracle_kind kind = (step_oracle_kind)test_random_below(2);
        double nearest = 0, least = HUGE_VAL, separation, time = -1;
        query q;
        int answer;
        make_random(&q);
        for (int j = 0; j <= 32; ++j) {
            double d = distance_at(&q, kind, j / 32.0);
            if (d < least) {
                least = d;
                nearest = j / 32.0;
            }
        }
        if (nearest == 0 || nearest == 1) continue;
        for (double step = 1.0 / 64; step > 1e-8; step *= 0.5) {
            double before = distance_at(&q, kind, nearest - step);
            double after = distance_at(&q, kind, nearest + step);
            least = fmin(least, fmin(before, after));
            if (before == least) nearest -= step;
            if (before > least && after == least) nearest += step;
        }
        separation = least * (1 + exp2(-(double)(20 + test_random_below(12))));
        if (!is_within(&q, kind, nearest, separation, 0)) continue;
        ++passed;
        answer = ask(&q, kind, separation, 0, &time);
        if (!CHECK_MSG(answer && time <= nearest, "%a at %g, answer %d at %g", separation, nearest,
                       answer, time))
            print_query(&q, kind);
    }
    CHECK(passed > test_iterations(60000) / 100);
}

/* Two that are a little more than separation apart, and move by less than the tolerance. */
static void steps_within_the_tolerance(void)
{
    tally t = {0, 0, 0, 0};
    for (uint32_t i = 0; i < test_iterations(5000); ++i) {
        step_oracle_kind kind = (step_oracle_kind)test_random_below(2);
        double tolerance = exp2(-(double)(3 + test_random_below(20))), separation;
        query q;
        make_random(&q);
        for (int k = 0; k < 12; ++k)
            q.end[k / 3][k % 3] = q.start[k / 3][k % 3] + tolerance * test_random_range(-1, 1);
        separation = distance_at(&q, kind, 0) - tolerance * test_random_range(0.4, 1.2);
        if (separation < 0) continue;
        check_query(&q, kind, separation, tolerance, &t);
    }
    print_tally(&t);
    CHECK(t.reported > t.asked / 10 && t.reported < t.asked * 9 / 10);
}

/* Faces and edges so small that squares of their normals, or even those, vanish, above each other,
   until they come near or leave; asked just after they are at the separation, too. */
static void steps_of_tiny_ones(void)
{
    tally t = {0, 0, 0, 0};
    for (uint32_t i = 0; i < test_iterations(6000); ++i) {
        step_oracle_kind kind = (step_oracle_kind)test_random_below(2);
        double tiny =
            exp2(-(double)(i % 2 ? 266 + test_random_below(3) : 120 + test_random_below(160)));
        double above = exp2(-(double)test_random_below(30));
        double until = above * test_random_range(-1, 1), separation = 0, time, s;
        uint32_t up = test_random_below(3);
        query q;
        for (uint32_t k = 0; k < 2; ++k)
            for (int p = 0; p < 4; ++p) {
                static const double place[2][2][4] = {{{0, -1, 1, 0}, {0, -1, -1, 1}},
                                                      {{-1, 1, 0, 0}, {0, 0, -1, 1}}};
                uint32_t axis = (up + 1 + k) % 3;
                q.start[p][axis] = tiny * (place[kind][k][p] + test_random_range(-0.4, 0.4));
                q.end[p][axis] = q.start[p][axis];
            }
        for (int p = 0; p < 4; ++p) {
            int is_upper = p > (kind == STEP_ORACLE_VERTEX_FACE ? 0 : 1);
            q.start[p][up] = is_upper ? above : 0;
            q.end[p][up] = is_upper ? until : 0;
        }
        if (test_random_below(2)) separation = above * test_random_unit();
        check_query(&q, kind, separation, test_random_below(2) ? 0 : above * 1e-3, &t);
        s = (above - separation) / (above - until) * (1 + 1e-8);
        if (s <= 1 && is_within(&q, kind, s, separation, 0))
            CHECK(ask(&q, kind, separation, 0, &time) && time <= s);
    }
    print_tally(&t);
    CHECK(t.reported > t.asked / 4 && t.reported < t.asked);
}

/* A distance of 2^-538 or so, in all of which squares vanish, is less than separation. */
static void distances_whose_squares_vanish(void)
{
    for (int exponent = -560; exponent < -500; ++exponent) {
        double x = ldexp(1, exponent), time;
        query face = {{{0, 0, 0}, {x, -1, -1}, {x, -1, 1}, {x, 2, 0}},
                      {{0, 0, 0}, {x, -1, -1}, {x, -1, 1}, {x, 2, 0}}};
        query edges = {{{0, -1, 0}, {0, 1, 0}, {x, 0, -1}, {x, 0, 1}},
                       {{0, -1, 0}, {0, 1, 0}, {x, 0, -1}, {x, 0, 1}}};
        for (int small = 1; small < 30; ++small) {
            double separation = ldexp(1, -small);
            CHECK(ask(&face, STEP_ORACLE_VERTEX_FACE, separation, 0, &time) && time == 0);
            CHECK(ask(&edges, STEP_ORACLE_EDGE_EDGE, separation, 0, &time) && time == 0);
        }
    }
}

/*
 * Answers and times as they were when this was written: they are the same on all machines. Whoever
 * changes the search changes the number.
 */
static void same_bits_everywhere(void)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    for (uint32_t i = 0; i < 4000; ++i) {
        step_oracle_kind kind = (step_oracle_kind)(i & 1);
        double separation = i % 3 == 0 ? ldexp(1, -(int)(i % 7)) : 0, time;
        uint64_t bits;
        query q;
        test_random_reset(i);
        for (int j = 0; j < 4; ++j) {
            for (int k = 0; k < 3; ++k) {
                q.start[j][k] = test_random_unit();
                q.end[j][k] = q.start[j][k] + test_random_unit() - 0.5;
            }
        }
        hash =
            (hash ^ (uint64_t)ask(&q, kind, separation, 0x1p-20, &time)) * UINT64_C(0x100000001b3);
        memcpy(&bits, &time, sizeof(bits));
        hash = (hash ^ bits) * UINT64_C(0x100000001b3);
    }
    CHECK_MSG(hash == UINT64_C(0xf6c939267644d02), "0x%llx", (unsigned long long)hash);
}

static void known_times(void)
{
    query drop = {{{0.25, 0.25, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                  {{0.25, 0.25, -1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    query crossing = {{{-1, 0, 1}, {1, 0, 1}, {0, -1, 0}, {0, 1, 0}},
                      {{-1, 0, -3}, {1, 0, -3}, {0, -1, 0}, {0, 1, 0}}};
    double time = -1;
    CHECK(ask(&drop, STEP_ORACLE_VERTEX_FACE, 0, 1e-6, &time) == 1);
    CHECK_MSG(time <= 0.5 && time >= 0.5 - 1e-6, "%.17g", time);
    CHECK(ask(&drop, STEP_ORACLE_VERTEX_FACE, 0.5, 1e-6, &time) == 1);
    CHECK_MSG(time <= 0.25 && time >= 0.25 - 1e-6, "%.17g", time);
    CHECK(ask(&drop, STEP_ORACLE_VERTEX_FACE, 1, 1e-6, &time) == 1 && time == 0);
    CHECK(ask(&crossing, STEP_ORACLE_EDGE_EDGE, 0, 1e-6, &time) == 1);
    CHECK_MSG(time <= 0.25 && time >= 0.25 - 1e-6, "%.17g", time);
    for (int i = 0; i < 4; ++i) drop.end[i][2] += 5;
    CHECK(ask(&drop, STEP_ORACLE_VERTEX_FACE, 0, 1e-6, &time) == 1);
    CHECK_MSG(time <= 0.5 && time >= 0.5 - 1e-6, "%.17g", time);
    drop.end[0][2] += 1.001;
    CHECK(ask(&drop, STEP_ORACLE_VERTEX_FACE, 0, 1e-6, &time) == 0 && time == 1);
    CHECK(ask(&drop, STEP_ORACLE_VERTEX_FACE, 0, 0, &time) == 0 && time == 1);
}

/* Reported times are not only early enough, but nearly always close to the contact. */
static void times_close_to_contacts(void)
{
    uint32_t touching = 0, far = 0;
    for (uint32_t i = 0; i < test_iterations(20000); ++i) {
        step_oracle_kind kind = (step_oracle_kind)test_random_below(2);
        double low, high, time;
        query q;
        make_random(&q);
        if (!touches(&q, kind, &low, &high)) continue;
        ++touching;
        CHECK(ask(&q, kind, 0, 1e-9, &time) && time <= high);
        far += low - time > 1e-6;
    }
    CHECK_MSG(touching > 0 && far <= touching / 100, "%u of %u", far, touching);
}

static void thickness_of_limits(void)
{
    sc_impact_limits limits = {0.5, 0.25, 1};
    CHECK(sc_impact_thickness(&limits, 1) >= 0.75 && sc_impact_thickness(&limits, 1) <= 0.7500001);
    limits.tolerance = 0;
    CHECK(sc_impact_thickness(&limits, 1) >= 0.5 + SC_IMPACT_FLOOR);
    CHECK(sc_impact_thickness(&limits, 0) >= 0.5);
    CHECK(sc_impact_thickness(&limits, HUGE_VAL) >= ldexp(SC_IMPACT_FLOOR, 1023));
    CHECK(sc_impact_thickness(&limits, HUGE_VAL) <= DBL_MAX);
}

SC_TEST_MAIN(SC_TEST(known_times), SC_TEST(same_bits_everywhere),
             SC_TEST(distances_whose_squares_vanish), SC_TEST(thickness_of_limits),
             SC_TEST(random_steps), SC_TEST(steps_on_a_grid), SC_TEST(steps_that_just_touch),
             SC_TEST(flat_steps), SC_TEST(degenerate_steps), SC_TEST(thin_layers),
             SC_TEST(rolling_steps), SC_TEST(slivers), SC_TEST(slivers_nearly_at_rest),
             SC_TEST(steps_within_the_tolerance), SC_TEST(steps_of_tiny_ones),
             SC_TEST(as_many_guards_as_there_are), SC_TEST(denormal_steps), SC_TEST(wide_ranges),
             SC_TEST(separations_just_reached), SC_TEST(separations_in_passing),
             SC_TEST(times_close_to_contacts))

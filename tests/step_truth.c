/*
 * See step_truth.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "step_truth.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "step_oracle.h"

const char *const step_kind_names[STEP_KINDS] = {"vertex-face", "edge-edge"};

/* Four points, as the oracle takes them. */
typedef const double (*points)[3];

static const double directions[STEP_DIRECTIONS][3] = {
    {1, 0, 0}, {0, 1, 0},  {0, 0, 1}, {1, 1, 0},  {1, -1, 0}, {1, 0, 1}, {1, 0, -1},
    {0, 1, 1}, {0, 1, -1}, {1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {-1, 1, 1}};

uint32_t step_edge_start(const step_motion *m, uint32_t corner)
{
    return m->corner[corner];
}

uint32_t step_edge_end(const step_motion *m, uint32_t corner)
{
    return m->corner[corner / 3 * 3 + (corner + 1) % 3];
}

/* Whether a corner is the first to name its edge. */
static int step_names_edge(const step_motion *m, uint32_t corner)
{
    uint32_t a = step_edge_start(m, corner), b = step_edge_end(m, corner);
    if (a == b) return 0;
    for (uint32_t c = 0; c < corner; ++c) {
        uint32_t p = step_edge_start(m, c), q = step_edge_end(m, c);
        if ((p == a && q == b) || (p == b && q == a)) return 0;
    }
    return 1;
}

step_motion step_motion_make(const soup *mesh, const double *start, const double *end,
                             const uint32_t *weld)
{
    const double *given[2] = {start, end};
    uint32_t n = mesh->vertex_count, corners = 3 * mesh->triangle_count;
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    step_motion m;
    memset(&m, 0, sizeof(m));
    m.triangles = mesh->triangles;
    m.vertex_count = n;
    m.triangle_count = mesh->triangle_count;
    m.corner = (uint32_t *)test_allocate(corners * sizeof(uint32_t));
    m.edge = (uint32_t *)test_allocate(corners * sizeof(uint32_t));
    m.used = (uint8_t *)test_allocate(n);
    memset(m.used, 0, n);
    for (uint32_t c = 0; c < corners; ++c) {
        m.corner[c] = weld[mesh->triangles[c]];
        m.used[m.corner[c]] = 1;
    }
    for (uint32_t c = 0; c < corners; ++c)
        if (step_names_edge(&m, c)) m.edge[m.edge_count++] = c;
    for (int e = 0; e < 2; ++e) {
        m.ends[e] = (double *)test_allocate(3 * (size_t)n * sizeof(double));
        m.along[e] = (double *)test_allocate(STEP_DIRECTIONS * (size_t)n * sizeof(double));
        memcpy(m.ends[e], given[e], 3 * (size_t)n * sizeof(double));
        for (uint32_t v = 0; v < n; ++v) {
            const double *p = given[e] + 3 * (size_t)v;
            if (!m.used[v]) continue;
            for (int k = 0; k < 3; ++k) {
                low[k] = fmin(low[k], p[k]);
                high[k] = fmax(high[k], p[k]);
            }
            for (int i = 0; i < STEP_DIRECTIONS; ++i) {
                const double *d = directions[i];
                double x = d[0] * p[0] + d[1] * p[1] + d[2] * p[2];
                m.along[e][STEP_DIRECTIONS * (size_t)v + (size_t)i] = x;
                m.size = fmax(m.size, fabs(x));
            }
        }
    }
    for (int k = 0; k < 3; ++k) m.extent = fmax(m.extent, high[k] - low[k]);
    return m;
}

void step_motion_free(step_motion *m)
{
    free(m->corner);
    free(m->edge);
    free(m->used);
    for (int e = 0; e < 2; ++e) {
        free(m->ends[e]);
        free(m->along[e]);
    }
}

uint32_t step_pair_vertices(const step_motion *m, int kind, sc_pair pair, uint32_t v[4])
{
    if (kind == STEP_VERTEX_FACE) {
        v[0] = pair.a;
        for (uint32_t k = 0; k < 3; ++k) v[1 + k] = m->corner[3 * (size_t)pair.b + k];
        return 1;
    }
    v[0] = step_edge_start(m, pair.a);
    v[1] = step_edge_end(m, pair.a);
    v[2] = step_edge_start(m, pair.b);
    v[3] = step_edge_end(m, pair.b);
    return 2;
}

/* Whether a pair stays farther apart than thickness, by a simple argument: along some direction it
   does so at both ends, hence all the time. */
static int step_stays_apart(const step_motion *m, const uint32_t v[4], uint32_t first,
                            double thickness)
{
    for (int i = 0; i < STEP_DIRECTIONS; ++i) {
        const double *d = directions[i];
        double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        double wanted = thickness * length * (1 + 1e-9) + 1e-12 * m->size;
        int above = 1, below = 1;
        for (int e = 0; e < 2 && (above || below); ++e) {
            double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
            for (uint32_t k = 0; k < 4; ++k) {
                double x = m->along[e][STEP_DIRECTIONS * (size_t)v[k] + (size_t)i];
                low[k >= first] = fmin(low[k >= first], x);
                high[k >= first] = fmax(high[k >= first], x);
            }
            above &= low[0] - high[1] > wanted;
            below &= low[1] - high[0] > wanted;
        }
        if (above || below) return 1;
    }
    return 0;
}

static void step_pair_points(const step_motion *m, const uint32_t v[4], double p[2][4][3])
{
    for (int e = 0; e < 2; ++e)
        for (int k = 0; k < 4; ++k)
            memcpy(p[e][k], m->ends[e] + 3 * (size_t)v[k], 3 * sizeof(double));
}

static double dot(const double *u, const double *v)
{
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

static double clamp(double x)
{
    return x > 0 ? fmin(x, 1) : 0;
}

/* The squared distance of two segments, from a along u and from b along v. */
static double segments_apart(const double *a, const double *u, const double *b, const double *v)
{
    double w[3], uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), least = HUGE_VAL;
    double determinant = uu * vv - uv * uv, wu, wv, s[6], t[6];
    int count = 0;
    for (int k = 0; k < 3; ++k) w[k] = b[k] - a[k];
    wu = dot(w, u);
    wv = dot(w, v);
    for (int end = 0; end < 2; ++end) { /* the nearest points to all four ends, and inside */
        s[count] = end;
        t[count++] = vv > 0 ? clamp((end * uv - wv) / vv) : 0;
        t[count] = end;
        s[count++] = uu > 0 ? clamp((end * uv + wu) / uu) : 0;
    }
    if (determinant > 0) {
        s[count] = clamp((wu * vv - wv * uv) / determinant);
        t[count++] = clamp((wu * uv - wv * uu) / determinant);
    }
    for (int i = 0; i < count; ++i) {
        double d[3];
        for (int k = 0; k < 3; ++k) d[k] = w[k] + t[i] * v[k] - s[i] * u[k];
        least = fmin(least, dot(d, d));
    }
    return least;
}

/* The distance of a pair at a time, about. */
static double step_distance_at(int kind, double p[2][4][3], double time)
{
    double x[4][3], u[3], v[3], w[3], n[3] = {0, 0, 0}, least = HUGE_VAL;
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 3; ++k) x[i][k] = (1 - time) * p[0][i][k] + time * p[1][i][k];
    if (kind == STEP_EDGE_EDGE) {
        for (int k = 0; k < 3; ++k) {
            u[k] = x[1][k] - x[0][k];
            v[k] = x[3][k] - x[2][k];
        }
        return sqrt(segments_apart(x[0], u, x[2], v));
    }
    for (int i = 1; i < 4; ++i) {
        for (int k = 0; k < 3; ++k) u[k] = x[i % 3 + 1][k] - x[i][k];
        least = fmin(least, segments_apart(x[0], n, x[i], u));
    }
    for (int k = 0; k < 3; ++k) {
        u[k] = x[2][k] - x[1][k];
        v[k] = x[3][k] - x[1][k];
        w[k] = x[0][k] - x[1][k];
    }
    for (int k = 0; k < 3; ++k)
        n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    if (dot(n, n) > 0) {
        double uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), wu = dot(w, u), wv = dot(w, v);
        double determinant = uu * vv - uv * uv;
        double s = (wu * vv - wv * uv) / determinant, t = (wv * uu - wu * uv) / determinant;
        if (s >= 0 && t >= 0 && s + t <= 1) least = fmin(least, dot(w, n) * dot(w, n) / dot(n, n));
    }
    return sqrt(least);
}

/* The time from low to high when the distance is least, about: the thirds of the interval in
   turn. */
static double step_nearest_time(int kind, double p[2][4][3], double low, double high)
{
    for (int i = 0; i < 40; ++i) {
        double a = low + (high - low) / 3, b = high - (high - low) / 3;
        if (step_distance_at(kind, p, a) < step_distance_at(kind, p, b))
            high = b;
        else
            low = a;
    }
    return low + (high - low) / 2;
}

/* Whether a pair surely comes as near as the separation, and if so a time that its first such time
   is not after. Without separation that is all there is to know; else some pairs that only just do
   are not seen. */
static int step_surely_collides(const step_motion *m, int kind, sc_pair pair, double separation,
                                double *when)
{
    enum { SAMPLES = 16 };
    uint32_t v[4], first = step_pair_vertices(m, kind, pair, v);
    double p[2][4][3], low, at[SAMPLES + 1];
    int collides;
    if (step_stays_apart(m, v, first, separation)) return 0;
    step_pair_points(m, v, p);
    collides = step_oracle_touches((step_oracle_kind)kind, (points)p[0], (points)p[1], &low, when);
    if (separation == 0) return collides;
    if (!collides) *when = 1;
    for (int i = 0; i <= SAMPLES; ++i) at[i] = step_distance_at(kind, p, (double)i / SAMPLES);
    for (int i = 0; i <= SAMPLES && (double)(i - 1) / SAMPLES < *when; ++i) {
        double before = at[i > 0 ? i - 1 : 0], after = at[i < SAMPLES ? i + 1 : SAMPLES], t;
        if (at[i] > before || at[i] > after) continue; /* no local minimum */
        t = step_nearest_time(kind, p, fmax(0, (double)(i - 1) / SAMPLES),
                              fmin(1, (double)(i + 1) / SAMPLES));
        if (!(t < *when) && collides) break;
        if (step_oracle_is_within((step_oracle_kind)kind, (points)p[0], (points)p[1], t, separation,
                                  0)) {
            *when = t;
            return 1;
        }
        t = (double)i / SAMPLES;
        if (step_oracle_is_within((step_oracle_kind)kind, (points)p[0], (points)p[1], t, separation,
                                  0)) {
            *when = t;
            return 1;
        }
    }
    return collides;
}

int step_is_near(const step_motion *m, int kind, sc_pair pair, double time, double separation,
                 double tolerance)
{
    uint32_t v[4], first = step_pair_vertices(m, kind, pair, v);
    double p[2][4][3], size = 0;
    step_pair_points(m, v, p);
    for (int e = 0; e < 2; ++e)
        for (uint32_t i = 0; i < first; ++i)
            for (uint32_t j = first; j < 4; ++j)
                for (int k = 0; k < 3; ++k) size = fmax(size, fabs(p[e][i][k] - p[e][j][k]));
    tolerance = fmax(tolerance, 0x1p-32 * size) * (1 + 1e-12);
    return step_oracle_is_within((step_oracle_kind)kind, (points)p[0], (points)p[1], time,
                                 separation, tolerance);
}

static int step_share(const uint32_t *v, uint32_t first)
{
    for (uint32_t i = 0; i < first; ++i)
        for (uint32_t k = first; k < 4; ++k)
            if (v[i] == v[k]) return 1;
    return 0;
}

static void step_truth_append(step_truth *found, sc_pair pair, double when)
{
    oracle_list *list = &found->list;
    if (list->count == list->capacity) {
        list->capacity = 2 * list->capacity + 64;
        list->pairs = (sc_pair *)realloc(list->pairs, list->capacity * sizeof(sc_pair));
        found->when = (double *)realloc(found->when, list->capacity * sizeof(double));
        if (list->pairs == NULL || found->when == NULL) abort();
    }
    list->pairs[list->count] = pair;
    found->when[list->count++] = when;
}

/* Whether nothing ever leaves a plane across an axis: then each question takes the oracle a
   millisecond. */
static int step_motion_is_flat(const step_motion *m)
{
    for (int k = 0; k < 3; ++k) {
        double first = (double)NAN;
        int flat = 1;
        for (int e = 0; e < 2; ++e)
            for (uint32_t v = 0; v < m->vertex_count; ++v) {
                double x = m->ends[e][3 * (size_t)v + (size_t)k];
                if (!m->used[v]) continue;
                if (isnan(first)) first = x;
                flat &= x == first;
            }
        if (flat) return 1;
    }
    return 0;
}

step_truth step_truth_find(const step_motion *m, int kind, double separation)
{
    step_truth found;
    double when;
    uint32_t rows = kind == STEP_VERTEX_FACE ? m->vertex_count : m->edge_count;
    uint32_t one_of = step_motion_is_flat(m) ? 1 + m->triangle_count * m->triangle_count / 100 : 1;
    memset(&found, 0, sizeof(found));
    for (uint32_t i = 0; i < rows; ++i) {
        uint32_t from = kind == STEP_VERTEX_FACE ? 0 : i + 1;
        uint32_t to = kind == STEP_VERTEX_FACE ? m->triangle_count : m->edge_count;
        if (kind == STEP_VERTEX_FACE && !m->used[i]) continue;
        for (uint32_t j = from; j < to; ++j) {
            sc_pair pair;
            uint32_t v[4], first;
            pair.a = kind == STEP_VERTEX_FACE ? i : m->edge[i];
            pair.b = kind == STEP_VERTEX_FACE ? j : m->edge[j];
            first = step_pair_vertices(m, kind, pair, v);
            if (step_share(v, first) || (one_of > 1 && test_random_below(one_of))) continue;
            if (step_surely_collides(m, kind, pair, separation, &when))
                step_truth_append(&found, pair, when);
        }
    }
    return found;
}

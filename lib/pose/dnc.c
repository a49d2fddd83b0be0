/*
 * Discrete normal cones. See dnc.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "pose/dnc.h"

#include <float.h>
#include <math.h>

enum { HALF = SC_DNC_DIRECTIONS / 2 };

/* The first half of the directions; the second half are their negatives. */
static const int direction[HALF][3] = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1},  {1, 1, 1},
                                       {1, 1, -1}, {1, -1, 1}, {1, -1, -1}};

/*
 * All of it is in single precision on the points in the unit box, each coordinate being off by
 * POINT at most: 2^-25 for the rounding to float and a little for that to double before.
 *
 * The error of a dot product of a computed normal e x f with a direction, whose components are 0 or
 * +-1. Written out, it is a sum of at most six products of a component of e and one of f, each component
 * at most twice. A component of e or f is off by 2 POINT and the rounding of a difference, so that the products are
 * off by 2 (2 POINT) (|e|1 + |f|1) + 6 (2 POINT)^2 in all, and by rounding: two differences, one multiplication, one
 * subtraction and two additions each, ((1 + u)^6 - 1) < 6.01 u times its absolute value, u = 2^-24; the
 * sum of the absolute values is at most |e|1 |f|1, computed to within 8 u. Hence 8 u |e|1 |f|1 +
 * 4.1 POINT (|e|1 + |f|1 + 6 POINT); the last term is for products that underflow.
 */
static const float POINT = 3e-8f;
static const float ERROR_RELATIVE = 8 * 5.9604644775390625e-8f;
static const float ERROR_ABSOLUTE = 16 * FLT_MIN;

/* Two sides of each of SC_LEAF_MAX triangles, component by component. */
typedef struct sides {
    float e[3][SC_LEAF_MAX], f[3][SC_LEAF_MAX];
} sides;

#if SC_BOXES_SSE2

/* Four triangles, from number at on. */
static inline void read_four(const float *unit, const uint32_t *const t[4], int at, sides *s)
{
    __m128 a[4], e[4], f[4];
    int i, k;
    for (i = 0; i < 4; i++) {
        a[i] = _mm_loadu_ps(unit + 4 * (uint64_t)t[i][0]);
        e[i] = _mm_sub_ps(_mm_loadu_ps(unit + 4 * (uint64_t)t[i][1]), a[i]);
        f[i] = _mm_sub_ps(_mm_loadu_ps(unit + 4 * (uint64_t)t[i][2]), a[i]);
    }
    _MM_TRANSPOSE4_PS(e[0], e[1], e[2], e[3]);
    _MM_TRANSPOSE4_PS(f[0], f[1], f[2], f[3]);
    for (k = 0; k < 3; k++) {
        _mm_storeu_ps(s->e[k] + at, e[k]);
        _mm_storeu_ps(s->f[k] + at, f[k]);
    }
}

#else

static inline void read_four(const float *unit, const uint32_t *const t[4], int at, sides *s)
{
    int i, k;
    for (i = 0; i < 4; i++) {
        const float *a = unit + 4 * (uint64_t)t[i][0], *b = unit + 4 * (uint64_t)t[i][1];
        const float *c = unit + 4 * (uint64_t)t[i][2];
        for (k = 0; k < 3; k++) {
            s->e[k][at + i] = b[k] - a[k];
            s->f[k][at + i] = c[k] - a[k];
        }
    }
}

#endif

/* The mask of 1 to SC_LEAF_MAX triangles, given by their corners. */
static uint32_t mask_of(const sc_workspace *w, const uint32_t *corner, uint32_t count)
{
    uint32_t mask = 0;
    sides s;
    float dot[HALF][SC_LEAF_MAX], error[SC_LEAF_MAX];
    const uint32_t *t[SC_LEAF_MAX];
    uint32_t i;
    int d;
    for (i = 0; i < SC_LEAF_MAX; i++) /* the last triangle fills the row */
        t[i] = corner + 3 * (i < count ? i : count - 1);
    for (i = 0; i < SC_LEAF_MAX; i += 4) read_four(w->unit, t + i, (int)i, &s);
    for (i = 0; i < SC_LEAF_MAX; i++) {
        float e0 = s.e[0][i], e1 = s.e[1][i], e2 = s.e[2][i];
        float f0 = s.f[0][i], f1 = s.f[1][i], f2 = s.f[2][i];
        float n0 = e1 * f2 - e2 * f1, n1 = e2 * f0 - e0 * f2, n2 = e0 * f1 - e1 * f0;
        float e_size = fabsf(e0) + fabsf(e1) + fabsf(e2);
        float f_size = fabsf(f0) + fabsf(f1) + fabsf(f2);
        float sum = n0 + n1, difference = n0 - n1;
        dot[0][i] = n0;
        dot[1][i] = n1;
        dot[2][i] = n2;
        dot[3][i] = sum + n2;
        dot[4][i] = sum - n2;
        dot[5][i] = difference + n2;
        dot[6][i] = difference - n2;
        error[i] = ERROR_RELATIVE * (e_size * f_size) +
                   4.1f * POINT * (e_size + f_size + 6 * POINT) + ERROR_ABSOLUTE;
    }
    for (d = 0; d < HALF; d++) {
        float least = dot[d][0] - error[0], most = dot[d][0] + error[0];
        for (i = 1; i < SC_LEAF_MAX; i++) {
            float low = dot[d][i] - error[i], high = dot[d][i] + error[i];
            least = low < least ? low : least;
            most = high > most ? high : most;
        }
        mask |= (uint32_t)(least > 0) << d | (uint32_t)(most < 0) << (d + HALF);
    }
    return mask;
}

void sc_dnc_update(const sc_model *model, sc_workspace *w)
{
    const uint32_t *level_first = sc_model_level_first(model), *child = sc_model_child(model);
    const uint32_t *leaf_first = sc_model_leaf_first(model), *corner = sc_model_triangle(model);
    uint32_t level, p, leaf, last = sc_model_first_leaf_patch(model);
    for (leaf = 0; leaf < model->leaf_count; leaf++)
        w->mask[last + leaf] = (uint16_t)mask_of(w, corner + 3 * (uint64_t)leaf_first[leaf],
                                                 leaf_first[leaf + 1] - leaf_first[leaf]);
    for (level = model->level_count - 1; level-- > 0;)
        for (p = level_first[level]; p + 1 < level_first[level + 1]; p++)
            w->mask[p] = w->mask[child[p]] & w->mask[child[p + 1] - 1];
}

int sc_dnc_validate(const sc_model *model, const sc_workspace *w)
{
    const uint32_t *level_first = sc_model_level_first(model), *leaf = sc_model_leaf(model);
    uint32_t level, p, i;
    for (level = 0; level < model->level_count; level++)
        for (p = level_first[level]; p + 1 < level_first[level + 1]; p++) {
            uint32_t mask = (1u << SC_DNC_DIRECTIONS) - 1u;
            for (i = sc_model_leaf_first(model)[leaf[p]];
                 i < sc_model_leaf_first(model)[leaf[p + 1]]; i++)
                mask &= mask_of(w, sc_model_triangle(model) + 3 * (uint64_t)i, 1);
            if (mask != w->mask[p]) return 0;
        }
    return 1;
}

/*
 * The direction s is a sum of integer vectors, faces and diagonals weighted by 7 and 4 because
 * 7 is about 4 sqrt(3). With u = s x h for an integer h and w = s x u, all of them integers,
 * u x w = |u|^2 s exactly: so a triangle whose normal has positive dot products with the summed
 * directions has a positive area in (u . p, w . p). h is oblique so that edges along the axes become
 * neither vertical nor horizontal. |s| <= 23, |u| <= 506, |w| <= 23276 in each component.
 *
 * A computed coordinate u . (p - origin) collects one difference, one product, two additions: an error
 * of 4.01 * 2^-53 times the sum of |u_k| |p_k - origin_k|, at most |u|1 radius.
 */
void sc_dnc_projection(const sc_workspace *w, uint32_t mask, sc_projection *projection)
{
    static const double oblique[2][3] = {{5, 2, 11}, {11, 3, 2}};
    const double *h = oblique[0];
    double s[3] = {0, 0, 0}, *u = projection->u, *v = projection->w;
    int d, k;
    for (d = 0; d < SC_DNC_DIRECTIONS; d++) {
        const int *one = direction[d % HALF];
        int weight = (one[0] && one[1]) ? 4 : 7;
        if (!(mask >> d & 1)) continue;
        for (k = 0; k < 3; k++) s[k] += (d < HALF ? weight : -weight) * one[k];
    }
    if (s[1] * h[2] == s[2] * h[1] && s[2] * h[0] == s[0] * h[2]) h = oblique[1];
    for (k = 0; k < 3; k++)
        u[k] = s[(k + 1) % 3] * h[(k + 2) % 3] - s[(k + 2) % 3] * h[(k + 1) % 3];
    for (k = 0; k < 3; k++)
        v[k] = s[(k + 1) % 3] * u[(k + 2) % 3] - s[(k + 2) % 3] * u[(k + 1) % 3];
    for (k = 0; k < 3; k++) projection->origin[k] = w->center[k];
    projection->x_error =
        5 * 1.1102230246251565e-16 * (fabs(u[0]) + fabs(u[1]) + fabs(u[2])) * w->radius;
    projection->y_error =
        5 * 1.1102230246251565e-16 * (fabs(v[0]) + fabs(v[1]) + fabs(v[2])) * w->radius;
}

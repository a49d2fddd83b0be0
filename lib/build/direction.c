/*
 * The direction across which a patch is cut. See direction.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/direction.h"

#include <math.h>
#include <string.h>

#include "simd/quads.h"

/* Triangles whose moments are added up in single precision. */
enum { RUN = 256 };

/* Rounds of power iteration, from the axis with the largest element. */
enum { ROUNDS = 6 };

/* By how much an axis has to have more than those before it: rounding is not to choose for a
   square. */
static const double CLEARLY = 1.001;

/* That normals turn by a radian counts as much as this part, squared, of the patch's mean square
   size; and what is added to variances of places, as a part of that, for patches that are flat.
   Tuned together on horse, cats and bunnies: weights of 1 to 2.5 squared with 0.003 to 0.2 are all
   within 5 %, with larger weights and smaller softness at up to 2 % more memory. */
static const double NORMALS_WEIGHT = 2.25, SOFTNESS = 0.03;

/* Sums over some triangles, of places relative to one of them; the last of four is of no use. */
typedef struct moments {
    float place[4], normal[4];
    float spread[3][4], turn[3][4]; /* place by place, place by normal */
} moments;

#if SC_QUADS

static void add_moments(const sc_facets *facets, const uint32_t *triangles, uint32_t count,
                        const float *origin, moments *m)
{
    sc_floats4 from = SC_QUAD(loadu_ps)(origin), zero = SC_QUAD(set1_ps)(0);
    sc_floats4 place = zero, normal = zero, spread[3], turn[3];
    uint32_t i, j;
    for (j = 0; j < 3; j++) spread[j] = turn[j] = zero;
    for (i = 0; i < count; i++) {
        sc_floats4 c = SC_QUAD(loadu_ps)(facets->centers + 3 * (uint64_t)triangles[i]);
        sc_floats4 n = SC_QUAD(loadu_ps)(facets->normals + 3 * (uint64_t)triangles[i]);
        sc_floats4 x = SC_QUAD(sub_ps)(c, from), along[3];
        along[0] = SC_QUAD_SHUFFLE(x, x, 0, 0, 0, 0);
        along[1] = SC_QUAD_SHUFFLE(x, x, 1, 1, 1, 1);
        along[2] = SC_QUAD_SHUFFLE(x, x, 2, 2, 2, 2);
        place = SC_QUAD(add_ps)(place, x);
        normal = SC_QUAD(add_ps)(normal, n);
        for (j = 0; j < 3; j++) {
            spread[j] = SC_QUAD(add_ps)(spread[j], SC_QUAD(mul_ps)(along[j], x));
            turn[j] = SC_QUAD(add_ps)(turn[j], SC_QUAD(mul_ps)(along[j], n));
        }
    }
    SC_QUAD(storeu_ps)(m->place, place);
    SC_QUAD(storeu_ps)(m->normal, normal);
    for (j = 0; j < 3; j++) {
        SC_QUAD(storeu_ps)(m->spread[j], spread[j]);
        SC_QUAD(storeu_ps)(m->turn[j], turn[j]);
    }
}

#else

static void add_moments(const sc_facets *facets, const uint32_t *triangles, uint32_t count,
                        const float *origin, moments *m)
{
    uint32_t i, j, k;
    memset(m, 0, sizeof *m);
    for (i = 0; i < count; i++) {
        const float *c = facets->centers + 3 * (uint64_t)triangles[i];
        const float *n = facets->normals + 3 * (uint64_t)triangles[i];
        float x[3];
        for (k = 0; k < 3; k++) x[k] = c[k] - origin[k];
        for (k = 0; k < 3; k++) {
            m->place[k] += x[k];
            m->normal[k] += n[k];
            for (j = 0; j < 3; j++) {
                m->spread[j][k] += x[j] * x[k];
                m->turn[j][k] += x[j] * n[k];
            }
        }
    }
}

#endif

/* Covariances, times count. */
static void find_covariances(const sc_facets *facets, const uint32_t *triangles, uint32_t count,
                             double spread[3][3], double turn[3][3])
{
    const float *origin = facets->centers + 3 * (uint64_t)triangles[0];
    double place[3] = {0, 0, 0}, normal[3] = {0, 0, 0};
    uint32_t begin;
    int j, k;
    memset(spread, 0, 9 * sizeof(double));
    memset(turn, 0, 9 * sizeof(double));
    for (begin = 0; begin < count; begin += RUN) {
        moments m;
        add_moments(facets, triangles + begin, count - begin < RUN ? count - begin : RUN, origin,
                    &m);
        for (k = 0; k < 3; k++) {
            place[k] += (double)m.place[k];
            normal[k] += (double)m.normal[k];
            for (j = 0; j < 3; j++) {
                spread[j][k] += (double)m.spread[j][k];
                turn[j][k] += (double)m.turn[j][k];
            }
        }
    }
    for (j = 0; j < 3; j++)
        for (k = 0; k < 3; k++) {
            spread[j][k] -= place[j] * place[k] / count;
            turn[j][k] -= place[j] * normal[k] / count;
        }
}

/* The inverse of a symmetric matrix, by cofactors; 0 if there is none. */
static void invert(double m[3][3], double inverse[3][3])
{
    double determinant = 0;
    int j, k;
    for (j = 0; j < 3; j++)
        for (k = 0; k < 3; k++) {
            const double *next = m[(j + 1) % 3], *last = m[(j + 2) % 3];
            inverse[j][k] =
                next[(k + 1) % 3] * last[(k + 2) % 3] - next[(k + 2) % 3] * last[(k + 1) % 3];
        }
    for (k = 0; k < 3; k++) determinant += m[0][k] * inverse[0][k];
    for (j = 0; j < 3; j++)
        for (k = 0; k < 3; k++) inverse[j][k] = determinant > 0 ? inverse[j][k] / determinant : 0;
}

static void multiply_matrices(double a[3][3], double b[3][3], double product[3][3])
{
    int j, k;
    for (j = 0; j < 3; j++)
        for (k = 0; k < 3; k++)
            product[j][k] = a[j][0] * b[0][k] + a[j][1] * b[1][k] + a[j][2] * b[2][k];
}

void sc_direction_find(const sc_facets *facets, const uint32_t *triangles, uint32_t count,
                       int turning, float direction[3])
{
    double m[3][3], turn[3][3], turned[3][3], square[3][3], inverse[3][3], at[3], size, weight;
    int j, k, round, axis = 0;
    find_covariances(facets, triangles, count, m, turn);
    size = m[0][0] + m[1][1] + m[2][2];
    weight = turning ? NORMALS_WEIGHT * size / count : 0;
    for (j = 0; j < 3; j++)
        for (k = 0; k < 3; k++) turned[j][k] = turn[k][j];
    multiply_matrices(turn, turned, square);
    for (k = 0; k < 3; k++) m[k][k] += SOFTNESS * size;
    invert(m, inverse);
    for (k = 0; k < 3; k++) m[k][k] -= SOFTNESS * size;
    multiply_matrices(inverse, square, turned);
    for (j = 0; j < 3; j++)
        for (k = 0; k < 3; k++) m[j][k] += weight * turned[j][k];
    for (k = 1; k < 3; k++)
        if (m[k][k] > CLEARLY * m[axis][axis]) axis = k;
    for (k = 0; k < 3; k++) at[k] = k == axis;
    for (round = 0; round < ROUNDS; round++) {
        double next[3];
        for (k = 0; k < 3; k++) next[k] = m[k][0] * at[0] + m[k][1] * at[1] + m[k][2] * at[2];
        size = fabs(next[0]) + fabs(next[1]) + fabs(next[2]);
        if (!(size > 0)) break;
        for (k = 0; k < 3; k++) at[k] = next[k] / size;
    }
    for (k = 0; k < 3; k++) direction[k] = (float)at[k];
}

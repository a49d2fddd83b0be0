/*
 * The direction across which a patch is cut, from places and normals of its triangles.
 *
 * SPDX-License-Identifier: MIT
 *
 * To be cut in two by a plane such that both parts are short and turn little: the place along the
 * direction is to tell most about places and normals. With S the covariance of places, T that of
 * places with normals, and c normals' weight, least squares along a direction d leave all of the
 * variance but (d'SSd + c d'TT'd) / d'Sd, which is greatest for an eigenvector of S + c inverse(S)
 * TT', found by power iteration. Where normals turn evenly along a curved patch, as on a tube, that
 * is across the tube rather than between its ends; on a flat one the longest direction.
 *
 * Against the longest direction alone (c = 0), on the scenes of sc-bench: CPU time of queries at
 * rest 0.62 on the horse, 0.77 to 0.86 on cats and bunny, 0.92 with spikes; on animations 0.84 to
 * 0.94; leaf clusters 0.98 to 1.00; time to build 0.94 to 1.00. A plane, for whatever sorts by
 * normals themselves, without least squares, has ragged borders: up to 5 % more memory, and builds
 * that take 15 to 30 % longer.
 *
 * One pass, in single precision over RUN triangles at a time, four numbers at once; sums of runs in
 * double. Normals weigh nothing where a patch lies flat.
 */
#ifndef SC_BUILD_DIRECTION_H
#define SC_BUILD_DIRECTION_H

#include "starcontour.h"

/* Of all triangles. */
typedef struct sc_facets {
    const float *centers; /* 3 a triangle, and one more: sums of its corners */
    const float *normals; /* 3 a triangle, and one more: unit, or 0 */
} sc_facets;

/* Of some triangles, one or more. turning: whether normals count; else it is the longest
   direction. */
void sc_direction_find(const sc_facets *facets, const uint32_t *triangles, uint32_t count,
                       int turning, float direction[3]);

static inline float sc_direction_along(const float *center, const float direction[3])
{
    return center[0] * direction[0] + center[1] * direction[1] + center[2] * direction[2];
}

#endif

/*
 * Discrete normal cones. See dnc.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "pose/dnc.h"

#include <math.h>

#include "pose/pose_kernels.h"

enum { HALF = SC_DNC_DIRECTIONS / 2 };

void sc_dnc_update(const sc_model *model, sc_workspace *w)
{
    const uint32_t *level_first = sc_model_level_first(model), *child = sc_model_child(model);
    const uint32_t *leaf_first = sc_model_leaf_first(model), *corner = sc_model_triangle(model);
    const sc_pose_kernels *kernels = sc_pose_kernels_of(w);
    uint32_t level, p, leaf, last = sc_model_first_leaf_patch(model);
    for (leaf = 0; leaf < model->leaf_count; leaf++)
        w->mask[last + leaf] = (uint16_t)kernels->cone(w, corner + 3 * (uint64_t)leaf_first[leaf],
                                                       leaf_first[leaf + 1] - leaf_first[leaf]);
    for (level = model->level_count - 1; level-- > 0;)
        for (p = level_first[level]; p + 1 < level_first[level + 1]; p++)
            w->mask[p] = w->mask[child[p]] & w->mask[child[p + 1] - 1];
}

int sc_dnc_validate(const sc_model *model, const sc_workspace *w)
{
    const uint32_t *level_first = sc_model_level_first(model), *leaf = sc_model_leaf(model);
    const sc_pose_kernels *kernels = sc_pose_kernels_of(w);
    uint32_t level, p, i;
    for (level = 0; level < model->level_count; level++)
        for (p = level_first[level]; p + 1 < level_first[level + 1]; p++) {
            uint32_t mask = (1u << SC_DNC_DIRECTIONS) - 1u;
            for (i = sc_model_leaf_first(model)[leaf[p]];
                 i < sc_model_leaf_first(model)[leaf[p + 1]]; i++)
                mask &= kernels->cone(w, sc_model_triangle(model) + 3 * (uint64_t)i, 1);
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
/* Sums of some of the diagonals (1, 1, 1), (1, 1, -1), (1, -1, 1), (1, -1, -1), which a mask has in bits 3 to 6, after
   the axes; their negatives come HALF bits later. */
static const signed char diagonals[16][3] = {
    {0, 0, 0},   {1, 1, 1}, {1, 1, -1}, {2, 2, 0},  {1, -1, 1}, {2, 0, 2},  {2, 0, 0},   {3, 1, 1},
    {1, -1, -1}, {2, 0, 0}, {2, 0, -2}, {3, 1, -1}, {2, -2, 0}, {3, -1, 1}, {3, -1, -1}, {4, 0, 0}};

void sc_dnc_projection(const sc_workspace *w, uint32_t mask, sc_projection *projection)
{
    static const double oblique[2][3] = {{5, 2, 11}, {11, 3, 2}};
    const double *h = oblique[0];
    double s[3], *u = projection->u, *v = projection->w;
    int k;
    for (k = 0; k < 3; k++)
        s[k] = 7 * ((int)(mask >> k & 1) - (int)(mask >> (HALF + k) & 1)) +
               4 * (diagonals[mask >> 3 & 15][k] - diagonals[mask >> (HALF + 3) & 15][k]);
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

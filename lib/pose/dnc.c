/*
 * Discrete normal cones. See dnc.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "base/bounds.h"
#include "pose/dnc.h"

#include <math.h>
#include <string.h>

#include "pose/levels.h"
#include "pose/pose_kernels.h"

enum { HALF = SC_DNC_DIRECTIONS / 2 };

/*
 * The cones of patches first to end - 1 of a level, from those of their children. Mostly sixteen
 * patches that follow each other have two children each, or one each, and then so do these; then
 * compilers make few instructions of them.
 */
static void join(uint16_t *mask, const uint32_t *child, uint32_t first, uint32_t end)
{
    uint32_t p, i;
    for (p = first; p + 16 <= end; p += 16) {
        const uint16_t *from = mask + child[p];
        uint32_t children = child[p + 16] - child[p];
        if (children == 32)
            for (i = 0; i < 16; i++) mask[p + i] = from[2 * i] & from[2 * i + 1];
        else if (children == 16)
            memcpy(mask + p, from, 16 * sizeof *mask);
        else
            for (i = p; i < p + 16; i++) mask[i] = mask[child[i]] & mask[child[i + 1] - 1];
    }
    for (; p < end; p++) mask[p] = mask[child[p]] & mask[child[p + 1] - 1];
}

typedef struct cones_pass {
    const sc_model *model;
    sc_frame *frame;
} cones_pass;

static void update_cones(void *context, uint32_t level, uint32_t first, uint32_t end)
{
    const cones_pass *pass = (const cones_pass *)context;
    const uint32_t leaves = sc_model_first_leaf_patch(pass->model);
    if (level + 1 < pass->model->level_count)
        join(pass->frame->mask, sc_model_child(pass->model), first, end);
    else
        pass->frame->kernels->pose->load_leaves(pass->model, pass->frame, first - leaves,
                                                end - leaves, 1);
}

void sc_dnc_update(const sc_model *model, sc_frame *frame)
{
    cones_pass pass;
    pass.model = model;
    pass.frame = frame;
    sc_levels_up(model, frame->tasks, update_cones, &pass);
    frame->leaves_ready = 1;
}

/* The cone of one triangle of a leaf cluster: as of a cluster of nothing else. */
static uint32_t cone_of_triangle(const sc_model *model, const sc_frame *frame, uint32_t leaf,
                                 uint32_t i)
{
    const uint8_t *corner = sc_model_leaf_corner(model) + 3 * SC_LEAF_MAX * (uint64_t)leaf;
    uint8_t where[3 * SC_LEAF_MAX];
    uint32_t k;
    for (k = 0; k < 3; k++)
        memset(where + SC_LEAF_MAX * k, corner[SC_LEAF_MAX * k + i], SC_LEAF_MAX);
    return frame->kernels->pose->cone(frame->point_at + 4 * SC_LEAF_POINTS * (uint64_t)leaf, where);
}

/* The cone of a leaf cluster by those of its triangles. */
static uint32_t cone_of_leaf(const sc_model *model, const sc_frame *frame, uint32_t leaf)
{
    const uint32_t *first = sc_model_leaf_first(model) + leaf;
    uint32_t mask = (1u << SC_DNC_DIRECTIONS) - 1u, i;
    for (i = 0; i < first[1] - first[0]; i++) mask &= cone_of_triangle(model, frame, leaf, i);
    return mask;
}

int sc_dnc_validate(const sc_model *model, const sc_frame *frame)
{
    const uint32_t *level_first = sc_model_level_first(model), *leaf = sc_model_leaf(model);
    const uint16_t *of_leaf = frame->mask + sc_model_first_leaf_patch(model);
    uint32_t level, p, l, any = 0;
    for (l = 0; l < model->leaf_count; l++) {
        const uint32_t mask = cone_of_leaf(model, frame, l), in = l % SC_CONES_GROUP;
        if (!in) any = 0;
        if (of_leaf[l] != (any || in < SC_CONES_SAMPLE ? mask : 0)) return 0;
        if (in < SC_CONES_SAMPLE) any |= mask;
    }
    for (level = 0; level < model->level_count; level++)
        for (p = level_first[level]; p + 1 < level_first[level + 1]; p++) {
            uint32_t mask = (1u << SC_DNC_DIRECTIONS) - 1u;
            for (l = leaf[p]; l < leaf[p + 1]; l++) mask &= of_leaf[l];
            if (mask != frame->mask[p]) return 0;
        }
    return 1;
}

/*
 * The direction s is a sum of integer vectors, faces and diagonals weighted by 7 and 4 because
 * 7 is about 4 sqrt(3). With u = s x h for an integer h and w = s x u, all of them integers,
 * u x w = |u|^2 s exactly: so a triangle whose normal has positive dot products with the summed
 * directions has a positive area in (u . p, w . p). h = (5, 2, 11) is oblique so that edges along
 * the axes become neither vertical nor horizontal, and along no sum s but 0, which has no positive
 * dot product with any normal. |s| <= 23,
 * |u| <= 506, |w| <= 23276 in each component.
 *
 * A computed coordinate u . (p - origin) collects one difference, one product, two additions: an
 * error of 4.01 * 2^-53 times the sum of |u_k| |p_k - origin_k|, at most |u|1 radius.
 */
static inline void find_vectors(uint32_t mask, float u[3], float w[3])
{
    int along[HALF], k; /* 1: a direction, -1: the one opposite, 0: neither, or both */
    float s[3];
    for (k = 0; k < HALF; k++) along[k] = (int)(mask >> k & 1) - (int)(mask >> (HALF + k) & 1);
    /* after the axes come the diagonals (1, 1, 1), (1, 1, -1), (1, -1, 1), (1, -1, -1) */
    s[0] = (float)(7 * along[0] + 4 * (along[3] + along[4] + along[5] + along[6]));
    s[1] = (float)(7 * along[1] + 4 * (along[3] + along[4] - along[5] - along[6]));
    s[2] = (float)(7 * along[2] + 4 * (along[3] - along[4] + along[5] - along[6]));
    u[0] = 11 * s[1] - 2 * s[2];
    u[1] = 5 * s[2] - 11 * s[0];
    u[2] = 2 * s[0] - 5 * s[1];
    w[0] = s[1] * u[2] - s[2] * u[1];
    w[1] = s[2] * u[0] - s[0] * u[2];
    w[2] = s[0] * u[1] - s[1] * u[0];
}

void sc_dnc_vectors(const uint16_t mask[SC_DNC_VECTORS], float u[3][SC_DNC_VECTORS],
                    float w[3][SC_DNC_VECTORS])
{
    int i, k;
    for (i = 0; i < SC_DNC_VECTORS; i++) {
        float one[3], other[3];
        find_vectors(mask[i], one, other);
        for (k = 0; k < 3; k++) {
            u[k][i] = one[k];
            w[k][i] = other[k];
        }
    }
}

void sc_dnc_projection(const sc_frame *frame, uint32_t mask, sc_projection *projection)
{
    float vector[2][3];
    double *u = projection->u, *v = projection->w;
    int k;
    find_vectors(mask, vector[0], vector[1]);
    for (k = 0; k < 3; k++) {
        u[k] = (double)vector[0][k];
        v[k] = (double)vector[1][k];
        projection->origin[k] = frame->center[k];
    }
    projection->x_error = 5 * SC_BOUNDS_U * (fabs(u[0]) + fabs(u[1]) + fabs(u[2])) * frame->radius;
    projection->y_error = 5 * SC_BOUNDS_U * (fabs(v[0]) + fabs(v[1]) + fabs(v[2])) * frame->radius;
}

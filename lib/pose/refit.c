/*
 * Boxes of triangles and patches for a pose. See refit.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "pose/refit.h"

static inline float smaller(float a, float b)
{
    return a < b ? a : b;
}

static inline float larger(float a, float b)
{
    return a > b ? a : b;
}

#if SC_BOXES_SSE2

/* Three lower and three upper bounds, moved one step outwards, as box number at of boxes. */
static inline void store_box(const sc_boxes *boxes, uint64_t at, __m128 low, __m128 high)
{
    const __m128 sign = _mm_set1_ps(-0.0f), unit = _mm_set1_ps(1.1920929e-7f);
    const __m128 least = _mm_set1_ps(FLT_MIN);
    float bounds[8];
    int k;
    low = _mm_sub_ps(low, _mm_add_ps(_mm_mul_ps(_mm_andnot_ps(sign, low), unit), least));
    high = _mm_add_ps(high, _mm_add_ps(_mm_mul_ps(_mm_andnot_ps(sign, high), unit), least));
    _mm_storeu_ps(bounds, low);
    _mm_storeu_ps(bounds + 4, high);
    for (k = 0; k < 3; k++) {
        boxes->side[k][at] = bounds[k];
        boxes->side[k + 3][at] = bounds[4 + k];
    }
}

static void refit_leaf(const sc_model *model, sc_workspace *w, uint32_t leaf, uint32_t patch)
{
    const uint32_t *corner =
        sc_model_triangle(model) + 3 * (uint64_t)sc_model_leaf_first(model)[leaf];
    uint32_t count = sc_model_leaf_first(model)[leaf + 1] - sc_model_leaf_first(model)[leaf], i;
    __m128 low = _mm_set1_ps(FLT_MAX), high = _mm_set1_ps(-FLT_MAX);
    for (i = 0; i < count; i++, corner += 3) {
        __m128 a = _mm_loadu_ps(w->unit + 4 * (uint64_t)corner[0]);
        __m128 b = _mm_loadu_ps(w->unit + 4 * (uint64_t)corner[1]);
        __m128 c = _mm_loadu_ps(w->unit + 4 * (uint64_t)corner[2]);
        __m128 lower = _mm_min_ps(a, _mm_min_ps(b, c)), upper = _mm_max_ps(a, _mm_max_ps(b, c));
        store_box(&w->triangle_boxes, (uint64_t)leaf * SC_LEAF_MAX + i, lower, upper);
        low = _mm_min_ps(low, lower);
        high = _mm_max_ps(high, upper);
    }
    store_box(&w->patch_boxes, patch, low, high);
}

#else

/* One step of rounding outwards, see base/boxes.h. */
static inline float step(float f)
{
    return (f < 0 ? -f : f) * 1.1920929e-7f + FLT_MIN;
}

static void refit_leaf(const sc_model *model, sc_workspace *w, uint32_t leaf, uint32_t patch)
{
    const uint32_t *corner =
        sc_model_triangle(model) + 3 * (uint64_t)sc_model_leaf_first(model)[leaf];
    uint32_t count = sc_model_leaf_first(model)[leaf + 1] - sc_model_leaf_first(model)[leaf], i;
    uint64_t at = (uint64_t)leaf * SC_LEAF_MAX;
    float low[3] = {FLT_MAX, FLT_MAX, FLT_MAX}, high[3] = {-FLT_MAX, -FLT_MAX, -FLT_MAX};
    int k;
    for (i = 0; i < count; i++, corner += 3, at++) {
        const float *a = w->unit + 4 * (uint64_t)corner[0];
        const float *b = w->unit + 4 * (uint64_t)corner[1];
        const float *c = w->unit + 4 * (uint64_t)corner[2];
        for (k = 0; k < 3; k++) {
            float lower = smaller(a[k], smaller(b[k], c[k]));
            float upper = larger(a[k], larger(b[k], c[k]));
            w->triangle_boxes.side[k][at] = lower - step(lower);
            w->triangle_boxes.side[k + 3][at] = upper + step(upper);
            low[k] = smaller(low[k], lower);
            high[k] = larger(high[k], upper);
        }
    }
    for (k = 0; k < 3; k++) {
        w->patch_boxes.side[k][patch] = low[k] - step(low[k]);
        w->patch_boxes.side[k + 3][patch] = high[k] + step(high[k]);
    }
}

#endif

void sc_refit_boxes(const sc_model *model, sc_workspace *w)
{
    const uint32_t *level_first = sc_model_level_first(model), *child = sc_model_child(model);
    uint32_t level, p, leaf, k;
    if (w->boxes_ready) return;
    for (leaf = 0; leaf < model->leaf_count; leaf++)
        refit_leaf(model, w, leaf, sc_model_first_leaf_patch(model) + leaf);
    for (level = model->level_count - 1; level-- > 0;)
        for (k = 0; k < 3; k++) {
            float *low = w->patch_boxes.side[k], *high = w->patch_boxes.side[k + 3];
            for (p = level_first[level]; p + 1 < level_first[level + 1]; p++) {
                uint32_t first = child[p], last = child[p + 1] - 1; /* one child, or two */
                low[p] = smaller(low[first], low[last]);
                high[p] = larger(high[first], high[last]);
            }
        }
    w->boxes_ready = 1;
}

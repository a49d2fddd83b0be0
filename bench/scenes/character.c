/*
 * A character with a skeleton; see character.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "scenes/character.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ------------------------------------------------------------------------------------------------
 * The body.
 */

enum { BONES = 15, SKIN_BONES = 4 };

/* A bone turns about its first point, with all bones that hang on it. low and high: limits of its
   angles about x, y and z, in radians. */
typedef struct bone {
    int parent; /* comes before it; -1: the root */
    double from[3], to[3];
    double thick[2]; /* radius at both ends */
    double low[3], high[3];
} bone;

/* The character looks along -y; its left is at +x. */
static const bone bones[BONES] = {
    /* pelvis, chest, head */
    {-1, {-0.06, 0, 0.98}, {0.06, 0, 0.98}, {0.13, 0.13}, {0, 0, 0}, {0, 0, 0}},
    {0, {0, 0, 1.12}, {0, 0, 1.38}, {0.13, 0.16}, {-0.3, -0.3, -0.5}, {0.7, 0.3, 0.5}},
    {1, {0, 0, 1.54}, {0, -0.02, 1.72}, {0.06, 0.12}, {-0.5, -0.4, -0.9}, {0.6, 0.4, 0.9}},
    /* upper arms, forearms, hands; left, right */
    {1, {0.2, 0, 1.44}, {0.47, 0, 1.44}, {0.065, 0.05}, {-0.6, -0.7, -1.4}, {0.6, 1.3, 0.5}},
    {1, {-0.2, 0, 1.44}, {-0.47, 0, 1.44}, {0.065, 0.05}, {-0.6, -1.3, -0.5}, {0.6, 0.7, 1.4}},
    {3, {0.47, 0, 1.44}, {0.72, 0, 1.44}, {0.048, 0.036}, {-0.6, 0, -1.6}, {0.6, 0, 0}},
    {4, {-0.47, 0, 1.44}, {-0.72, 0, 1.44}, {0.048, 0.036}, {-0.6, 0, 0}, {0.6, 0, 1.6}},
    {5, {0.74, 0, 1.44}, {0.88, 0, 1.44}, {0.036, 0.036}, {0, -0.6, -0.4}, {0, 0.6, 0.4}},
    {6, {-0.74, 0, 1.44}, {-0.88, 0, 1.44}, {0.036, 0.036}, {0, -0.6, -0.4}, {0, 0.6, 0.4}},
    /* thighs, shins, feet */
    {0, {0.11, 0, 0.9}, {0.16, 0, 0.5}, {0.09, 0.065}, {-1.5, -0.5, -0.3}, {0.4, 0.15, 0.3}},
    {0, {-0.11, 0, 0.9}, {-0.16, 0, 0.5}, {0.09, 0.065}, {-1.5, -0.15, -0.3}, {0.4, 0.5, 0.3}},
    {9, {0.16, 0, 0.5}, {0.19, 0.01, 0.1}, {0.062, 0.042}, {0, 0, 0}, {1.6, 0, 0}},
    {10, {-0.16, 0, 0.5}, {-0.19, 0.01, 0.1}, {0.062, 0.042}, {0, 0, 0}, {1.6, 0, 0}},
    {11, {0.19, 0, 0.06}, {0.21, -0.15, 0.05}, {0.045, 0.04}, {-0.4, 0, -0.3}, {0.6, 0, 0.3}},
    {12, {-0.19, 0, 0.06}, {-0.21, -0.15, 0.05}, {0.045, 0.04}, {-0.4, 0, -0.3}, {0.6, 0, 0.3}},
};

/* Bones blend within the first length; a vertex follows those that are not farther from it than the
   nearest one and the second. */
static const double blend = 0.03, follow = 0.06;

/* A box round the body. */
static const double box_low[3] = {-1.0, -0.3, -0.1}, box_high[3] = {1.0, 0.3, 1.95};

/* Distance to a bone's surface, negative inside. */
static double bone_distance(const bone *b, const double p[3])
{
    double along = 0, length = 0, sum = 0;
    for (int k = 0; k < 3; k++) {
        along += (p[k] - b->from[k]) * (b->to[k] - b->from[k]);
        length += (b->to[k] - b->from[k]) * (b->to[k] - b->from[k]);
    }
    along = fmin(fmax(along / length, 0), 1);
    for (int k = 0; k < 3; k++) {
        const double x = p[k] - b->from[k] - along * (b->to[k] - b->from[k]);
        sum += x * x;
    }
    return sqrt(sum) - b->thick[0] - along * (b->thick[1] - b->thick[0]);
}

/* Negative in the body: the least distance, rounded off where two bones are as near. */
static double body(const double p[3])
{
    double least = HUGE_VAL;
    for (int b = 0; b < BONES; b++) {
        const double d = bone_distance(&bones[b], p);
        const double near = fmax(blend - fabs(d - least), 0) / blend;
        least = fmin(d, least) - near * near * blend / 4;
    }
    return least;
}

/* ------------------------------------------------------------------------------------------------
 * The surface, by surface nets.
 */

typedef struct grid {
    uint32_t size[3]; /* points along each axis */
    double step;
    double *value; /* of the body, at each point, x fastest */
} grid;

static size_t grid_index(const grid *g, const uint32_t at[3])
{
    return at[0] + (size_t)g->size[0] * (at[1] + (size_t)g->size[1] * at[2]);
}

static bool grid_fill(grid *g, double step)
{
    g->step = step;
    for (int k = 0; k < 3; k++) g->size[k] = (uint32_t)ceil((box_high[k] - box_low[k]) / step) + 1;
    free(g->value);
    g->value = (double *)malloc(sizeof(double) * g->size[0] * g->size[1] * g->size[2]);
    if (!g->value) return false;
    for (uint32_t at[3] = {0, 0, 0}; at[2] < g->size[2]; at[2]++) {
        for (at[1] = 0; at[1] < g->size[1]; at[1]++) {
            for (at[0] = 0; at[0] < g->size[0]; at[0]++) {
                const double p[3] = {box_low[0] + at[0] * step, box_low[1] + at[1] * step,
                                     box_low[2] + at[2] * step};
                g->value[grid_index(g, at)] = body(p);
            }
        }
    }
    return true;
}

/* How many edges of the grid the surface cuts: half as many as there are triangles. */
static uint32_t grid_cuts(const grid *g)
{
    uint32_t cuts = 0;
    for (uint32_t at[3] = {0, 0, 0}; at[2] < g->size[2]; at[2]++) {
        for (at[1] = 0; at[1] < g->size[1]; at[1]++) {
            for (at[0] = 0; at[0] < g->size[0]; at[0]++) {
                for (int axis = 0; axis < 3; axis++) {
                    uint32_t next[3] = {at[0], at[1], at[2]};
                    if (++next[axis] == g->size[axis]) continue;
                    cuts +=
                        (g->value[grid_index(g, at)] < 0) != (g->value[grid_index(g, next)] < 0);
                }
            }
        }
    }
    return cuts;
}

/* The vertex of a cell: the mean of where the surface cuts the cell's edges; false if it does not
   cut any. */
static bool cell_vertex(const grid *g, const uint32_t at[3], float *vertex)
{
    double sum[3] = {0, 0, 0};
    int cuts = 0;
    for (int axis = 0; axis < 3; axis++) {
        for (uint32_t side = 0; side < 4; side++) {
            uint32_t a[3] = {at[0], at[1], at[2]}, b[3];
            double low, high, part;
            a[(axis + 1) % 3] += side & 1;
            a[(axis + 2) % 3] += side >> 1;
            memcpy(b, a, sizeof b);
            b[axis]++;
            low = g->value[grid_index(g, a)];
            high = g->value[grid_index(g, b)];
            if ((low < 0) == (high < 0)) continue;
            part = low / (low - high);
            for (int k = 0; k < 3; k++) sum[k] += a[k] + (k == axis ? part : 0);
            cuts++;
        }
    }
    for (int k = 0; k < 3 && cuts; k++) vertex[k] = (float)(box_low[k] + g->step * sum[k] / cuts);
    return cuts > 0;
}

static double square_distance(const float *a, const float *b)
{
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        const double x = (double)a[k] - (double)b[k];
        sum += x * x;
    }
    return sum;
}

/* Two triangles, cut along the shorter diagonal of a quad. */
static void add_quad(character *made, const uint32_t v[4])
{
    const float *const p = made->rest;
    const double first = square_distance(p + 3 * (size_t)v[0], p + 3 * (size_t)v[2]);
    const uint32_t turn =
        first <= square_distance(p + 3 * (size_t)v[1], p + 3 * (size_t)v[3]) ? 0 : 1;
    const uint32_t two[6] = {v[turn], v[turn + 1], v[turn + 2],
                             v[turn], v[turn + 2], v[(turn + 3) % 4]};
    memcpy(made->triangles + 3 * (size_t)made->triangle_count, two, sizeof two);
    made->triangle_count += 2;
}

/* Vertices of all cells into numbers, and then a quad round each edge that is cut. The box is large
   enough that the cells round such an edge are all there. */
static void net(const grid *g, character *made, uint32_t *numbers)
{
    for (uint32_t at[3] = {0, 0, 0}; at[2] + 1 < g->size[2]; at[2]++) {
        for (at[1] = 0; at[1] + 1 < g->size[1]; at[1]++) {
            for (at[0] = 0; at[0] + 1 < g->size[0]; at[0]++) {
                if (!cell_vertex(g, at, made->rest + 3 * (size_t)made->vertex_count)) continue;
                numbers[grid_index(g, at)] = made->vertex_count++;
            }
        }
    }
    for (uint32_t at[3] = {0, 0, 0}; at[2] < g->size[2]; at[2]++) {
        for (at[1] = 0; at[1] < g->size[1]; at[1]++) {
            for (at[0] = 0; at[0] < g->size[0]; at[0]++) {
                for (int axis = 0; axis < 3; axis++) {
                    const int one = (axis + 1) % 3, other = (axis + 2) % 3;
                    uint32_t next[3] = {at[0], at[1], at[2]}, quad[4];
                    bool inside;
                    if (++next[axis] == g->size[axis]) continue;
                    inside = g->value[grid_index(g, at)] < 0;
                    if (inside == (g->value[grid_index(g, next)] < 0)) continue;
                    for (uint32_t k = 0; k < 4; k++) {
                        uint32_t cell[3] = {at[0], at[1], at[2]};
                        /* counter-clockwise, seen from the edge's end, where the outside is */
                        const uint32_t c = inside ? k : 3 - k;
                        cell[one] -= c == 0 || c == 3;
                        cell[other] -= c < 2;
                        quad[k] = numbers[grid_index(g, cell)];
                    }
                    add_quad(made, quad);
                }
            }
        }
    }
}

/* ------------------------------------------------------------------------------------------------
 * Skinning.
 */

/* Which bones a vertex follows, and by how much each, 1 in all. */
typedef struct character_skin {
    uint8_t bone[SKIN_BONES];
    float weight[SKIN_BONES];
} character_skin;

/* Keeps the heaviest. */
static void add_bone(character_skin *skin, uint8_t b, double weight)
{
    int at = SKIN_BONES;
    while (at > 0 && (double)skin->weight[at - 1] < weight) at--;
    if (at == SKIN_BONES) return;
    memmove(skin->bone + at + 1, skin->bone + at, (size_t)(SKIN_BONES - 1 - at));
    memmove(skin->weight + at + 1, skin->weight + at,
            (size_t)(SKIN_BONES - 1 - at) * sizeof *skin->weight);
    skin->bone[at] = b;
    skin->weight[at] = (float)weight;
}

static void skin_vertex(character_skin *skin, const float *vertex)
{
    const double p[3] = {(double)vertex[0], (double)vertex[1], (double)vertex[2]};
    double at[BONES], least = HUGE_VAL;
    float sum = 0;
    memset(skin, 0, sizeof *skin);
    for (int b = 0; b < BONES; b++) {
        at[b] = bone_distance(&bones[b], p);
        least = fmin(least, at[b]);
    }
    for (uint8_t b = 0; b < BONES; b++) {
        const double part = fmax(1 - (at[b] - least) / follow, 0);
        if (part > 0) add_bone(skin, b, part * part);
    }
    for (int k = 0; k < SKIN_BONES; k++) sum += skin->weight[k];
    for (int k = 0; k < SKIN_BONES; k++) skin->weight[k] /= sum;
}

/* From 0 to below 1: a number for each pose and angle (splitmix64). */
static double draw(uint64_t number, uint64_t angle)
{
    uint64_t h = number * 64 + angle + 1;
    h *= UINT64_C(0x9e3779b97f4a7c15);
    h = (h ^ h >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    h = (h ^ h >> 27) * UINT64_C(0x94d049bb133111eb);
    return (double)((h ^ h >> 31) >> 11) / 9007199254740992.0; /* 53 bits */
}

/* Three rows of four: a turn and a move. */
typedef double motion[12];

/* out = a of b. */
static void chain(const motion a, const motion b, motion out)
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) {
            double sum = j == 3 ? a[4 * i + 3] : 0;
            for (int k = 0; k < 3; k++) sum += a[4 * i + k] * b[4 * k + j];
            out[4 * i + j] = sum;
        }
    }
}

/* Turns about a point, by angles about x, then y, then z. */
static void turn(const double point[3], const double angles[3], motion out)
{
    motion whole = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    for (int axis = 0; axis < 3; axis++) {
        const double c = cos(angles[axis]), s = sin(angles[axis]);
        const int i = (axis + 1) % 3, j = (axis + 2) % 3;
        motion one = {0}, both;
        one[5 * axis] = 1;
        one[5 * i] = one[5 * j] = c;
        one[4 * i + j] = -s;
        one[4 * j + i] = s;
        chain(one, whole, both);
        memcpy(whole, both, sizeof both);
    }
    for (int k = 0; k < 3; k++) {
        whole[4 * k + 3] = point[k];
        for (int j = 0; j < 3; j++) whole[4 * k + 3] -= whole[4 * k + j] * point[j];
    }
    memcpy(out, whole, sizeof whole);
}

void character_pose(const character *of, uint64_t number, float *positions)
{
    motion moved[BONES];
    for (int b = 0; b < BONES; b++) {
        double angles[3];
        motion own;
        for (int k = 0; k < 3; k++)
            angles[k] = bones[b].low[k] +
                        (bones[b].high[k] - bones[b].low[k]) * draw(number, (uint64_t)(3 * b + k));
        turn(bones[b].from, angles, own);
        if (bones[b].parent < 0)
            memcpy(moved[b], own, sizeof own);
        else
            chain(moved[bones[b].parent], own, moved[b]);
    }
    for (size_t v = 0; v < of->vertex_count; v++) {
        const character_skin *const skin = &of->skins[v];
        const float *const p = of->rest + 3 * v;
        for (int i = 0; i < 3; i++) {
            double sum = 0;
            for (int k = 0; k < SKIN_BONES && skin->weight[k] > 0; k++) {
                const double *const row = moved[skin->bone[k]] + (size_t)4 * (size_t)i;
                sum += (double)skin->weight[k] * (row[0] * (double)p[0] + row[1] * (double)p[1] +
                                                  row[2] * (double)p[2] + row[3]);
            }
            positions[3 * v + (size_t)i] = (float)sum;
        }
    }
}

/* ------------------------------------------------------------------------------------------------
 * Making one.
 */

bool character_make(character *made, uint32_t triangles)
{
    grid g = {{0, 0, 0}, 0, NULL};
    double step = 0.015 * sqrt(25000.0 / triangles); /* what that many took */
    uint32_t *numbers = NULL;
    uint32_t cuts = 0;
    bool good = true;
    memset(made, 0, sizeof *made);
    for (int trial = 0; trial < 8 && good; trial++) {
        good = grid_fill(&g, step);
        if (!good) break;
        cuts = grid_cuts(&g);
        if (fabs(2.0 * cuts / triangles - 1) < 0.01) break;
        step *= sqrt(2.0 * cuts / triangles);
    }
    if (good) {
        const size_t points = (size_t)g.size[0] * g.size[1] * g.size[2];
        numbers = (uint32_t *)malloc(points * sizeof *numbers);
        made->triangles = (uint32_t *)malloc(6 * (size_t)cuts * sizeof *made->triangles);
        /* a quad has no more new vertices than corners */
        made->rest = (float *)malloc(12 * (size_t)cuts * sizeof *made->rest);
        good = numbers && made->triangles && made->rest;
    }
    if (good) {
        net(&g, made, numbers);
        made->skins = (character_skin *)malloc(made->vertex_count * sizeof(struct character_skin));
        good = made->skins != NULL;
    }
    for (size_t v = 0; v < made->vertex_count && good; v++)
        skin_vertex(&made->skins[v], made->rest + 3 * v);
    free(numbers);
    free(g.value);
    return good;
}

void character_free(character *made)
{
    free(made->triangles);
    free(made->rest);
    free(made->skins);
    memset(made, 0, sizeof *made);
}

/*
 * Slabs: the space between two planes across a direction. Where points are along it, for queries
 * and, at both ends of a step, for steps.
 *
 * SPDX-License-Identifier: MIT
 *
 * Everything is computed in single precision on points in the unit box, see SC_BOUNDS_PLACES.
 */

/* Where points are along directions. */
static inline lanes places_along(const lanes direction[3], const lanes at[3])
{
    return lanes_add(
        lanes_add(lanes_multiply(direction[0], at[0]), lanes_multiply(direction[1], at[1])),
        lanes_multiply(direction[2], at[2]));
}

/* How far the places of two points along a direction, and an end of a slab, may be off. */
static inline float slab_reach(const float direction[3])
{
    float reach = 16 * FLT_MIN;
    int c;
    for (c = 0; c < 3; c++) reach += SC_BOUNDS_PLACES * fabsf(direction[c]);
    return reach;
}

/* The sides of triangles from their first corners x[0], and their normals. */
static inline void sides_and_normals(lanes x[3][3], lanes e[3], lanes f[3], lanes n[3])
{
    int c;
    SC_UNROLL
    for (c = 0; c < 3; c++) {
        e[c] = lanes_subtract(x[1][c], x[0][c]);
        f[c] = lanes_subtract(x[2][c], x[0][c]);
    }
    SC_UNROLL
    for (c = 0; c < 3; c++)
        n[c] = lanes_subtract(lanes_multiply(e[(c + 1) % 3], f[(c + 2) % 3]),
                              lanes_multiply(e[(c + 2) % 3], f[(c + 1) % 3]));
}

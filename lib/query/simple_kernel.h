/*
 * Which edges of a projected contour have to be looked at: those whose boxes overlap. See simple.h.
 *
 * SPDX-License-Identifier: MIT
 */

/* Bit k: box i overlaps box j + k, for k from 0 to 15. */
static inline unsigned SC_KERNEL(overlap_in_plane)(float *const side[4], uint32_t i, uint32_t j)
{
    lanes_mask x =
        lanes_both(lanes_not_above(lanes_all(side[SC_LOW_X][i]), lanes_load(side[SC_HIGH_X] + j)),
                   lanes_not_above(lanes_load(side[SC_LOW_X] + j), lanes_all(side[SC_HIGH_X][i])));
    lanes_mask y =
        lanes_both(lanes_not_above(lanes_all(side[SC_LOW_Y][i]), lanes_load(side[SC_HIGH_Y] + j)),
                   lanes_not_above(lanes_load(side[SC_LOW_Y] + j), lanes_all(side[SC_HIGH_Y][i])));
    return lanes_bits(lanes_both(x, y));
}

/* Places of the listed points, and the error of their coordinates, see choose_axes in simple.c. */
static void SC_KERNEL(project)(sc_simple_contour *c, const float *unit)
{
    const sc_contour_edges *e = c->edges;
    lanes size = lanes_all(0), d[3], at;
    uint32_t i, j;
    int k;
    /* one block more, for the ends of the last edges */
    for (i = 0; i < (c->blocks + 1) * SC_CONTOUR_BLOCK; i += SC_CONTOUR_BLOCK) {
        const float *point[SC_CONTOUR_BLOCK];
        for (j = 0; j < SC_CONTOUR_BLOCK; j++) point[j] = unit + 4 * (uint64_t)e->point[i + j];
        lanes_points(point, &d[0], &d[1], &d[2]);
        for (k = 0; k < 3; k++) {
            d[k] = lanes_subtract(d[k], lanes_all(c->from[k]));
            size = lanes_larger(size, lanes_absolute(d[k]));
        }
        for (k = 0; k < 2; k++) {
            at = lanes_add(lanes_add(lanes_multiply(lanes_all(c->axis[k][0]), d[0]),
                                     lanes_multiply(lanes_all(c->axis[k][1]), d[1])),
                           lanes_multiply(lanes_all(c->axis[k][2]), d[2]));
            lanes_store(e->at[k] + i, at);
        }
    }
    c->error = 3.01e-8f + 4.1f * 5.9604644775390625e-8f * lanes_most(size);
}

/*
 * Boxes of the edges of a block and its own, two errors larger than computed: one for the places of
 * points, and one, 2^-24 of a coordinate or more, for the rounding here. Where there is no edge, the box overlaps nothing.
 */
static void SC_KERNEL(enclose)(const sc_simple_contour *c, uint32_t block)
{
    const sc_contour_edges *e = c->edges;
    const lanes margin = lanes_all(2 * c->error);
    uint32_t i = block * SC_CONTOUR_BLOCK;
    unsigned none = ~(unsigned)e->is_edge[block] & 0xffffu;
    int k;
    for (k = 0; k < 2; k++) {
        float *low = e->side[2 * k] + i, *high = e->side[2 * k + 1] + i;
        lanes from = lanes_load(e->at[k] + i), to = lanes_load(e->at[k] + i + 1);
        unsigned rest;
        lanes_store(low, lanes_subtract(lanes_smaller(from, to), margin));
        lanes_store(high, lanes_add(lanes_larger(from, to), margin));
        for (rest = none; rest; rest &= rest - 1) {
            low[sc_bits_lowest(rest)] = HUGE_VALF;
            high[sc_bits_lowest(rest)] = -HUGE_VALF;
        }
        e->block_side[2 * k][block] = lanes_least(lanes_load(low));
        e->block_side[2 * k + 1][block] = lanes_most(lanes_load(high));
    }
}

/*
 * Bits of the edges of a block that lead into the next edge; *open: 0 if one of these may fold back on its
 * next. See is_open in simple.c: with a = -v and b = w, a x b != 0 or a . b < 0 for certain.
 */
static unsigned SC_KERNEL(chain)(const sc_simple_contour *c, uint32_t block, int *open)
{
    const sc_contour_edges *e = c->edges;
    const lanes least = lanes_all(4 * c->error), factor = lanes_all(SC_SIMPLE_BOUND * c->error);
    uint32_t i = block * SC_CONTOUR_BLOCK;
    unsigned both = (unsigned)e->is_edge[block] &
                    ((unsigned)e->is_edge[block] >> 1 | (unsigned)e->is_edge[block + 1] << 15);
    lanes v[2], w[2], size, bound, cross, dot;
    int k;
    both &= 255u;
    for (k = 0; k < 2; k++) {
        lanes middle = lanes_load(e->at[k] + i + 1);
        v[k] = lanes_subtract(middle, lanes_load(e->at[k] + i));
        w[k] = lanes_subtract(lanes_load(e->at[k] + i + 2), middle);
    }
    size = lanes_add(lanes_add(lanes_absolute(v[0]), lanes_absolute(v[1])),
                     lanes_add(lanes_absolute(w[0]), lanes_absolute(w[1])));
    bound = lanes_add(lanes_multiply(factor, lanes_add(size, least)), lanes_all(FLT_MIN));
    cross = lanes_subtract(lanes_multiply(v[0], w[1]), lanes_multiply(v[1], w[0]));
    dot = lanes_add(lanes_multiply(v[0], w[0]), lanes_multiply(v[1], w[1]));
    *open = (both & ~(lanes_bits(lanes_below(bound, lanes_absolute(cross))) |
                      lanes_bits(lanes_below(bound, dot)))) == 0;
    return both;
}

static int SC_KERNEL(are_edges_fine)(sc_simple_contour *c)
{
    const sc_contour_edges *e = c->edges;
    uint32_t a, b, i;
    for (a = 0; a < c->blocks; a++) SC_KERNEL(enclose)(c, a);
    for (; a < c->blocks + SC_CONTOUR_BLOCK; a++) {
        e->block_side[SC_LOW_X][a] = e->block_side[SC_LOW_Y][a] = HUGE_VALF;
        e->block_side[SC_HIGH_X][a] = e->block_side[SC_HIGH_Y][a] = -HUGE_VALF;
    }
    for (a = 0; a < c->blocks; a++) {
        int open;
        unsigned chain = SC_KERNEL(chain)(c, a, &open);
        if (!open) return 0;
        for (b = a; b < c->blocks; b += SC_CONTOUR_BLOCK) {
            unsigned blocks = SC_KERNEL(overlap_in_plane)(e->block_side, a, b);
            for (; blocks; blocks &= blocks - 1) {
                uint32_t other = b + sc_bits_lowest(blocks), rest = e->is_edge[a];
                for (; rest; rest &= rest - 1) {
                    unsigned bit = sc_bits_lowest(rest), near;
                    i = a * SC_CONTOUR_BLOCK + bit;
                    near = SC_KERNEL(overlap_in_plane)(e->side, i, other * SC_CONTOUR_BLOCK);
                    if (other == a)
                        near &= ~((2u << bit) - 1u) & ~((chain >> bit & 1u) << (bit + 1));
                    if (other == a + 1 && bit == SC_CONTOUR_BLOCK - 1)
                        near &= ~(chain >> (SC_CONTOUR_BLOCK - 1));
                    for (; near; near &= near - 1)
                        if (!sc_simple_are_apart(c, i,
                                                 other * SC_CONTOUR_BLOCK + sc_bits_lowest(near)))
                            return 0;
                }
            }
        }
    }
    return 1;
}

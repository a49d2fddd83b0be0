/*
 * Which edges of a projected contour have to be looked at: those whose boxes overlap. See simple.h.
 *
 * SPDX-License-Identifier: MIT
 */

/* Bit k: box i overlaps box j + k, for k from 0 to 7. */
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

static int SC_KERNEL(are_edges_fine)(sc_simple_contour *c)
{
    const sc_contour_edges *e = c->edges;
    uint32_t a, b, i;
    for (a = 0; a < c->blocks; a++)
        for (b = a; b < c->blocks; b += 8) {
            unsigned blocks = SC_KERNEL(overlap_in_plane)(e->block_side, a, b);
            for (; blocks; blocks &= blocks - 1) {
                uint32_t other = (b + sc_bits_lowest(blocks)) * SC_CONTOUR_BLOCK;
                uint32_t end = (a + 1) * SC_CONTOUR_BLOCK;
                if (end > c->count) end = c->count;
                for (i = a * SC_CONTOUR_BLOCK; i < end; i++) {
                    unsigned near = SC_KERNEL(overlap_in_plane)(e->side, i, other);
                    if (other / SC_CONTOUR_BLOCK == a) near &= ~((2u << i % SC_CONTOUR_BLOCK) - 1u);
                    for (; near; near &= near - 1)
                        if (!sc_simple_are_apart(c, i, other + sc_bits_lowest(near))) return 0;
                }
            }
        }
    return 1;
}

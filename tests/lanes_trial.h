/*
 * Does all that simd/lanes.h can do, once, and writes down what comes out: LANES_TRY, for the
 * instruction set that SC_LANES says. Included for each of them by a file; see test_lanes.c.
 *
 * SPDX-License-Identifier: MIT
 */
#include "lanes_trial_types.h"

#include "simd/target_begin.h"

#include "simd/lanes.h"

static void try_floats(const lanes_input *in, lanes_outcome *out)
{
    lanes a = lanes_load(in->a), b = lanes_load(in->b), evens = lanes_load(in->plain);
    lanes odds = lanes_load(in->plain + 1);
    lanes_mask below = lanes_below(a, b), most = lanes_not_above(a, b);
    lanes_mask once = lanes_below(lanes_all(in->a[0]), lanes_all(in->b[0]));
    const float *point[SC_LANES_COUNT];
    uint32_t rows[SC_LANES_COUNT];
    uint16_t wide[SC_LANES_COUNT];
    lanes x[3];
    int i;
    lanes_store(out->row[0], lanes_add(evens, odds));
    lanes_store(out->row[1], lanes_subtract(evens, odds));
    lanes_store(out->row[2], lanes_multiply(evens, odds));
    lanes_store(out->row[76], lanes_divide(evens, odds));
    lanes_store(out->row[3], lanes_smaller(a, b));
    lanes_store(out->row[4], lanes_larger(a, b));
    lanes_store(out->row[5], lanes_absolute(a));
    lanes_store(out->row[6], lanes_largest_size(evens, odds, lanes_load(in->plain + 2)));
    lanes_store(out->row[7], lanes_evens(a, b));
    lanes_store(out->row[8], lanes_odds(a, b));
    lanes_store(out->row[63], b);
    lanes_store_half(out->row[63], a);
    lanes_store(out->row[9], lanes_all(in->a[3]));
    lanes_store(out->row[10], lanes_four(in->a));
    lanes_store(out->row[11], lanes_each_four(in->a));
    lanes_store_least(out->row[12], evens);
    lanes_store_most(out->row[13], evens);
    for (i = 0; i < SC_LANES_COUNT; i++) point[i] = in->plain + in->number[i];
    lanes_points(point, &x[0], &x[1], &x[2]);
    for (i = 0; i < 3; i++) lanes_store(out->row[14 + i], x[i]);
    for (i = 0; i < SC_LANES_COUNT; i++) wide[i] = (uint16_t)(in->number[i] << in->number[i] % 13);
    lanes_numbers(out->numbers, wide, 3u << in->number[0], in->mask, (uint32_t)in->number[1] << 16);
    for (i = 0; i < SC_LANES_COUNT; i++) rows[i] = in->number[i] % 15u;
    lanes_rows(in->plain + 1, rows, &x[0], &x[1], &x[2]);
    for (i = 0; i < 3; i++) lanes_store(out->row[48 + i], x[i]);
    lanes_coordinates(in->plain, x);
    for (i = 0; i < 3; i++) lanes_store(out->row[30 + i], x[i]);
    out->one[0] = lanes_sum(evens);
    out->one[1] = lanes_least(evens);
    out->one[2] = lanes_most(evens);
    out->bits[0] = lanes_bits(below);
    out->bits[1] = lanes_bits(most);
    out->bits[2] = lanes_bits(lanes_both(below, most));
    out->bits[3] = (unsigned)lanes_every(most);
    out->bits[4] = (unsigned)lanes_every(once);
}

static void try_picks(const lanes_input *in, lanes_outcome *out)
{
    const float *const row[2] = {in->a, in->b}, *const points[2] = {in->plain, in->row[0]};
    const uint8_t *const corners[2] = {in->number, in->other};
    lanes a = lanes_load(in->a), b = lanes_load(in->b), corner[3][3], both[2];
    lanes_index number[3];
    lanes_mask mask[3];
    uint8_t list[SC_LANES_COUNT];
    uint32_t pairs[2 * SC_LANES_COUNT];
    uint16_t wide[SC_LANES_COUNT];
    int i, k;
    lanes_store(out->row[17], lanes_pick(in->a, lanes_index_load(in->number)));
    lanes_store(out->row[18], lanes_pick_of(b, lanes_index_load(in->number + SC_LANES_COUNT)));
    lanes_store(out->row[19],
                lanes_pick_of(a, lanes_index_through(in->number, in->number + SC_LANES_COUNT)));
    lanes_store(out->row[20], lanes_choose(lanes_below(a, b), a, b));
    both[0] = a;
    both[1] = b;
    for (i = 0; i < SC_LANES_COUNT; i++)
        list[i] = (uint8_t)(in->number[i] + 16 * (in->mask >> i & 1u));
    lanes_store(out->row[75], lanes_pick_both(both, list));
    lanes_corners_at(in->plain, in->number, corner);
    for (k = 0; k < 3; k++)
        for (i = 0; i < 3; i++) lanes_store(out->row[21 + 3 * k + i], corner[k][i]);
    lanes_corners_through(in->plain, in->number, in->through, corner);
    for (k = 0; k < 3; k++)
        for (i = 0; i < 3; i++) lanes_store(out->row[39 + 3 * k + i], corner[k][i]);
    lanes_store(out->row[65], lanes_pick_two(row, lanes_index_load(in->number), in->split));
    lanes_corners_two(points, corners, in->through, in->split, corner);
    for (k = 0; k < 3; k++)
        for (i = 0; i < 3; i++) lanes_store(out->row[66 + 3 * k + i], corner[k][i]);
    out->bits[19] = lanes_bits(lanes_from(in->split));
    out->bits[5] = lanes_list(in->mask, list);
    memcpy(out->list, list, out->bits[5]);
    out->bits[18] = lanes_list_from(in->mask, in->names[0], pairs);
    memcpy(out->from, pairs, out->bits[18] * sizeof *pairs);
    out->bits[20] = lanes_list_among(in->apart, in->split, in->names[0], in->mask, in->first[0],
                                     pairs, &out->bits[21]);
    memcpy(out->among, pairs, out->bits[20] * sizeof *pairs);
    lanes_list_bits(in->mask, in->bits, wide);
    memcpy(out->wide, wide, out->bits[5] * sizeof *wide);
    i = (int)lanes_list_pairs(in->mask, in->bits[0], in->number, in->first, in->through,
                              in->first + 2, pairs);
    memcpy(out->pairs, pairs, 2 * (unsigned)i * sizeof *pairs);
    for (i = 0; i < 3; i++) number[i] = lanes_index_load(in->number + SC_LANES_COUNT * i);
    mask[0] = lanes_below(a, b);
    mask[1] = lanes_below(b, a);
    mask[2] = lanes_below(lanes_load(in->plain), lanes_load(in->plain + 16));
    out->bits[16] = lanes_marked(number, mask);
    out->bits[17] = lanes_among(number[0], in->mask);
}

static void try_bytes(const lanes_input *in, lanes_outcome *out)
{
    lanes_bytes a = lanes_bytes_load(in->number), b = lanes_bytes_load(in->through), row[3];
    lanes_bytes same = lanes_bytes_same(a, b), other;
    lanes_bytes quarter[4];
    lanes_triples triples;
    lanes edge[2][2][3];
    uint32_t kept[3][24];
    int i, k;
    for (k = 0; k < 3; k++) row[k] = lanes_bytes_load(in->number + SC_LANES_COUNT * k);
    other = lanes_bytes_same(row[1], row[2]);
    lanes_bytes_store(out->bytes[0], same);
    lanes_bytes_store(out->bytes[1], lanes_bytes_both(a, b));
    lanes_bytes_store(out->bytes[2], lanes_bytes_either(same, other));
    lanes_bytes_store(out->bytes[3], lanes_bytes_but(a, b));
    lanes_bytes_store(out->bytes[4], lanes_bytes_choose(other, a, b));
    lanes_bytes_store(out->bytes[5], lanes_bytes_through(a, b));
    lanes_store(out->row[64], lanes_pick(in->a, lanes_index_of(b)));
    lanes_bytes_store(out->bytes[6], lanes_names(in->names, in->names + SC_LANES_COUNT));
    out->bits[14] = lanes_bytes_bits(same);
    out->bits[15] =
        lanes_bits(lanes_same(lanes_load((const float *)(const void *)in->names),
                              lanes_load((const float *)(const void *)(in->names + 16))));
    lanes_edges_of(in->plain, in->row[0], row, row + 1, edge);
    for (i = 0; i < 12; i++) lanes_store(out->row[51 + i], edge[i / 6][i / 3 % 2][i % 3]);
    triples = lanes_triples_of(row);
    lanes_triples_through(&triples, in->through, row);
    for (k = 0; k < 3; k++) lanes_bytes_store(out->bytes[7 + k], row[k]);
    lanes_bytes_quarters(in->words, quarter);
    for (k = 0; k < 4; k++) lanes_bytes_store(out->bytes[10 + k], quarter[k]);
    lanes_bytes_store(out->bytes[14], lanes_bytes_all(in->number[0]));
    lanes_list_rows(in->mask, quarter, in->names, 3, kept[0], 24);
    for (k = 0; k < 3; k++) memcpy(out->kept[k], kept[k], sc_bits_count(in->mask) * sizeof **kept);
}

static void try_sets(const lanes_input *in, lanes_outcome *out)
{
    const lanes_sets one = lanes_sets_of(in->number);
    const lanes_sets both = lanes_sets_join(one, lanes_sets_of(in->number + SC_LANES_COUNT));
    out->bits[24] = lanes_within(one, in->mask);
    out->bits[25] = lanes_within(both, in->mask);
    out->bits[26] = lanes_within(lanes_sets_load(in->words), in->mask | in->words[0]);
    out->bits[27] = lanes_holding(lanes_sets_load(in->words), in->words[0] & in->words[1]);
    out->bits[28] = lanes_sets_all(both, in->mask);
}

static void try_cells(const lanes_input *in, lanes_outcome *out)
{
    float at[4][SC_LANES_COUNT];
    lanes_cells cell[2], box, reach, noted = lanes_cells_none();
    int i, k;
    for (k = 0; k < 4; k++)
        for (i = 0; i < SC_LANES_COUNT; i++) at[k][i] = 8388608.0f + (float)in->cell[k][i];
    for (k = 0; k < 2; k++) {
        cell[k] = lanes_cells_of(lanes_load(at[k]), lanes_load(at[2 + k]));
        lanes_cells_store(out->cells[k], cell[k]);
    }
    box = lanes_cells_joined(cell[0], cell[1]);
    reach = lanes_cells_reach(box);
    lanes_cells_store(out->cells[2], box);
    lanes_cells_store(out->cells[3], reach);
    lanes_cells_store(out->cells[4], lanes_cells_all(out->cells[0][0]));
    noted = lanes_cells_note(noted, lanes_cells_load(out->cells[4]), reach);
    out->bits[22] = lanes_cells_noted(noted);
    out->bits[23] =
        lanes_cells_noted(lanes_cells_note(noted, lanes_cells_all(out->cells[0][1]), reach));
}

static void try_rows(const lanes_input *in, lanes_outcome *out)
{
    lanes_signs row[16];
    lanes ends[6];
    int i;
    for (i = 0; i < 16; i++) row[i] = lanes_signs_of(lanes_load(in->row[i]));
    out->bits[6] = lanes_all_negative(row);
    lanes_rows_ends(in->row[0], LANES_STRIDE, ends, ends + 3); /* rows that share floats */
    for (i = 0; i < 6; i++) lanes_store(out->row[33 + i], ends[i]);
}

static void try_doubles(const lanes_input *in, lanes_outcome *out)
{
    doubles a = doubles_load(in->c), b = doubles_load(in->d), p = doubles_load(in->exact);
    doubles q = doubles_load(in->exact + 1), x[3];
    doubles_mask below = doubles_below(a, b);
    const unsigned char *at[8];
    int i;
    doubles_store(out->eight[0], doubles_add(p, q));
    doubles_store(out->eight[1], doubles_subtract(p, q));
    doubles_store(out->eight[2], doubles_multiply(p, q));
    doubles_store(out->eight[3], doubles_smaller(a, b));
    doubles_store(out->eight[4], doubles_larger(a, b));
    doubles_store(out->eight[5], doubles_absolute(a));
    doubles_store(out->eight[6], doubles_choose(below, a, b));
    doubles_store(out->eight[7], doubles_all(in->c[2]));
    for (i = 0; i < 8; i++) at[i] = (const unsigned char *)(in->exact + in->number[i]);
    doubles_points(at, 0, x);
    for (i = 0; i < 3; i++) doubles_store(out->eight[8 + i], x[i]);
    for (i = 0; i < 8; i++) at[i] = (const unsigned char *)(in->plain + in->number[i]);
    doubles_points(at, 1, x);
    for (i = 0; i < 3; i++) doubles_store(out->eight[11 + i], x[i]);
    doubles_store(out->eight[14], doubles_larger_size(p, q));
    doubles_store(out->eight[15], doubles_smaller_size(p, q));
    out->bits[7] = doubles_bits(below);
    out->bits[8] = doubles_bits(doubles_equal(a, b));
    out->bits[9] = doubles_bits(doubles_both(below, doubles_below(p, q)));
    out->bits[10] = doubles_bits(doubles_either(below, doubles_below(p, q)));
    out->bits[11] = doubles_differ(p, q);
    out->bits[12] = doubles_differ3(p, q, doubles_load(in->exact + 2));
    out->bits[13] = doubles_signs(a);
}

void LANES_TRY(const lanes_input *in, lanes_outcome *out)
{
    try_floats(in, out);
    try_picks(in, out);
    try_bytes(in, out);
    try_rows(in, out);
    try_sets(in, out);
    try_cells(in, out);
    try_doubles(in, out);
}

#include "simd/target_end.h"

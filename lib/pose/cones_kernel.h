/*
 * The pass over leaf clusters: their points, and their normal cones, sixteen triangles at a time.
 * See dnc.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * All of it is in single precision on the points in the unit box, each coordinate being off by
 * POINT at most: 2^-25 for the rounding to float and a little for that to double before.
 *
 * The error of a dot product of a computed normal e x f with a direction, whose components are 0 or
 * +-1. Written out, it is a sum of at most six products of a component of e and one of f, each
 * component at most twice; let E and F be the largest components. A component of e or f is off by 2
 * POINT and the rounding of a difference, so that the products are off by 6 (2 POINT) (E + F) + 6
 * (2 POINT)^2 in all, and by rounding: two differences, one multiplication, one subtraction and two
 * additions each, ((1 + u)^6 - 1) < 6.01 u times its absolute value, u = 2^-24; the sum of the
 * absolute values is at most 6 E F. Hence 37 u E F + 12.1 POINT (E + F + 2.1 POINT); the last term
 * is for products that underflow, too.
 *
 * A dot product is compared with this error, to within 8 u computed, by the sign of their
 * difference. Where the product has three terms, two of them are added, and the difference of the
 * error and the third is taken from the sum or added to it: no more roundings than above.
 */

/* So many leaf clusters are taken at once, for the processor to do something else while one of them
   waits. */
#if SC_LANES_AVX512
#  define CONES 4
#elif SC_LANES_AVX2
#  define CONES 2
#else
#  define CONES 1
#endif
#define EACH(i, count)                                                                             \
  SC_UNROLL                                                                                        \
  for (i = 0; i < (count); i++)

/* Triangles that are seen to at once: all of a cluster, or where registers are short and few, one
   register of them. */
#if SC_LANES_QUADS
#  define part sc_floats4
#  define part_all SC_QUAD(set1_ps)
#  define part_add SC_QUAD(add_ps)
#  define part_subtract SC_QUAD(sub_ps)
#  define part_multiply SC_QUAD(mul_ps)
static SC_INLINE part part_largest_size(part a, part b, part c)
{
    const part sign = SC_QUAD(set1_ps)(-0.0f);
    a = SC_QUAD(max_ps)(SC_QUAD(andnot_ps)(sign, a), SC_QUAD(andnot_ps)(sign, b));
    return SC_QUAD(max_ps)(a, SC_QUAD(andnot_ps)(sign, c));
}
#  define part_signs(a) (a)
#else
#  define part lanes
#  define part_all lanes_all
#  define part_add lanes_add
#  define part_subtract lanes_subtract
#  define part_multiply lanes_multiply
#  define part_largest_size lanes_largest_size
#  define part_signs lanes_signs_of
#endif

/* The edges from corner 0. */
static SC_INLINE void edges_of(part corner[3][3], part e[3], part f[3])
{
    int k;
    EACH(k, 3)
    {
        e[k] = part_subtract(corner[1][k], corner[0][k]);
        f[k] = part_subtract(corner[2][k], corner[0][k]);
    }
}

/* By edges of triangles of so many clusters, the signs of what is negative where a direction is
   within 90 degrees of a normal, whatever it is off by. */
static SC_INLINE void directions_of(part e[][3], part f[][3], lanes_signs row[][16], int count)
{
    const part relative = part_all(37 * SC_BOUNDS_V);
    const part moved = part_all(12.1f * SC_BOUNDS_POINT), least = part_all(2.1f * SC_BOUNDS_POINT);
    part n[CONES][3], error[CONES], up[CONES][3], down[CONES][3];
    int i, k;
    EACH(k, 3)
    EACH(i, count)
    n[i][k] = part_subtract(part_multiply(e[i][(k + 1) % 3], f[i][(k + 2) % 3]),
                            part_multiply(e[i][(k + 2) % 3], f[i][(k + 1) % 3]));
    EACH(i, count)
    {
        part e_size = part_largest_size(e[i][0], e[i][1], e[i][2]);
        part f_size = part_largest_size(f[i][0], f[i][1], f[i][2]);
        error[i] = part_add(part_multiply(relative, part_multiply(e_size, f_size)),
                            part_multiply(moved, part_add(part_add(e_size, f_size), least)));
    }
    EACH(i, count)
    EACH(k, 3)
    {
        up[i][k] = part_subtract(error[i], n[i][k]);
        down[i][k] = part_add(error[i], n[i][k]);
        row[i][k] = part_signs(up[i][k]);
        row[i][k + 7] = part_signs(down[i][k]);
    }
    EACH(i, count)
    {
        part sum = part_add(n[i][0], n[i][1]), difference = part_subtract(n[i][0], n[i][1]);
        row[i][3] = part_signs(part_subtract(up[i][2], sum));
        row[i][4] = part_signs(part_subtract(down[i][2], sum));
        row[i][5] = part_signs(part_subtract(up[i][2], difference));
        row[i][6] = part_signs(part_subtract(down[i][2], difference));
        row[i][10] = part_signs(part_add(down[i][2], sum));
        row[i][11] = part_signs(part_add(up[i][2], sum));
        row[i][12] = part_signs(part_add(down[i][2], difference));
        row[i][13] = part_signs(part_add(up[i][2], difference));
        row[i][14] = row[i][15] = row[i][13];
    }
}

/* The masks of clusters that follow each other, by their points, as points_of writes them, and
   corners. Returns the bits that any has. */
#if SC_LANES_QUADS

static SC_INLINE unsigned masks_of(const float *each, const uint8_t *where, uint16_t *mask,
                                   int count)
{
    lanes_signs_kept kept = lanes_keep_all();
    int c, k, first;
    (void)count; /* one */
    for (first = 0; first < SC_LEAF_MAX; first += 4) {
        part corner[3][3], e[1][3], f[1][3], x[4];
        lanes_signs row[1][16];
        EACH(c, 3)
        {
            EACH(k, 4)
            {
                unsigned at = where[SC_LEAF_MAX * c + first + k];
                x[k] = SC_QUAD(loadu_ps)(each + ((at & 3) << 4 | (at & 12)));
            }
            sc_quad_transpose(x);
            EACH(k, 3) corner[c][k] = x[k];
        }
        edges_of(corner, e[0], f[0]);
        directions_of(e, f, row, 1);
        lanes_keep(&kept, row[0]);
    }
    *mask = (uint16_t)(lanes_kept_negative(&kept) & 0x3fffu);
    return *mask;
}

#else

static SC_INLINE unsigned masks_of(const float *each, const uint8_t *where, uint16_t *mask,
                                   int count)
{
    unsigned any = 0;
    lanes e[CONES][3], f[CONES][3];
    lanes_signs row[CONES][16];
    int i;
    EACH(i, count)
    {
        lanes corner[3][3];
        lanes_corners_at(each + 4 * SC_LEAF_POINTS * i, where + 3 * SC_LEAF_MAX * i, corner);
        edges_of(corner, e[i], f[i]);
    }
    directions_of(e, f, row, count);
    EACH(i, count)
    {
        unsigned bits = lanes_all_negative(row[i]) & 0x3fffu;
        mask[i] = (uint16_t)bits;
        any |= bits;
    }
    return any;
}

#endif

static uint32_t cone(const float *at, const uint8_t *where)
{
    uint16_t mask;
    masks_of(at, where, &mask, 1);
    return mask;
}

/* What cones there are among the first clusters of a group, before one at which a part of the pass
   begins. */
static unsigned sample_before(const sc_model *model, const sc_frame *frame, uint32_t first)
{
    const uint32_t in = first % SC_CONES_GROUP;
    uint32_t leaf = first - in, end = in < SC_CONES_SAMPLE ? first : leaf + SC_CONES_SAMPLE;
    unsigned any = 0;
    for (; leaf < end; leaf++) {
        float each[4 * SC_LEAF_POINTS];
        points_one_by_one(frame, sc_model_leaf_point(model) + SC_LEAF_POINTS * (uint64_t)leaf,
                          each);
        any |= cone(each, sc_model_leaf_corner(model) + 3 * SC_LEAF_MAX * (uint64_t)leaf);
    }
    return any;
}

/* Clusters first to end - 1 with what points_of cannot do; any: what cones the group of the first
   has so far. */
static void load_one_by_one(const sc_model *model, sc_frame *frame, uint32_t first, uint32_t end,
                            int cones, unsigned *any)
{
    uint16_t *mask = frame->mask + sc_model_first_leaf_patch(model);
    for (; first < end; first++) {
        const uint32_t in = first % SC_CONES_GROUP;
        float *each = frame->point_at + 4 * SC_LEAF_POINTS * (uint64_t)first;
        const uint64_t leaf = first;
        points_one_by_one(frame, sc_model_leaf_point(model) + SC_LEAF_POINTS * leaf, each);
        if (!cones) continue;
        if (!in) *any = 0;
        mask[first] = 0;
        if (*any || in < SC_CONES_SAMPLE)
            *any |= masks_of(each, sc_model_leaf_corner(model) + 3 * SC_LEAF_MAX * leaf,
                             mask + first, 1);
    }
}

/* Clusters that follow each other, CONES at a time, and what is left one by one. */
static SC_INLINE void load_some(const sc_model *model, sc_frame *frame, uint32_t first,
                                uint32_t end, int cones, int is_double, uint64_t stride)
{
    const point_reader reader = point_reader_of(frame);
    const lanes last = points_last(frame);
    const uint32_t aligned = (first + CONES - 1) / CONES * CONES;
    unsigned any = cones ? sample_before(model, frame, first) : 0;
    if (aligned < end) {
        const uint32_t *point = sc_model_leaf_point(model) + SC_LEAF_POINTS * (uint64_t)aligned;
        const uint8_t *where = sc_model_leaf_corner(model) + 3 * SC_LEAF_MAX * (uint64_t)aligned;
        uint16_t *mask = frame->mask + sc_model_first_leaf_patch(model) + aligned;
        float *each = frame->point_at + 4 * SC_LEAF_POINTS * (uint64_t)aligned;
        load_one_by_one(model, frame, first, aligned, cones, &any);
        for (first = aligned; end - first >= CONES; first += CONES) {
            int i, odd = 0;
            EACH(i, CONES)
            odd |= points_have(point + SC_LEAF_POINTS * i, last, is_double);
            if (odd) {
                load_one_by_one(model, frame, first, first + CONES, cones, &any);
            } else {
                EACH(i, CONES)
                points_of(&reader, point + SC_LEAF_POINTS * i, is_double, stride,
                          each + 4 * SC_LEAF_POINTS * i);
                if (cones) {
                    const uint32_t in = first % SC_CONES_GROUP;
                    if (!in) any = 0;
                    if (any || in < SC_CONES_SAMPLE)
                        any |= masks_of(each, where, mask, CONES);
                    else
                        memset(mask, 0, CONES * sizeof *mask);
                }
            }
            point += SC_LEAF_POINTS * CONES;
            where += 3 * SC_LEAF_MAX * CONES;
            each += 4 * SC_LEAF_POINTS * CONES;
            mask += CONES;
        }
    }
    load_one_by_one(model, frame, first, end, cones, &any);
}

static void load_leaves(const sc_model *model, sc_frame *frame, uint32_t first, uint32_t end,
                        int cones)
{
    const uint64_t stride = frame->positions[0].stride;
    unsigned any = 0;
    if (!frame->fits_float && cones) any = sample_before(model, frame, first);
    if (!frame->fits_float)
        load_one_by_one(model, frame, first, end, cones, &any);
    else if (frame->positions[0].type == SC_DOUBLE && !cones)
        load_some(model, frame, first, end, 0, 1, stride);
    else if (frame->positions[0].type == SC_DOUBLE && stride == 3 * sizeof(double))
        load_some(model, frame, first, end, 1, 1, 3 * sizeof(double));
    else if (frame->positions[0].type == SC_DOUBLE)
        load_some(model, frame, first, end, 1, 1, stride);
    else if (!cones)
        load_some(model, frame, first, end, 0, 0, stride);
    else if (stride == 3 * sizeof(float))
        load_some(model, frame, first, end, 1, 0, 3 * sizeof(float));
    else
        load_some(model, frame, first, end, 1, 0, stride);
}

#undef CONES
#undef part
#undef part_all
#undef part_add
#undef part_subtract
#undef part_multiply
#undef part_largest_size
#undef part_signs
#undef EACH

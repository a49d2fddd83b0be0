/*
 * Refinement of small patches. See small_refinement.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/small_refinement.h"

#include "base/assume.h"
#include "base/bits.h"

/* A pass ends after so many moves without a shorter border; and so many passes at most. */
enum { SMALL_PATIENCE = 8, SMALL_PASSES = 2 };

/* Lengths are counted in fractions of the mean, so many and no more than so much: then three of
   them, times 64, fit 32 bits. */
enum { LENGTH_UNIT = 1024, LENGTH_MOST = 1 << 22 };

/* A patch; triangles have their places in its list. Sets are bits. */
typedef struct small_patch {
    uint32_t count;
    uint64_t upper;  /* on side 1 */
    uint64_t border; /* with a neighbor on the other side */
    uint64_t listed; /* those at the border, now or before */
    /* 64 times by how much the border shortens if one changes sides, and its place */
    int32_t gain[SC_SMALL_REFINEMENT_MAX];
    int32_t length[SC_SMALL_REFINEMENT_MAX][3]; /* of each side; 0 if nothing is across */
    uint8_t near[SC_SMALL_REFINEMENT_MAX][3];   /* what is, else the triangle itself */
} small_patch;

/* A triangle is a bit of a number, and choose takes its place off a gain that may be negative,
   modulo 2^32: so a power of two up to 64. */
typedef char size_divides_64[64 % SC_SMALL_REFINEMENT_MAX == 0 ? 1 : -1];

static uint64_t bit(uint32_t i)
{
    return (uint64_t)1 << i;
}

/* Finds the gain of a triangle, and whether it is at the border. */
static void weigh(small_patch *p, uint32_t i)
{
    uint64_t across = p->upper ^ (0 - (p->upper >> i & 1)), differs = 0;
    int32_t gain = 0;
    uint32_t k;
    for (k = 0; k < 3; k++) {
        uint64_t other = across >> p->near[i][k] & 1;
        int32_t length = p->length[i][k];
        differs |= other;
        gain += (2 * (int32_t)other - 1) * length;
    }
    p->gain[i] = SC_SMALL_REFINEMENT_MAX * gain + (int32_t)i;
    p->border = (p->border & ~bit(i)) | differs << i;
}

/* The triangle of greatest gain among some, the last of several. */
static uint32_t choose(const small_patch *p, uint64_t some)
{
    int32_t best = INT32_MIN;
    for (; some; some &= some - 1) {
        int32_t gain = p->gain[sc_bits_lowest64(some)];
        best = gain > best ? gain : best;
    }
    return (uint32_t)best % SC_SMALL_REFINEMENT_MAX;
}

/* One pass; returns whether the border became shorter. */
static int run_small_pass(small_patch *p, uint32_t size[2], const uint32_t capacity[2])
{
    uint64_t still = ~(uint64_t)0, best_upper = p->upper, some; /* still: that have not moved */
    uint32_t since = 0, best_size = size[1], total = size[0] + size[1], i, k;
    int64_t gained = 0, best = 0;
    int shorter = 0;
    for (some = p->listed; some; some &= some - 1) weigh(p, sc_bits_lowest64(some));
    while (since < SMALL_PATIENCE) {
        some = 0;
        /* no side may take all but one, see refinement.h */
        if (size[1] < capacity[1] && SC_ALWAYS(size[0] > 1)) some = ~p->upper;
        if (size[0] < capacity[0] && SC_ALWAYS(size[1] > 1)) some |= p->upper;
        some &= p->border & still;
        if (!some) break;
        i = choose(p, some);
        gained += p->gain[i] - (int32_t)i;
        p->upper ^= bit(i);
        size[p->upper >> i & 1]++;
        size[~p->upper >> i & 1]--;
        still ^= bit(i);
        since++;
        if (gained > best) {
            best = gained;
            best_upper = p->upper;
            best_size = size[1];
            since = 0;
            shorter = 1;
        }
        for (k = 0; k < 3; k++) {
            weigh(p, p->near[i][k]);
            p->listed |= bit(p->near[i][k]);
        }
    }
    p->upper = best_upper;
    size[1] = best_size;
    size[0] = total - best_size;
    return shorter;
}

static int32_t count_length(float length)
{
    float units = LENGTH_UNIT * length;
    return units < LENGTH_MOST ? (int32_t)units : LENGTH_MOST;
}

/* r->state is one more than the place, and 0 outside the patch. */
static void enter(sc_refinement *r, const uint32_t *triangles, small_patch *p)
{
    uint32_t i, k;
    for (i = 0; i < p->count; i++) r->state[triangles[i]] = (uint8_t)(i + 1);
    p->upper = p->border = p->listed = 0;
    for (i = 0; i < p->count; i++) {
        uint32_t t = triangles[i];
        p->upper |= (uint64_t)(r->label[t] & 1) << i;
        for (k = 0; k < 3; k++) {
            uint32_t place = r->state[r->neighbor[3 * (uint64_t)t + k]];
            p->near[i][k] = (uint8_t)(place ? place - 1 : i);
            p->length[i][k] = place ? count_length(r->lengths[3 * (uint64_t)t + k]) : 0;
        }
    }
    for (i = 0; i < p->count; i++) {
        uint64_t across = p->upper ^ (0 - (p->upper >> i & 1));
        p->listed |=
            ((across >> p->near[i][0] | across >> p->near[i][1] | across >> p->near[i][2]) & 1)
            << i;
    }
}

void sc_small_refinement_run(sc_refinement *r, const uint32_t *triangles, uint32_t count,
                             uint32_t size[2], const uint32_t capacity[2])
{
    small_patch p;
    uint32_t i, low = r->label[triangles[0]] & ~1u;
    int pass;
    p.count = count;
    enter(r, triangles, &p);
    for (pass = 0; pass < SMALL_PASSES; pass++)
        if (!run_small_pass(&p, size, capacity)) break;
    r->border_count = 0;
    for (i = 0; i < count; i++) {
        r->label[triangles[i]] = low | (uint32_t)(p.upper >> i & 1);
        r->state[triangles[i]] = 0;
    }
    for (; p.listed; p.listed &= p.listed - 1) {
        i = sc_bits_lowest64(p.listed);
        weigh(&p, i);
        if (p.border >> i & 1) r->border[r->border_count++] = triangles[i];
    }
}

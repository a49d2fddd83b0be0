/*
 * The oracle of continuous collision: see step_oracle.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "step_oracle.h"

#include <gmp.h>
#include <math.h>

enum { COEFFICIENTS = 5, CHAIN = 5, TIME_BITS = 60 };

/* ------------------------------------------------------------------------------------------------
 * Polynomials with integer coefficients, of degree 4 at most; the zero polynomial has degree -1.
 */

typedef struct polynomial {
    int degree;
    mpz_t c[COEFFICIENTS];
} polynomial;

static void start_polynomials(polynomial *p, int count)
{
    for (int i = 0; i < count; ++i) {
        p[i].degree = -1;
        for (int k = 0; k < COEFFICIENTS; ++k) mpz_init(p[i].c[k]);
    }
}

static void stop_polynomials(polynomial *p, int count)
{
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < COEFFICIENTS; ++k) mpz_clear(p[i].c[k]);
    }
}

static void trim(polynomial *p)
{
    p->degree = COEFFICIENTS - 1;
    while (p->degree >= 0 && mpz_sgn(p->c[p->degree]) == 0) --p->degree;
}

static void copy(polynomial *to, const polynomial *p)
{
    for (int k = 0; k < COEFFICIENTS; ++k) mpz_set(to->c[k], p->c[k]);
    to->degree = p->degree;
}

static void clear(polynomial *p)
{
    for (int k = 0; k < COEFFICIENTS; ++k) mpz_set_ui(p->c[k], 0);
    p->degree = -1;
}

/* sum += sign a b; the degrees add up to 4 at most. */
static void add_product(polynomial *sum, const polynomial *a, const polynomial *b, int sign)
{
    for (int i = 0; i <= a->degree; ++i) {
        for (int j = 0; j <= b->degree; ++j) {
            if (sign > 0) {
                mpz_addmul(sum->c[i + j], a->c[i], b->c[j]);
            } else {
                mpz_submul(sum->c[i + j], a->c[i], b->c[j]);
            }
        }
    }
    trim(sum);
}

/* Divides by the greatest common divisor of the coefficients. */
static void shorten(polynomial *p)
{
    mpz_t divisor;
    mpz_init(divisor);
    for (int k = 0; k <= p->degree; ++k) mpz_gcd(divisor, divisor, p->c[k]);
    if (mpz_cmp_ui(divisor, 1) > 0)
        for (int k = 0; k <= p->degree; ++k) mpz_divexact(p->c[k], p->c[k], divisor);
    mpz_clear(divisor);
}

/*
 * Pseudo-division by b, not zero: rest becomes a positive multiple of what remains of it, and
 * quotient, if not NULL, a multiple of the quotient.
 */
static void divide(polynomial *rest, const polynomial *b, polynomial *quotient)
{
    mpz_t lead, factor;
    int sign = mpz_sgn(b->c[b->degree]);
    mpz_inits(lead, factor, NULL);
    mpz_abs(lead, b->c[b->degree]);
    if (quotient != NULL) clear(quotient);
    while (rest->degree >= b->degree) {
        int shift = rest->degree - b->degree;
        mpz_set(factor, rest->c[rest->degree]);
        if (sign < 0) mpz_neg(factor, factor);
        for (int k = 0; k <= rest->degree; ++k) mpz_mul(rest->c[k], rest->c[k], lead);
        for (int k = 0; k <= b->degree; ++k) mpz_submul(rest->c[k + shift], factor, b->c[k]);
        if (quotient != NULL) {
            for (int k = 0; k < COEFFICIENTS; ++k) mpz_mul(quotient->c[k], quotient->c[k], lead);
            mpz_add(quotient->c[shift], quotient->c[shift], factor);
        }
        trim(rest);
    }
    if (quotient != NULL) trim(quotient);
    shorten(rest);
    mpz_clears(lead, factor, NULL);
}

/* gcd = the greatest common divisor of two polynomials, up to a factor; neither is zero. */
static void find_common(polynomial *gcd, const polynomial *a, const polynomial *b)
{
    polynomial rest;
    start_polynomials(&rest, 1);
    copy(gcd, a);
    copy(&rest, b);
    while (rest.degree >= 0) {
        polynomial swap;
        divide(gcd, &rest, NULL);
        swap = *gcd;
        *gcd = rest;
        rest = swap;
    }
    stop_polynomials(&rest, 1);
}

/* The sign at the time numerator / 2^bits. */
static int sign_at_dyadic(const polynomial *p, const mpz_t numerator, unsigned bits)
{
    mpz_t value, term;
    int sign;
    if (p->degree < 0) return 0;
    mpz_init_set(value, p->c[p->degree]);
    mpz_init(term);
    for (int k = p->degree - 1; k >= 0; --k) {
        mpz_mul(value, value, numerator);
        mpz_mul_2exp(term, p->c[k], (mp_bitcnt_t)bits * (mp_bitcnt_t)(p->degree - k));
        mpz_add(value, value, term);
    }
    sign = mpz_sgn(value);
    mpz_clears(value, term, NULL);
    return sign;
}

/* ------------------------------------------------------------------------------------------------
 * Roots
 */

/* Sturm's chain of a polynomial without double roots, which is its first member. */
typedef struct chain {
    int length;
    polynomial p[CHAIN];
} chain;

/* The times between first / 2^bits, exclusive, and (first + 1) / 2^bits, inclusive. */
typedef struct interval {
    mpz_t first;
    unsigned bits;
} interval;

static void differentiate(polynomial *d, const polynomial *p)
{
    clear(d);
    for (int k = 1; k <= p->degree; ++k) mpz_mul_ui(d->c[k - 1], p->c[k], (unsigned long)k);
    trim(d);
}

/* The chain of what is left of p, not zero, when each root is taken once. */
static void make_chain(chain *s, const polynomial *p)
{
    polynomial work[2];
    start_polynomials(s->p, CHAIN);
    start_polynomials(work, 2);
    differentiate(&work[0], p);
    copy(&s->p[0], p);
    if (work[0].degree >= 0) {
        find_common(&work[1], p, &work[0]);
        if (work[1].degree > 0) {
            copy(&work[0], p);
            divide(&work[0], &work[1], &s->p[0]);
        }
    }
    shorten(&s->p[0]);
    s->length = 1;
    differentiate(&s->p[1], &s->p[0]);
    while (s->p[s->length].degree >= 0) {
        polynomial *next = &s->p[++s->length];
        if (s->length == CHAIN) break;
        copy(next, &s->p[s->length - 2]);
        divide(next, &s->p[s->length - 1], NULL);
        for (int k = 0; k <= next->degree; ++k) mpz_neg(next->c[k], next->c[k]);
    }
    stop_polynomials(work, 2);
}

static void free_chain(chain *s)
{
    stop_polynomials(s->p, CHAIN);
}

static int count_changes(const chain *s, const mpz_t numerator, unsigned bits)
{
    int changes = 0, before = 0;
    for (int i = 0; i < s->length; ++i) {
        int sign = sign_at_dyadic(&s->p[i], numerator, bits);
        changes += sign * before < 0;
        if (sign != 0) before = sign;
    }
    return changes;
}

/* The number of roots in an interval. */
static int count_roots(const chain *s, const interval *within)
{
    int changes = count_changes(s, within->first, within->bits);
    mpz_t last;
    mpz_init(last);
    mpz_add_ui(last, within->first, 1);
    changes -= count_changes(s, last, within->bits);
    mpz_clear(last);
    return changes;
}

/* Halves an interval with a single root so that the root stays in it. */
static void bisect(const chain *s, interval *root)
{
    mpz_mul_2exp(root->first, root->first, 1);
    ++root->bits;
    if (count_roots(s, root) == 0) mpz_add_ui(root->first, root->first, 1);
}

/* The sign of q at the root of s in an interval. The interval may shrink. */
static int sign_at_root(const chain *s, interval *root, const polynomial *q)
{
    chain others;
    mpz_t last;
    int sign, is_common = 0, looked = 0;
    if (q->degree <= 0) return q->degree < 0 ? 0 : mpz_sgn(q->c[0]);
    make_chain(&others, q);
    while (!is_common && count_roots(&others, root) > 0) {
        if (!looked) {
            polynomial gcd;
            looked = 1;
            start_polynomials(&gcd, 1);
            find_common(&gcd, &s->p[0], q);
            if (gcd.degree > 0) {
                chain common;
                make_chain(&common, &gcd);
                is_common = count_roots(&common, root) > 0;
                free_chain(&common);
            }
            stop_polynomials(&gcd, 1);
        }
        if (!is_common) bisect(s, root);
    }
    free_chain(&others);
    if (is_common) return 0;
    mpz_init(last);
    mpz_add_ui(last, root->first, 1);
    sign = sign_at_dyadic(q, last, root->bits);
    mpz_clear(last);
    return sign;
}

/* ------------------------------------------------------------------------------------------------
 * A moving triangle and the origin
 */

/* The corners, and what their position to the origin depends on, as polynomials of time. */
typedef struct moving_triangle {
    polynomial corners[3][3];
    polynomial products[3];   /* of corners i and i + 1: scalar */
    polynomial normals[3][3]; /* and as vectors */
    polynomial turns[2];      /* normals 0 and 1, 1 and 2: scalar products */
    polynomial volume;
} moving_triangle;

/* A time: 0 if s is NULL, else a root. */
typedef struct moment {
    const chain *s;
    interval *root;
} moment;

static int sign_then(const moment *when, const polynomial *q)
{
    if (when->s != NULL) return sign_at_root(when->s, when->root, q);
    return q->degree < 0 ? 0 : mpz_sgn(q->c[0]);
}

/* Whether the triangle, a segment or a point perhaps, holds the origin. */
static int holds_origin(const moving_triangle *t, const moment *when, int is_flat)
{
    for (int i = 0; i < 3; ++i) {
        int k = 0;
        while (k < 3 && sign_then(when, &t->corners[i][k]) == 0) ++k;
        if (k == 3) return 1;
    }
    for (int i = 0; i < 3; ++i) { /* inside the segment of corners i and i + 1 */
        int k = 0;
        if (sign_then(when, &t->products[i]) >= 0) continue;
        while (k < 3 && sign_then(when, &t->normals[i][k]) == 0) ++k;
        if (k == 3) return 1;
    }
    /* In the plane of the origin, all three normals are parallel: inside if they point the same
       way. */
    if (!is_flat && sign_then(when, &t->volume) != 0) return 0;
    return sign_then(when, &t->turns[0]) > 0 && sign_then(when, &t->turns[1]) > 0;
}

/* Takes the roots of p in the interval, one after the other, for times at which the origin may come
   in. */
static int look_at_roots(const moving_triangle *t, const chain *s, interval *within, double *low,
                         double *high)
{
    int count = count_roots(s, within), found = 0;
    interval part;
    if (count == 0) return 0;
    mpz_init(part.first);
    if (count > 1) {
        part.bits = within->bits + 1;
        for (unsigned half = 0; half < 2; ++half) {
            mpz_mul_2exp(part.first, within->first, 1);
            mpz_add_ui(part.first, part.first, half);
            found |= look_at_roots(t, s, &part, low, high);
            part.bits = within->bits + 1;
        }
    } else {
        moment when = {s, &part};
        part.bits = within->bits;
        mpz_set(part.first, within->first);
        found = holds_origin(t, &when, 1);
        if (found) {
            double first, last;
            while (part.bits < TIME_BITS) bisect(s, &part);
            first = ldexp(mpz_get_d(part.first), -(int)part.bits); /* rounded downwards */
            last = nextafter(first + ldexp(1, -(int)part.bits), 2);
            if (first < *low) *low = first;
            if (last < *high) *high = last;
        }
    }
    mpz_clear(part.first);
    return found;
}

static int look_at_roots_of(const moving_triangle *t, const polynomial *p, double *low,
                            double *high)
{
    chain s;
    interval all;
    int found;
    if (p->degree <= 0) return 0;
    make_chain(&s, p);
    mpz_init(all.first);
    all.bits = 0;
    found = look_at_roots(t, &s, &all, low, high);
    mpz_clear(all.first);
    free_chain(&s);
    return found;
}

static void start_triangle(moving_triangle *t)
{
    for (int i = 0; i < 3; ++i) {
        start_polynomials(t->corners[i], 3);
        start_polynomials(t->normals[i], 3);
    }
    start_polynomials(t->products, 3);
    start_polynomials(t->turns, 2);
    start_polynomials(&t->volume, 1);
}

static void stop_triangle(moving_triangle *t)
{
    for (int i = 0; i < 3; ++i) {
        stop_polynomials(t->corners[i], 3);
        stop_polynomials(t->normals[i], 3);
    }
    stop_polynomials(t->products, 3);
    stop_polynomials(t->turns, 2);
    stop_polynomials(&t->volume, 1);
}

/* Fills in all but the corners. */
static void relate_corners(moving_triangle *t)
{
    for (int i = 0; i < 3; ++i) {
        polynomial *a = t->corners[i], *b = t->corners[(i + 1) % 3];
        clear(&t->products[i]);
        for (int k = 0; k < 3; ++k) {
            add_product(&t->products[i], &a[k], &b[k], 1);
            clear(&t->normals[i][k]);
            add_product(&t->normals[i][k], &a[(k + 1) % 3], &b[(k + 2) % 3], 1);
            add_product(&t->normals[i][k], &a[(k + 2) % 3], &b[(k + 1) % 3], -1);
        }
    }
    clear(&t->volume);
    for (int i = 0; i < 2; ++i) clear(&t->turns[i]);
    for (int k = 0; k < 3; ++k) {
        add_product(&t->volume, &t->normals[0][k], &t->corners[2][k], 1);
        for (int i = 0; i < 2; ++i)
            add_product(&t->turns[i], &t->normals[i][k], &t->normals[i + 1][k], 1);
    }
}

/*
 * Whether the origin comes in at some time. It is in at a closed set of times, on which signs of
 * the polynomials decide; so the first such time is 0 or a root of one that is not zero throughout.
 * If the volume is such a one, it is a root of that.
 */
static int meets_origin(moving_triangle *t, double *low, double *high)
{
    moment at_once = {NULL, NULL};
    int found = 0;
    relate_corners(t);
    if (holds_origin(t, &at_once, 0)) {
        *low = *high = 0;
        return 1;
    }
    if (t->volume.degree >= 0) return look_at_roots_of(t, &t->volume, low, high);
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) {
            found |= look_at_roots_of(t, &t->corners[i][k], low, high);
            found |= look_at_roots_of(t, &t->normals[i][k], low, high);
        }
        found |= look_at_roots_of(t, &t->products[i], low, high);
    }
    for (int i = 0; i < 2; ++i) found |= look_at_roots_of(t, &t->turns[i], low, high);
    return found;
}

/* ------------------------------------------------------------------------------------------------
 * Queries
 */

/* Coordinates as integers, multiplied by 2^shift. */
typedef struct step {
    mpz_t start[4][3], end[4][3];
    int shift;
} step;

static void set_double(mpz_t to, double value, int shift)
{
    int exponent;
    double mantissa = frexp(value, &exponent);
    mpz_set_d(to, ldexp(mantissa, 53));
    if (mpz_sgn(to) == 0) return;
    exponent += shift - 53;
    if (exponent >= 0) {
        mpz_mul_2exp(to, to, (mp_bitcnt_t)exponent);
    } else { /* only zeros are dropped */
        mpz_tdiv_q_2exp(to, to, (mp_bitcnt_t)-exponent);
    }
}

/* A power of two that makes an integer of a value. */
static int shift_of(double value)
{
    int exponent, shift;
    double mantissa = frexp(value, &exponent);
    if (!(mantissa != 0)) return -2000;
    mantissa = ldexp(mantissa, 53);
    shift = 53 - exponent;
    while (fmod(mantissa, 2) == 0) {
        mantissa *= 0.5;
        --shift;
    }
    return shift;
}

static void read_step(step *s, const double start[4][3], const double end[4][3])
{
    s->shift = -2000;
    for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 3; ++k) {
            int a = shift_of(start[i][k]), b = shift_of(end[i][k]);
            if (a > s->shift) s->shift = a;
            if (b > s->shift) s->shift = b;
        }
    }
    for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 3; ++k) {
            mpz_inits(s->start[i][k], s->end[i][k], NULL);
            set_double(s->start[i][k], start[i][k], s->shift);
            set_double(s->end[i][k], end[i][k], s->shift);
        }
    }
}

static void free_step(step *s)
{
    for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 3; ++k) mpz_clears(s->start[i][k], s->end[i][k], NULL);
    }
}

/* The corners of the moving triangles: differences of these points. The second is for edges
   only. */
static const int corner_points[3][3][2] = {
    {{1, 0}, {2, 0}, {3, 0}}, {{2, 0}, {3, 0}, {2, 1}}, {{3, 1}, {3, 0}, {2, 1}}};

/* Whether points a and those before, or points b and those after, stay on one side of the others
   along an axis. */
static int stays_apart(step_oracle_kind kind, const double start[4][3], const double end[4][3])
{
    int split = kind == STEP_ORACLE_VERTEX_FACE ? 1 : 2;
    for (int k = 0; k < 3; ++k) {
        int below = 1, above = 1;
        for (int i = 0; i < split; ++i) {
            for (int j = split; j < 4; ++j) {
                below &= start[i][k] < start[j][k] && end[i][k] < end[j][k];
                above &= start[i][k] > start[j][k] && end[i][k] > end[j][k];
            }
        }
        if (below || above) return 1;
    }
    return 0;
}

int step_oracle_touches(step_oracle_kind kind, const double start[4][3], const double end[4][3],
                        double *low, double *high)
{
    int first = kind == STEP_ORACLE_VERTEX_FACE ? 0 : 1,
        last = kind == STEP_ORACLE_VERTEX_FACE ? 0 : 2;
    double from = 2, to = 2;
    int found = 0;
    moving_triangle t;
    step s;
    if (stays_apart(kind, start, end)) return 0;
    read_step(&s, start, end);
    start_triangle(&t);
    for (int which = first; which <= last; ++which) {
        for (int i = 0; i < 3; ++i) {
            int a = corner_points[which][i][0], b = corner_points[which][i][1];
            for (int k = 0; k < 3; ++k) {
                polynomial *p = &t.corners[i][k];
                clear(p);
                mpz_sub(p->c[0], s.start[a][k], s.start[b][k]);
                mpz_sub(p->c[1], s.end[a][k], s.end[b][k]);
                mpz_sub(p->c[1], p->c[1], p->c[0]);
                trim(p);
            }
        }
        found |= meets_origin(&t, &from, &to);
    }
    stop_triangle(&t);
    free_step(&s);
    if (found && low != NULL && high != NULL) {
        *low = from;
        *high = to > 1 ? 1 : to;
    }
    return found;
}

/* A vector's product with another: scalar, and as a vector. */
static void multiply(mpz_t product, mpz_t u[3], mpz_t v[3])
{
    mpz_set_ui(product, 0);
    for (int k = 0; k < 3; ++k) mpz_addmul(product, u[k], v[k]);
}

static void cross(mpz_t n[3], mpz_t u[3], mpz_t v[3])
{
    for (int k = 0; k < 3; ++k) {
        mpz_mul(n[k], u[(k + 1) % 3], v[(k + 2) % 3]);
        mpz_submul(n[k], u[(k + 2) % 3], v[(k + 1) % 3]);
    }
}

enum { SCALARS = 4, VECTORS = 6 };

/* Whether a triangle comes within the root of square of the origin: some corner, side, or its
   inside. */
static int is_triangle_within(mpz_t p[3][3], const mpz_t square)
{
    mpz_t x[SCALARS], v[VECTORS][3];
    int within = 0, inside = 1;
    for (int i = 0; i < SCALARS; ++i) mpz_init(x[i]);
    for (int i = 0; i < VECTORS; ++i) mpz_inits(v[i][0], v[i][1], v[i][2], NULL);
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3;
        multiply(x[0], p[i], p[i]);
        within |= mpz_cmp(x[0], square) <= 0;
        for (int k = 0; k < 3; ++k) mpz_sub(v[i][k], p[j][k], p[i][k]);
        cross(v[3 + i], p[i], p[j]); /* and also p[i] x side i */
        multiply(x[1], v[i], v[i]);
        multiply(x[2], p[i], v[i]);
        mpz_neg(x[2], x[2]);
        if (mpz_sgn(x[2]) < 0 || mpz_cmp(x[2], x[1]) > 0 || mpz_sgn(x[1]) == 0) continue;
        multiply(x[0], v[3 + i], v[3 + i]);
        mpz_mul(x[1], x[1], square);
        within |= mpz_cmp(x[0], x[1]) <= 0;
    }
    cross(v[2], v[0], v[1]);
    multiply(x[1], v[2], v[2]);
    for (int i = 0; i < 3; ++i) {
        multiply(x[0], v[2], v[3 + i]);
        inside &= mpz_sgn(x[0]) >= 0;
    }
    if (inside && mpz_sgn(x[1]) > 0) {
        multiply(x[0], v[2], p[0]);
        mpz_mul(x[0], x[0], x[0]);
        mpz_mul(x[1], x[1], square);
        within |= mpz_cmp(x[0], x[1]) <= 0;
    }
    for (int i = 0; i < SCALARS; ++i) mpz_clear(x[i]);
    for (int i = 0; i < VECTORS; ++i) mpz_clears(v[i][0], v[i][1], v[i][2], NULL);
    return within;
}

int step_oracle_is_within(step_oracle_kind kind, const double start[4][3], const double end[4][3],
                          double time, double a, double b)
{
    int first = kind == STEP_ORACLE_VERTEX_FACE ? 0 : 1,
        last = kind == STEP_ORACLE_VERTEX_FACE ? 0 : 2;
    int bits = shift_of(time), found = 0, radius_shift = shift_of(a);
    mpz_t p[3][3], t, rest, d, square, addend;
    step s;
    if (bits < 0) bits = 0;
    if (shift_of(b) > radius_shift) radius_shift = shift_of(b);
    read_step(&s, start, end);
    mpz_inits(t, rest, d, square, addend, NULL);
    set_double(t, time, bits);
    mpz_set_ui(rest, 1);
    mpz_mul_2exp(rest, rest, (mp_bitcnt_t)bits);
    mpz_sub(rest, rest, t);
    /* Places are multiplied by 2^(shift + bits), or more if the radius needs it. */
    if (radius_shift < s.shift + bits) radius_shift = s.shift + bits;
    set_double(square, a, radius_shift);
    set_double(addend, b, radius_shift);
    mpz_add(square, square, addend);
    mpz_mul(square, square, square);
    for (int i = 0; i < 3; ++i) mpz_inits(p[i][0], p[i][1], p[i][2], NULL);
    for (int which = first; which <= last; ++which) {
        for (int i = 0; i < 3; ++i) {
            int to = corner_points[which][i][0], from = corner_points[which][i][1];
            for (int k = 0; k < 3; ++k) {
                mpz_sub(d, s.start[to][k], s.start[from][k]);
                mpz_mul(p[i][k], d, rest);
                mpz_sub(d, s.end[to][k], s.end[from][k]);
                mpz_addmul(p[i][k], d, t);
                mpz_mul_2exp(p[i][k], p[i][k], (mp_bitcnt_t)(radius_shift - s.shift - bits));
            }
        }
        found |= is_triangle_within(p, square);
    }
    for (int i = 0; i < 3; ++i) mpz_clears(p[i][0], p[i][1], p[i][2], NULL);
    mpz_clears(t, rest, d, square, addend, NULL);
    free_step(&s);
    return found;
}

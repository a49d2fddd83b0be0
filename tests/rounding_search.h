/*
 * How much of its error bound the rounding of a place in lib/ can be made to use: searches over
 * random and adversarial inputs. See lib/GUARANTEE.md, "Rounding, bound by bound".
 *
 * SPDX-License-Identifier: MIT
 *
 * A bound is given by a function that takes sixteen trials and says for each which share of the
 * bound the actual error is: |computed - exact| over the bound. What is computed is so by functions
 * of lib/, where they are to be had apart, else by the same operations in the same order; the exact
 * value comes from double precision (of what is computed in floats), sums of two doubles (of what
 * is computed in doubles) or GMP. Half of the trials are new, of several kinds; the others change
 * the worst that was found, and go on from what is worse still.
 *
 * tests/test_rounding.c makes few trials, `make search-rounding` many.
 */
#ifndef SC_TESTS_ROUNDING_SEARCH_H
#define SC_TESTS_ROUNDING_SEARCH_H

#include <stdint.h>

enum { ROUNDING_LANES = 16, ROUNDING_INPUTS = 18 };

/* What the numbers of a trial are. */
typedef enum rounding_kind {
    ROUNDING_UNIT,    /* from -1 to 1, to be rounded to float, often near the middle of two */
    ROUNDING_DOUBLES, /* doubles of similar or of different sizes, often nearly in one plane */
    ROUNDING_TINY,    /* the same, to be scaled so that products underflow */
    ROUNDING_WHOLE    /* whole numbers below 2^16 */
} rounding_kind;

typedef void rounding_share(const double x[][ROUNDING_LANES], double share[ROUNDING_LANES]);

typedef struct rounding_bound {
    const char *name;  /* file and bound, as in lib/GUARANTEE.md */
    const char *group; /* for tests/test_rounding.c */
    rounding_kind kind;
    int inputs, axes; /* numbers of a trial; of a point */
    int slowness;     /* the searches make so many times fewer trials */
    rounding_share *share;
    double seen;         /* the share that 200000 trials, over slowness, find at least */
    const double *known; /* a trial to begin with, that random ones come near late, or NULL */
} rounding_bound;

extern const rounding_bound rounding_bounds[];
extern const int rounding_bound_count;

/* The largest share among so many trials, rounded up to a multiple of 16. worst, if not NULL, gets
   the numbers of that trial, room for ROUNDING_INPUTS. */
double rounding_search(const rounding_bound *bound, uint64_t trials, uint64_t seed, double *worst);

#endif

/*
 * Numbers that several threads lower at the same time.
 *
 * SPDX-License-Identifier: MIT
 */
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>

#include "base/atomic.h"
#include "harness.h"

typedef struct lowered {
    size_t least;
    double least_double;
    uint8_t least_byte;
} lowered;

enum { LOWERED = 200000, LOWERING = 3 };

typedef struct lowering {
    lowered *its;
    uint32_t number;
    int mistakes;
} lowering;

static void *lower(void *context)
{
    lowering *l = (lowering *)context;
    for (uint32_t i = LOWERED; i-- > 0;) {
        const uint32_t value = LOWERING * i + l->number;
        sc_atomic_least(&l->its->least, value);
        l->mistakes += sc_atomic_get(&l->its->least) > value;
        sc_atomic_lessen(&l->its->least_double, value);
        sc_atomic_lessen_byte(&l->its->least_byte, (uint8_t)(3 + (value >> 12)));
    }
    return NULL;
}

/* Each number stays at the least that it was given, whoever was quicker. */
static void lowered_by_threads(void)
{
    lowered its = {SIZE_MAX, 1e300, 0xff};
    lowering l[LOWERING];
    pthread_t threads[LOWERING];
    for (uint32_t t = 0; t < LOWERING; ++t) {
        l[t].its = &its;
        l[t].number = t + 5;
        l[t].mistakes = 0;
#if SC_ATOMIC_DOUBLES
        if (!CHECK(pthread_create(&threads[t], NULL, lower, &l[t]) == 0)) exit(1);
#else
        lower(&l[t]);
#endif
    }
    for (uint32_t t = 0; t < LOWERING; ++t) {
#if SC_ATOMIC_DOUBLES
        pthread_join(threads[t], NULL);
#else
        (void)threads;
#endif
        CHECK(l[t].mistakes == 0);
    }
    CHECK(its.least == 5 && its.least_double == 5 && its.least_byte == 3);
    sc_atomic_least(&its.least, 6);
    sc_atomic_lessen(&its.least_double, 6);
    sc_atomic_lessen_byte(&its.least_byte, 4);
    CHECK(its.least == 5 && its.least_double == 5 && its.least_byte == 3);
}

SC_TEST_MAIN(SC_TEST(lowered_by_threads))

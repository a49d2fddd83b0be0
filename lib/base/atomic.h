/*
 * The few things that several threads do to one variable.
 *
 * SPDX-License-Identifier: MIT
 *
 * C99 has no atomic operations, but gcc and clang have, for every machine and without a library for
 * what is no longer than a pointer. SC_ATOMIC is 0 with other compilers: a flag can be read there,
 * as aligned words are read and written as a whole on all machines there are, and nothing that
 * takes more is done by several threads. Nothing else is to be ordered by these operations.
 */
#ifndef SC_BASE_ATOMIC_H
#define SC_BASE_ATOMIC_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__) || defined(__clang__)
#  define SC_ATOMIC 1
#else
#  define SC_ATOMIC 0
#endif

static inline uint32_t sc_atomic_read(const volatile uint32_t *flag)
{
#if SC_ATOMIC
    return __atomic_load_n(flag, __ATOMIC_RELAXED);
#else
    return *flag;
#endif
}

static inline void sc_atomic_write(volatile uint32_t *flag, uint32_t value)
{
#if SC_ATOMIC
    __atomic_store_n(flag, value, __ATOMIC_RELAXED);
#else
    *flag = value;
#endif
}

/* Sets a byte to 1. Shared: several threads do that at once, to bytes near each other as well. Then
   only one that is not yet, as they would wait for each other; without, a test costs more. */
static inline void sc_atomic_mark(uint8_t *mark, int is_shared)
{
#if SC_ATOMIC
    if (!is_shared || !__atomic_load_n(mark, __ATOMIC_RELAXED))
        __atomic_store_n(mark, 1, __ATOMIC_RELAXED);
#else
    (void)is_shared;
    *mark = 1;
#endif
}

/* Sets a byte to another one if that is less. */
static inline void sc_atomic_lessen_byte(uint8_t *number, uint8_t less)
{
#if SC_ATOMIC
    uint8_t now = __atomic_load_n(number, __ATOMIC_RELAXED);
    int is_set = 0;
    while (!is_set && less < now)
        is_set =
            __atomic_compare_exchange_n(number, &now, less, 0, __ATOMIC_RELAXED, __ATOMIC_RELAXED);
#else
    if (less < *number) *number = less;
#endif
}

/* Adds to a number and returns what it was before. */
static inline size_t sc_atomic_add(size_t *number, size_t more)
{
#if SC_ATOMIC
    return __atomic_fetch_add(number, more, __ATOMIC_RELAXED);
#else
    size_t before = *number;
    *number += more;
    return before;
#endif
}

/* Reads a number. */
static inline size_t sc_atomic_get(const size_t *number)
{
#if SC_ATOMIC
    return __atomic_load_n(number, __ATOMIC_RELAXED);
#else
    return *number;
#endif
}

/* Sets a number that is *before, and returns 1; else sets that to what it is. */
static inline int sc_atomic_claim(size_t *number, size_t *before, size_t after)
{
#if SC_ATOMIC
    return __atomic_compare_exchange_n(number, before, after, 0, __ATOMIC_RELAXED,
                                       __ATOMIC_RELAXED);
#else
    if (*number != *before) {
        *before = *number;
        return 0;
    }
    *number = after;
    return 1;
#endif
}

/* Sets a number to another one if that is less. */
static inline void sc_atomic_least(size_t *number, size_t less)
{
    size_t before = sc_atomic_get(number);
    int is_set = 0;
    while (!is_set && less < before) is_set = sc_atomic_claim(number, &before, less);
}

/* Whether several threads may lower one double: where it is no longer than a pointer. */
#if SC_ATOMIC && SIZE_MAX >= UINT64_MAX
#  define SC_ATOMIC_DOUBLES 1
#else
#  define SC_ATOMIC_DOUBLES 0
#endif

/* Sets a number to another one if that is less. */
static inline void sc_atomic_lessen(double *number, double less)
{
#if SC_ATOMIC_DOUBLES
    double now;
    int is_set = 0;
    __atomic_load(number, &now, __ATOMIC_RELAXED);
    while (!is_set && less < now)
        is_set =
            __atomic_compare_exchange(number, &now, &less, 0, __ATOMIC_RELAXED, __ATOMIC_RELAXED);
#else
    if (less < *number) *number = less;
#endif
}

#endif

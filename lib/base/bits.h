/*
 * What compilers have and C has not, with a portable form.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_BASE_BITS_H
#define SC_BASE_BITS_H

#include <stdint.h>

/* The number of the lowest set bit of a mask that is not 0. */
static inline unsigned sc_bits_lowest(unsigned mask)
{
#if defined(__GNUC__)
    return (unsigned)__builtin_ctz(mask);
#else
    unsigned at = 0;
    while (!(mask & 1u)) {
        mask >>= 1;
        at++;
    }
    return at;
#endif
}

/* Asks for memory that will be read soon; any address will do. gcc takes functions that do nothing
   else for such that have no effect, and drops calls of them, hence the statement that is empty. */
static inline void sc_fetch(const void *address)
{
#if defined(__GNUC__)
    __builtin_prefetch(address);
    __asm__ volatile("");
#else
    (void)address;
#endif
}

/* The same of 64 bits. */
static inline unsigned sc_bits_lowest64(uint64_t mask)
{
#if defined(__GNUC__)
    return (unsigned)__builtin_ctzll(mask);
#else
    unsigned low = (unsigned)(mask & 0xffffffffu);
    return low ? sc_bits_lowest(low) : 32 + sc_bits_lowest((unsigned)(mask >> 32));
#endif
}

/* How many bits of a mask are set. Without an instruction for it the compiler's own form is a call
   into its library, which a DLL would then need. */
static inline unsigned sc_bits_count(unsigned mask)
{
#if defined(__POPCNT__) || defined(__aarch64__) || defined(__wasm__)
    return (unsigned)__builtin_popcount(mask);
#else
    mask -= mask >> 1 & 0x55555555u;
    mask = (mask & 0x33333333u) + (mask >> 2 & 0x33333333u);
    mask = (mask + (mask >> 4)) & 0x0f0f0f0fu;
    return mask * 0x01010101u >> 24;
#endif
}

/* The same of 64 bits. */
static inline unsigned sc_bits_count64(uint64_t mask)
{
    mask -= mask >> 1 & 0x5555555555555555u;
    mask = (mask & 0x3333333333333333u) + (mask >> 2 & 0x3333333333333333u);
    mask = (mask + (mask >> 4)) & 0x0f0f0f0f0f0f0f0fu;
    return (unsigned)(mask * 0x0101010101010101u >> 56);
}

#endif

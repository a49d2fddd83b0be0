/*
 * Fills structures of the public interface, of whatever size the caller knows them to be.
 *
 * SPDX-License-Identifier: MIT
 *
 * Every such structure starts with its struct_size.
 */
#ifndef SC_BASE_STRUCTS_H
#define SC_BASE_STRUCTS_H

#include <string.h>

#include "starcontour.h"

/* Whether the caller's structure takes all of a filled one that is not zero. */
static inline int sc_structs_reach(const void *to, const void *from, uint32_t size)
{
    uint32_t given, i;
    memcpy(&given, to, sizeof given);
    for (i = given; i < size; i++)
        if (((const unsigned char *)from)[i]) return 0;
    return 1;
}

/* Copies a filled structure to the caller's, but for its struct_size, as far as that reaches. */
static inline void sc_structs_write(void *to, const void *from, uint32_t size)
{
    uint32_t given;
    memcpy(&given, to, sizeof given);
    memcpy((unsigned char *)to + sizeof given, (const unsigned char *)from + sizeof given,
           (given < size ? given : size) - sizeof given);
}

#endif

/*
 * Structures of the public interface, of whatever size the caller knows them to be.
 *
 * SPDX-License-Identifier: MIT
 *
 * Every such structure starts with its struct_size.
 */
#ifndef SC_BASE_STRUCTS_H
#define SC_BASE_STRUCTS_H

#include <string.h>

#include "starcontour.h"

/*
 * Checks the caller's struct_size: a multiple of the size of a pointer, least or more, and whatever
 * reaches beyond size, which this library does not know, zero.
 */
static inline sc_status sc_structs_check(const void *from, uint32_t size, uint32_t least)
{
    uint32_t given, i;
    memcpy(&given, from, sizeof given);
    if (given < least || given % sizeof(void *)) return SC_ERROR_STRUCT_SIZE;
    for (i = size; i < given; i++)
        if (((const unsigned char *)from)[i]) return SC_ERROR_STRUCT_SIZE;
    return SC_OK;
}

/* The same, and copies what both know; the rest of *to becomes zero. */
static inline sc_status sc_structs_read(void *to, uint32_t size, const void *from, uint32_t least)
{
    uint32_t given;
    sc_status status = sc_structs_check(from, size, least);
    if (status) return status;
    memcpy(&given, from, sizeof given);
    memset(to, 0, size);
    memcpy(to, from, given < size ? given : size);
    return SC_OK;
}

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

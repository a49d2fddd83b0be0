/*
 * Looks at the header of a PLY file before assimp reads it: assimp goes on searching for the end of
 * a header that has none, believes any number of elements, and takes unknown types for others.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_PLY_HEADER_H
#define TOOLS_PLY_HEADER_H

#include <stdint.h>
#include <stdio.h>

/* What is wrong with the header of a file of that size in bytes, which is read from behind its first
   word, `ply`; NULL if nothing is. */
const char *ply_header_check(FILE *file, uint64_t size);

#endif /* TOOLS_PLY_HEADER_H */

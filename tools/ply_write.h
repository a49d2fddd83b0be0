/*
 * Writes a triangle mesh as a binary little-endian PLY file, with a colour a face if wanted.
 *
 * SPDX-License-Identifier: MIT
 *
 * Positions are written as the floats or doubles they are, so reading the file gives the same mesh.
 */
#ifndef TOOLS_PLY_WRITE_H
#define TOOLS_PLY_WRITE_H

#include <stdbool.h>
#include <stdint.h>

/*
 * positions: 3 * vertex_count of position_type (SC_FLOAT or SC_DOUBLE); indices: 3 *
 * triangle_count; colors: red, green, blue of each face, 3 * triangle_count, or NULL. On failure
 * errno says why and what was written is of no use.
 */
bool ply_write(const char *path, const void *positions, uint32_t position_type,
               uint32_t vertex_count, const uint32_t *indices, uint32_t triangle_count,
               const uint8_t *colors);

#endif /* TOOLS_PLY_WRITE_H */

/*
 * Reads PLY files: text, little-endian and big-endian.
 *
 * SPDX-License-Identifier: MIT
 *
 * Greg Turk, "The PLY Polygon File Format", 1994: all scalar types under both of their names, list
 * properties, elements and properties in any order; what is not vertices' x, y, z, or the corners
 * of faces or triangle strips, is skipped. Lines of the header end in LF, CR, or CR and LF. Data
 * may begin with any byte: the first line shows how lines end, and so where the last one does.
 *
 * Numbers in text are read as the nearest doubles, also where a property is said to be a float. A
 * file that is cut short, says of itself what cannot be, or names a vertex that does not exist is
 * an error; so is text that goes on behind what the header says.
 *
 * Cost: linear.
 */
#ifndef TOOLS_PLY_READ_H
#define TOOLS_PLY_READ_H

#include "polygon_mesh.h"

/* Whether a file of size bytes begins as a PLY file does. */
bool ply_read_knows(const char *data, size_t size);

/* Reads size bytes, which have a 0 behind them; path is for messages. On failure *mesh is empty and
   error, of error_size characters, says why. */
bool ply_read(polygon_mesh *mesh, const char *path, const char *data, size_t size, char *error,
              size_t error_size);

#endif /* TOOLS_PLY_READ_H */

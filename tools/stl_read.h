/*
 * Reads STL files, text and binary.
 *
 * SPDX-License-Identifier: MIT
 *
 * Each corner of each facet is a vertex of its own. Numbers of text files are the nearest doubles;
 * those of binary files are floats. Each `solid` of a text file is an object. Lines end in LF, CR,
 * or CR and LF. Normals, attributes and what follows the facets of a binary file are ignored. A
 * file that is cut short, or has room for more facets than it says, is an error.
 *
 * Cost: linear.
 */
#ifndef TOOLS_STL_READ_H
#define TOOLS_STL_READ_H

#include "polygon_mesh.h"

/* Whether a file of size bytes, which have a 0 behind them, begins as a text STL file does. */
bool stl_read_knows(const char *data, size_t size);

/* Reads size bytes, which have a 0 behind them; path is for messages. On failure *mesh is empty and
   error, of error_size characters, says why. */
bool stl_read(polygon_mesh *mesh, const char *path, const char *data, size_t size, char *error,
              size_t error_size);

#endif /* TOOLS_STL_READ_H */

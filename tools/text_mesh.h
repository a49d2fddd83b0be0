/*
 * Reads the faces and positions of OBJ and OFF files.
 *
 * SPDX-License-Identifier: MIT
 *
 * These two text formats are read here because what matters to this library is vertex identity, the
 * order of faces and every digit: numbers are rounded to the nearest double, vertices and faces
 * keep the numbers they have in the file, and a file that is cut short or names a vertex that does
 * not exist, has more faces than it says, or holds a byte that no text has, is an error with a line
 * number. Lines end in LF, CR, or CR and LF. Colours, normals, texture coordinates, materials,
 * points and lines are ignored. Objects of OBJ are those of `o`, or, where there are not two of
 * them with faces, of `g` if that tells more apart. OFF: text only, one vertex or face a line,
 * comments anywhere.
 *
 * Cost: linear.
 */
#ifndef TOOLS_TEXT_MESH_H
#define TOOLS_TEXT_MESH_H

#include "polygon_mesh.h"

/* Reads the size bytes of a file, which have a 0 behind them and are changed; path is for messages.
   On failure *mesh is empty and error, of error_size characters, says why. */
bool text_mesh_read(polygon_mesh *mesh, const char *path, bool is_off, char *text, size_t size,
                    char *error, size_t error_size);

#endif /* TOOLS_TEXT_MESH_H */

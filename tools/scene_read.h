/*
 * Reads files of any format that assimp knows.
 *
 * SPDX-License-Identifier: MIT
 *
 * assimp hands out floats, of formats that hold decimals or doubles too, and node transforms of
 * floats. Positions are moved by these in doubles. `rounded` says that either may have cost digits:
 * in all formats but glTF, whose positions are floats, and where a transform does more than
 * exchange axes.
 *
 * Faces are those of the scene's meshes in the order of its nodes; each node that has meshes is an
 * object, of its name.
 */
#ifndef TOOLS_SCENE_READ_H
#define TOOLS_SCENE_READ_H

#include "polygon_mesh.h"

/* Whether the ending of a name, but for .gz, is of a format that assimp reads. */
bool scene_read_knows(const char *path);

/*
 * Reads a file that is there. data: NULL, or its size bytes if they cannot be had from the path, as
 * of pipes; formats of several files cannot be read then. On failure *mesh is empty and error, of
 * error_size characters, says why, beginning with the path.
 */
bool scene_read(polygon_mesh *mesh, const char *path, const char *data, size_t size, char *error,
                size_t error_size);

#endif /* TOOLS_SCENE_READ_H */

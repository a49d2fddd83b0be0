/*
 * About how deep the parts of a mesh lie in each other where they collide.
 *
 * SPDX-License-Identifier: MIT
 *
 * Only closed parts that are oriented have an inside. The colliding triangles cut the surface into
 * regions: vertices joined by triangles that collide with nothing, which are on one side of
 * whatever the surface passes through. One vertex of a region says whether all of it is buried,
 * that is, whether a point just outside of it is inside of some part (the winding number there is 1
 * or more). The depth of a buried vertex is its distance to the rest of the surface: to triangles
 * without a vertex of its region, and to where pairs meet. That of a place is the largest among the
 * buried regions that it borders on.
 *
 * It is an estimate, in double precision, for telling scratches from gashes: only vertices are
 * looked at, and one of them answers for its region. It is not known of a place where only edges
 * pass through faces and no vertex is buried, nor of one in which no closed part takes part.
 */
#ifndef TOOLS_PLACE_DEPTH_H
#define TOOLS_PLACE_DEPTH_H

#include "places.h"

/* Sets the depth of each place; false if there is no memory. Linear in the mesh, but for buried
   vertices, each of which looks for the surface round it, and which are given up after fifty
   million triangles in all: what was not looked at by then is left out. */
bool place_depths(place_list *list, const place_source *source);

#endif /* TOOLS_PLACE_DEPTH_H */

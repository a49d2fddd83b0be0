/*
 * Making a hierarchy of patches flatter where few leaves are deep.
 *
 * SPDX-License-Identifier: MIT
 *
 * Every level has all leaf clusters that end above it (build/xbvh.h), so that a level costs some 3
 * bytes a triangle, though often a few clusters alone are that deep: where a cut tears an island
 * off a patch, which becomes a patch of its own. Such levels are taken away, if but few patches
 * have to be cut anew for it: they divide their row of leaves elsewhere, most often so that the
 * island stays with its neighbor further down. All other patches, and the order of the leaves,
 * remain.
 *
 * Time and memory are linear in the number of leaves.
 */
#ifndef SC_BUILD_FLATTENING_H
#define SC_BUILD_FLATTENING_H

#include "build/hierarchy.h"

sc_status sc_flattening_run(sc_scratch *scratch, sc_hierarchy *hierarchy);

#endif

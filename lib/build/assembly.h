/*
 * Putting a model together of what the steps of a build have made.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_BUILD_ASSEMBLY_H
#define SC_BUILD_ASSEMBLY_H

#include "build/csf.h"
#include "build/hierarchy.h"
#include "build/model.h"
#include "build/sctt.h"
#include "build/sharing.h"

/* Makes the model, with all of its arrays. What the rest pose says of nodes and levels is left at
   zero. SC_ERROR_COUNT or SC_ERROR_MEMORY, and then there is no model. */
sc_status sc_assembly_make(const sc_points *points, sc_adjacency *adjacency,
                           const sc_hierarchy *hierarchy, const sc_xbvh *xbvh, const sc_sctt *sctt,
                           const sc_csf *csf, const sc_sharing *sharing, sc_scratch *scratch,
                           sc_model **model);

/* While a model is being built, these arrays of it may be written to. */
sc_node *sc_assembly_nodes(sc_model *model);
sc_level *sc_assembly_levels(sc_model *model);

#endif

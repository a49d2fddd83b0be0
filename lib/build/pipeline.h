/*
 * From a mesh to a model: what depends on the topology, one step after the other.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_BUILD_PIPELINE_H
#define SC_BUILD_PIPELINE_H

#include "build/model.h"

/* Makes a model, to be released by the caller, whose nodes are not marked by the rest pose. Options
   have values that exist, and hooks. On failure *model is as before. */
sc_status sc_pipeline_run(const sc_mesh *mesh, const sc_build_options *options, sc_scratch *scratch,
                          sc_model **model);

/* Tells the log what the caller may want to know of the mesh of a model. */
void sc_pipeline_log_facts(const sc_hooks *hooks, const sc_model *model);

#endif

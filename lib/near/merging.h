/*
 * Stencils of the same vertices, or of the same vertex and edge, made one. See sc_near_merge in
 * starcontour.h.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_NEAR_MERGING_H
#define SC_NEAR_MERGING_H

#include "starcontour.h"

/* Both arrays have count entries, below 2^32. Returns how many are left. */
uint32_t sc_merging_run(sc_near_stencil *stencils, uint32_t count, uint32_t *multiplicities);

#endif

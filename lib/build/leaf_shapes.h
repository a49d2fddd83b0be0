/*
 * Shapes of leaf clusters: what the topology alone tells of them, so that a query can see at once
 * whether their triangles have only in common what they share.
 *
 * SPDX-License-Identifier: MIT
 *
 * Each function fills an array of a model, as build/model.h describes it, from those that are there
 * already: leaf_first, leaf_point and leaf_corner; of two leaf clusters that share points also
 * share_first and share_leaf. Cost: linear,
 * shared out among the host's tasks, if there are any.
 */
#ifndef SC_BUILD_LEAF_SHAPES_H
#define SC_BUILD_LEAF_SHAPES_H

#include "build/model.h"

/* Which points have all their triangles of the cluster in one fan: leaf_fan. */
void sc_leaf_shapes_fans(const sc_model *model, const sc_tasks *tasks, uint16_t *fan);

/* The chains of edges round each cluster: leaf_outline. */
void sc_leaf_shapes_outlines(const sc_model *model, const sc_tasks *tasks, uint8_t *outline);

/* Where two clusters have the one point that they share, or that they share a chain: share_touch;
   reads leaf_outline as well. */
void sc_leaf_shapes_touches(const sc_model *model, const sc_tasks *tasks, uint16_t *touch);

#endif

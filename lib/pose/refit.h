/*
 * Boxes of patches for a pose: linear refit, bottom up.
 *
 * SPDX-License-Identifier: MIT
 *
 * Boxes are taken of the positions rounded to float and then widened by one step of rounding:
 * rounding keeps order, so the box of the rounded points bounds the true ones up to half a step.
 */
#ifndef SC_POSE_REFIT_H
#define SC_POSE_REFIT_H

#include "pose/frame.h"

/* Fills patch_boxes, and point_at, unless they are ready. */
void sc_refit_boxes(const sc_model *model, sc_frame *frame);

#endif

/*
 * Closed fans that project one to one: the contour test at the smallest scale.
 *
 * SPDX-License-Identifier: MIT
 *
 * If the triangles round a point keep a positive area under some projection and turn round the
 * point just once, any two of them meet only in what they share. That settles pairs that share a
 * vertex and that faster tests leave open, for they are nearly flat (query/neighbor_kernel.h,
 * query/decide_kernel.h).
 */
#ifndef SC_POSE_FAN_H
#define SC_POSE_FAN_H

#include "pose/workspace.h"

/* 1 if the fan round a point certainly projects one to one in this pose. About 150 ns;
   sc_fan_is_plain remembers some points. */
int sc_fan_test(const sc_model *model, const sc_workspace *workspace, uint32_t point);
int sc_fan_is_plain(const sc_model *model, sc_workspace *workspace, uint32_t point);

#endif

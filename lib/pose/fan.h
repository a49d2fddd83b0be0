/*
 * Closed fans that project one to one: the contour test at the smallest scale.
 *
 * SPDX-License-Identifier: MIT
 *
 * If the triangles round a point keep a positive area under some projection and turn round the point
 * just once, any two of them meet only in what they share. So the five or so pairs per triangle that
 * share a vertex need one test a vertex, and the pairs that share an edge none.
 */
#ifndef SC_POSE_FAN_H
#define SC_POSE_FAN_H

#include "pose/workspace.h"

/* The test itself: 1 if the fan round a point certainly projects one to one in this pose. */
int sc_fan_test(const sc_model *model, const sc_workspace *workspace, uint32_t point);

/* The same, in single precision where that is enough; notes the answer in workspace->fan. */
void sc_fan_test_of_pose(const sc_model *model, sc_workspace *workspace, uint32_t point);

/* The same, computed once a pose. */
static inline int sc_fan_is_plain(const sc_model *model, sc_workspace *workspace, uint32_t point)
{
    if (workspace->fan[point] >> 1 != workspace->pose_tick)
        sc_fan_test_of_pose(model, workspace, point);
    return (int)(workspace->fan[point] & 1);
}

/* Bit i: the fans at all three corners of triangle i of a leaf cluster project one to one. Computed once a
   pose. */
unsigned sc_fan_plain_of_leaf(const sc_model *model, sc_workspace *workspace, uint32_t leaf);

#endif

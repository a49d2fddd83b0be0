/*
 * Discrete normal cones (DNC; Volino and Magnenat-Thalmann 1994) of all patches.
 *
 * SPDX-License-Identifier: MIT
 *
 * 14 directions: the six face normals and eight diagonals of a cube. Bit i of a patch's mask is set
 * only if every triangle of the patch has a normal with a positive dot product with direction i, in
 * exact arithmetic; it may be clear although that is so, within rounding, and where most of what is
 * near has no cone (pose/pose_kernels.h). The cone of a patch is the intersection (AND) of its
 * children's.
 */
#ifndef SC_POSE_DNC_H
#define SC_POSE_DNC_H

#include "pose/frame.h"

enum { SC_DNC_DIRECTIONS = 14 };

/* A projection R^3 -> R^2: x = u . (p - origin), y = w . (p - origin), u and w small integers. */
typedef struct sc_projection {
    double u[3], w[3], origin[3];
    double x_error, y_error; /* |computed - true| at most */
} sc_projection;

/* Fills mask, and point_at. */
void sc_dnc_update(const sc_model *model, sc_frame *frame);

/* For debug builds and tests: 1 if every leaf cluster's mask is the AND of those of its triangles,
   each computed alone, or 0 as its group asks for; and every patch's that of its leaf clusters. */
int sc_dnc_validate(const sc_model *model, const sc_frame *frame);

/*
 * A projection along the average of the directions in a mask that is not 0: every triangle of a
 * patch with these bits keeps a positive area, exactly.
 */
void sc_dnc_projection(const sc_frame *frame, uint32_t mask, sc_projection *projection);

/* The vectors of some of these, integers that floats hold exactly. */
enum { SC_DNC_VECTORS = 8 };
void sc_dnc_vectors(const uint16_t mask[SC_DNC_VECTORS], float u[3][SC_DNC_VECTORS],
                    float w[3][SC_DNC_VECTORS]);

#endif

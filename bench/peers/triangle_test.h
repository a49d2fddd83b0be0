/*
 * Whether two closed triangles have a common point: the test behind peers that bring only a tree.
 *
 * Exact: signs come from double arithmetic where its error bound (J. R. Shewchuk, "Adaptive
 * Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997, section 4)
 * decides, else from exact sums of products. Two limits: of triangles without area it may say
 * something wrong, and coordinates other than zero must lie between 1e-80 and 1e80, so that no
 * product underflows or overflows. It shares no code with the library: pairs found with it check
 * the library's.
 *
 * Cost: three to six determinants if the triangles are apart, up to 24 if not.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PEERS_TRIANGLE_TEST_H
#define PEERS_TRIANGLE_TEST_H

namespace peers
{

/* Six points, x, y, z each: the corners of the first triangle and of the second. */
bool triangles_meet(const double *const a[3], const double *const b[3]);

} // namespace peers

#endif /* PEERS_TRIANGLE_TEST_H */

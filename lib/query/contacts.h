/*
 * Where the two of a pair meet: a point, a segment, or an area of their common plane.
 *
 * SPDX-License-Identifier: MIT
 *
 * What the intersection is made of is decided by exact signs; only then are coordinates computed,
 * as weighted means whose weights are determinants known to a relative error of 2^-51. So a point
 * is as good for slivers and nearly parallel planes as for any other pair. No overflow, no NaN.
 *
 * Cost: 1 to 3 us a pair.
 */
#ifndef SC_QUERY_CONTACTS_H
#define SC_QUERY_CONTACTS_H

#include "starcontour.h"

/*
 * The intersection of two closed triangles, as starcontour.h says of sc_contact; for an edge from p
 * to q give p, q, q.
 */
void sc_contacts_find(const double *const a[3], const double *const b[3], sc_contact *contact);

/* Where an edge passes properly (SC_CONTACT_PROPER) through a triangle, which is known: the weight
   of its second end, those of the triangle's corners, and the point, as accurate as in a
   contact. */
double sc_contacts_pass(const double *const edge[2], const double *const triangle[3],
                        double weights[3], double point[3]);

#endif

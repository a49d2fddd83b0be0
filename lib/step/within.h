/*
 * Is the distance of a point and a triangle, or of two segments, at most so much? Exactly.
 *
 * SPDX-License-Identifier: MIT
 *
 * The answer is 1 if and only if the Euclidean distance of the two closed sets, of the real numbers
 * that the doubles are, is the given one or less. All finite doubles are allowed, the distance
 * being 0 or more; so are triangles without area and segments without length. The answer does not
 * depend on the order of corners, ends or segments, nor on compiler or machine.
 *
 * Three stages, each of which answers only what it is sure of:
 *   - doubles: two proofs, that of a point that is near enough and that of a direction that
 *     separates. Settles what is not within a few roundings of the distance;
 *   - words: where all coordinates and the distance are multiples of one power of two and below
 *     2^61 times it. That is so of grids, and of most points of which no coordinate is much smaller
 *     than the others;
 *   - integers as long as it takes, up to 2,112 bits for a coordinate.
 * They take about 25 to 80 ns, 20 to 150 ns, and 1 microsecond where exponents differ by 20, up to
 * 100 microseconds for the whole range of doubles.
 */
#ifndef SC_STEP_WITHIN_H
#define SC_STEP_WITHIN_H

/* p[0] is the vertex, p[1] to p[3] are the corners of the face. */
int sc_within_vertex_face(const double p[4][3], double distance);

/* p[0] and p[1] are the ends of one edge, p[2] and p[3] those of the other. */
int sc_within_edge_edge(const double p[4][3], double distance);

/*
 * The stages by themselves. Where the nearest points are, is first guessed; a guess tells later
 * stages what to look at first, and no answer depends on it. Guess 0 is as good as any.
 */
typedef enum sc_within_kind { SC_WITHIN_VERTEX_FACE, SC_WITHIN_EDGE_EDGE } sc_within_kind;

enum { SC_WITHIN_UNSURE = -1 };

/* 1, 0 or SC_WITHIN_UNSURE. The first sets *guess, the second takes one. */
int sc_within_by_doubles(sc_within_kind kind, const double p[4][3], double distance, int *guess);
int sc_within_by_words(sc_within_kind kind, const double p[4][3], double distance, int guess);

/* 1 or 0. Takes up to 19 KB of stack. */
int sc_within_by_integers(sc_within_kind kind, const double p[4][3], double distance, int guess);

#endif /* SC_STEP_WITHIN_H */

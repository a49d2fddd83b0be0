#!/usr/bin/env python3
"""Writes expected.csv: the pairs of each mesh of this folder, by brute force in whole numbers.

SPDX-License-Identifier: MIT

Follows the definitions of starcontour.h to the letter and shares nothing with the library. Two convex
sets meet if and only if the origin is in the convex hull of the differences of their corners; by
Caratheodory's theorem it is then in a simplex of at most four of them that has full dimension, and for
whole numbers that is a matter of signs. Slow: only pairs whose boxes meet are looked at.
"""
import csv
import itertools
import os
import sys
from fractions import Fraction

SCALE = 1024  # all coordinates are whole multiples of 1 / SCALE


def read_obj(path):
    points, triangles = [], []
    for line in open(path):
        words = line.split()
        if words and words[0] == "v":
            point = tuple(Fraction(w) * SCALE for w in words[1:4])
            assert all(c.denominator == 1 for c in point), path
            points.append(tuple(int(c) for c in point))
        elif words and words[0] == "f":
            triangles.append(tuple(int(w) - 1 for w in words[1:4]))
    return points, triangles


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def det(a, b, c):
    return dot(a, cross(b, c))


ZERO = (0, 0, 0)


def origin_in_segment(a, b):
    return cross(a, b) == ZERO and dot(a, b) <= 0


def origin_in_triangle(a, b, c):
    n = cross(sub(b, a), sub(c, a))
    if n == ZERO or dot(n, a) != 0:
        return False  # no area (its sides are looked at on their own), or another plane
    return dot(n, cross(a, b)) >= 0 and dot(n, cross(b, c)) >= 0 and dot(n, cross(c, a)) >= 0


def origin_in_tetrahedron(a, b, c, d):
    v = det(sub(b, a), sub(c, a), sub(d, a))
    if v == 0:
        return False
    s = 1 if v > 0 else -1
    return (s * det(b, c, d) >= 0 and s * det(a, d, c) >= 0 and s * det(a, b, d) >= 0
            and s * det(a, c, b) >= 0)


def convex_sets_meet(first, second):
    points = list({sub(p, q) for p in first for q in second})
    if ZERO in points:
        return True
    for k in range(3):  # cheap: a coordinate that has one sign
        if all(p[k] > 0 for p in points) or all(p[k] < 0 for p in points):
            return False
    return (any(origin_in_segment(*s) for s in itertools.combinations(points, 2))
            or any(origin_in_triangle(*s) for s in itertools.combinations(points, 3))
            or any(origin_in_tetrahedron(*s) for s in itertools.combinations(points, 4)))


def passes_through(p, q, a, b, c):
    """The inside of segment p q goes through the inside of triangle a b c, from side to side."""
    n = cross(sub(b, a), sub(c, a))
    if dot(n, sub(p, a)) * dot(n, sub(q, a)) >= 0:
        return False
    d = sub(q, p)
    turns = [det(d, sub(u, p), sub(v, p)) for u, v in ((a, b), (b, c), (c, a))]
    return all(t > 0 for t in turns) or all(t < 0 for t in turns)


def boxes_meet(first, second):
    return all(min(p[k] for p in first) <= max(q[k] for q in second)
               and min(q[k] for q in second) <= max(p[k] for p in first) for k in range(3))


class Mesh:
    def __init__(self, path):
        self.points, self.read = read_obj(path)
        first = {}
        weld = [first.setdefault(p, i) for i, p in enumerate(self.points)]
        self.triangles = [tuple(weld[v] for v in t) for t in self.read]
        self.edges = sorted({tuple(sorted((t[k], t[(k + 1) % 3]))) for t in self.triangles
                             for k in range(3) if t[k] != t[(k + 1) % 3]})

    def at(self, vertices):
        return [self.points[v] for v in vertices]

    def triangles_meet(self, i, j):
        s, t = set(self.triangles[i]), set(self.triangles[j])
        common = s & t
        if len(common) == 0:
            return convex_sets_meet(self.at(s), self.at(t))
        if len(common) == 3:
            return True
        if len(common) == 1:
            # With a doubled corner "the edge opposite" would not be one edge.
            assert len(s) == 3 and len(t) == 3, "not defined"
            return (convex_sets_meet(self.at(s - common), self.at(t))
                    or convex_sets_meet(self.at(t - common), self.at(s)))
        p, q = self.at(sorted(common))
        if len(s) == 2 or len(t) == 2:
            return False  # one is the common edge itself
        (u,), (v,) = self.at(s - common), self.at(t - common)
        d = sub(q, p)
        m, n = cross(d, sub(u, p)), cross(d, sub(v, p))
        if m == ZERO and n == ZERO:  # all on one line: both go on beyond the same end
            return ((dot(d, sub(u, q)) > 0 and dot(d, sub(v, q)) > 0)
                    or (dot(d, sub(u, p)) < 0 and dot(d, sub(v, p)) < 0))
        return cross(m, n) == ZERO and dot(m, n) > 0

    def edge_meets(self, edge, triangle, proper):
        if set(edge) & set(triangle):
            return False
        p, a = self.at(edge), self.at(triangle)
        if not boxes_meet(p, a):
            return False
        return passes_through(*p, *a) if proper else convex_sets_meet(p, self.at(set(triangle)))

    def edge_pairs(self, proper):
        return sum(self.edge_meets(e, t, proper) for e in self.edges for t in self.triangles)

    def triangle_pairs(self, proper):
        count = 0
        for i, j in itertools.combinations(range(len(self.triangles)), 2):
            s, t = self.triangles[i], self.triangles[j]
            if not boxes_meet(self.at(s), self.at(t)):
                continue
            if not proper:
                count += self.triangles_meet(i, j)
                continue
            sides = [((x[k], x[(k + 1) % 3]), y) for x, y in ((s, t), (t, s)) for k in range(3)]
            count += any(self.edge_meets(e, x, True) for e, x in sides)
        return count


def main():
    folder = os.path.dirname(os.path.abspath(sys.argv[0]))
    with open(os.path.join(folder, "expected.csv"), "w", newline="") as out:
        rows = csv.writer(out, lineterminator="\n")
        rows.writerow(["name", "vertices", "triangles", "triangle_pairs", "edge_triangle_pairs",
                       "proper_triangle_pairs", "proper_edge_triangle_pairs"])
        for file in sorted(f for f in os.listdir(folder) if f.endswith(".obj")):
            mesh = Mesh(os.path.join(folder, file))
            row = [file[:-4], len(mesh.points), len(mesh.triangles), mesh.triangle_pairs(False),
                   mesh.edge_pairs(False), mesh.triangle_pairs(True), mesh.edge_pairs(True)]
            print(*row)
            rows.writerow(row)


main()

#!/usr/bin/env python3
"""Times others that trace curves of self-intersection beside sc_trace, and compares the curves.

    trace_curves.py --peer libigl|cgal|meshlib --lib LIBRARY [--cgal FILE] [--frames F,...] [--repeats N]
                    [--csv FILE] SCENE...

A SCENE is a folder as sc-bench --export writes it. In one process, on one processor, all have their turn in
each frame:

  pairs           sc_query: all pairs of an edge and a triangle, in touch, which sc_trace asks for
  sc_trace        of these pairs the contours: nodes, points, lengths. Pairs are not in its time
  libigl          igl.copyleft.cgal.remesh_self_intersections: the mesh cut along its intersections, by CGAL's
                  exact constructions; curves are the edges of the result at which sheets meet
  cgal            surface_self_intersection: polylines; --cgal names the library made of trace_cgal.cpp
  meshlib         findSelfCollidingEdgeTrisPrecise: pairs of an edge and a triangle, of coordinates rounded to
                  whole numbers; orderSelfIntersectionContours: contours, without points. MeshLib takes floats,
                  so ours gets these beside it

What is compared, in the first turn: how many curves are closed, how many are open, their total length, and
the length of each, in order of size. Where three sheets meet in a point, sc_trace's contours go straight on
through it, while others end or share a node there; theirs are put together in the same way. In a frame in
which something touches without crossing, curves depend on how ties are decided: it is not compared
(degenerate). Lengths may differ by 1e-12, relative, and by what rounding of coordinates to doubles does to
a contour's points, which is more than that on short ones.

Columns: off is the difference of total lengths, relative; verdict is match, differ or degenerate. MeshLib
rounds coordinates, so a difference is no error; its contours have no points, and the verdict is about their
numbers.

Exit status: 0; 1 if curves differ from those of libigl or CGAL; 2 if a scene or an option cannot be used; 3
if the peer cannot be had.

SPDX-License-Identifier: MIT
"""

import argparse
import collections
import ctypes
import importlib.metadata
import math
import statistics
import sys
import time

import numpy as np

import peers

COLUMNS = "scene,triangles,frame,peer,version,what,ms,ms_min,pairs,closed,open,length,off,verdict,beside"

# Lengths may differ by so much, relative, and for each node of a contour by so much of the largest coordinate.
TOLERANCE = 1e-12
ROUNDING = 2.0 ** -50

# What takes more seconds is asked once, and not in turns.
SLOW = 5

U32, U64, POINTER, DOUBLE = ctypes.c_uint32, ctypes.c_uint64, ctypes.c_void_p, ctypes.c_double
sc_trace_result = peers.structure(
    "sc_trace_result", ("struct_size", U32), ("reserved", U32),
    ("node_count", U64), ("node_capacity", U64), ("nodes", POINTER),
    ("contour_count", U64), ("contour_capacity", U64), ("contours", POINTER))
NODE = np.dtype([("edge", "u4"), ("triangle", "u4"), ("sheet", "u4"), ("sheets", "u4", 2), ("reserved", "u4"),
                 ("along", "f8"), ("weights", "f8", 3), ("point", "f8", 3)])
CONTOUR = np.dtype([("first", "u8"), ("count", "u8"), ("begin", "u4"), ("end", "u4"), ("flags", "u4"),
                    ("reserved", "u4"), ("length", "f8")])
SC_TRACE_CLOSED = 0


class Curves:
    """Lengths of curves, ascending, those that are closed and those that are not."""

    def __init__(self, lengths, closed):
        lengths, closed = np.asarray(lengths, float), np.asarray(closed, bool)
        self.closed, self.open = np.sort(lengths[closed]), np.sort(lengths[~closed])
        self.total = math.fsum(lengths)

    def off(self, other):
        """How far the total length of another is from this one, relative."""
        return abs(other.total - self.total) / self.total if self.total else float(other.total != 0)


class Trace:
    """starcontour on a scene: pairs and contours."""

    def __init__(self, library, scene, scalar):
        self.ours, self.scalar = peers.Starcontour(library, scene, scalar), scalar
        self.library = self.ours.library
        self.library.sc_trace.argtypes = [POINTER, POINTER, POINTER, U64, POINTER, POINTER]
        self.nodes, self.contours = np.empty(1024, NODE), np.empty(64, CONTOUR)
        self.counts = 0, 0

    def pairs(self, positions, **how):
        self.ours.query("exact", positions, peers.SC_PAIRS_EDGE, **how)
        return self.ours.count

    def contours_of(self, positions):
        """Traces those of the latest pairs."""
        pose = self.ours.pose(positions)
        while True:
            result = sc_trace_result(struct_size=ctypes.sizeof(sc_trace_result),
                                     node_capacity=len(self.nodes), nodes=self.nodes.ctypes.data,
                                     contour_capacity=len(self.contours), contours=self.contours.ctypes.data)
            status = self.library.sc_trace(self.ours.model, ctypes.byref(pose), self.ours.pairs.buffer_info()[0],
                                           self.ours.count, None, ctypes.byref(result))
            self.counts = result.node_count, result.contour_count
            if status != peers.SC_ERROR_SHORT_BUFFER:
                return self.ours.must(status)
            self.nodes = np.empty(max(len(self.nodes), result.node_count), NODE)
            self.contours = np.empty(max(len(self.contours), result.contour_count), CONTOUR)

    def curves(self):
        found = self.contours[: self.counts[1]]
        return Curves(found["length"], found["begin"] == SC_TRACE_CLOSED)

    def touches(self, positions):
        """Whether something touches and does not cross: an edge and a triangle, or a triangle folded flat onto its
        neighbour, which no such pair tells of."""
        proper, touching = (self.pairs(positions, contact=contact)
                            for contact in (peers.SC_CONTACT_PROPER, peers.SC_CONTACT_TOUCHING))
        if proper != touching:
            return True
        corners = np.array(self.ours.scene.corners).reshape(-1, 3)
        self.ours.query("exact", positions)
        two = np.array(self.ours.pairs[: 2 * self.ours.count], np.int64).reshape(-1, 2)
        shared = (corners[two[:, 0]][:, :, None] == corners[two[:, 1]][:, None, :]).sum(axis=(1, 2))
        return bool((shared > 1).any())

    def rounding(self, positions):
        """How far lengths may be off for the rounding of points: of all contours, and of the longest."""
        unit = ROUNDING * float(np.abs(np.frombuffer(positions, self.scalar)).max())
        counts = self.contours["count"][: self.counts[1]]
        return unit * float(counts.sum()), unit * float(counts.max(initial=0))

    def judge(self, positions, other):
        """Whether another's curves are ours."""
        mine, (total, longest) = self.curves(), self.rounding(positions)
        if len(mine.closed) != len(other.closed) or len(mine.open) != len(other.open):
            return False
        if abs(mine.total - other.total) > TOLERANCE * mine.total + total:
            return False
        return all((np.abs(a - b) <= TOLERANCE * a + longest).all()
                   for a, b in ((mine.closed, other.closed), (mine.open, other.open)))


# ---------------------------------------------------------------------------------------------------
# Curves put together of parts


class Links:
    """Parts of curves, of which ends are joined two by two."""

    def __init__(self, lengths):
        self.lengths, self.above = lengths, list(range(len(lengths)))
        self.joined = [0] * len(lengths)

    def root(self, part):
        while self.above[part] != part:
            self.above[part] = self.above[self.above[part]]
            part = self.above[part]
        return part

    def join(self, a, b):
        self.joined[a] += 1
        self.joined[b] += 1
        self.above[self.root(a)] = self.root(b)

    def curves(self):
        """A curve is closed if all of its parts are joined at both ends."""
        parts = collections.defaultdict(list)
        for part in range(len(self.lengths)):
            parts[self.root(part)].append(part)
        return Curves([math.fsum(self.lengths[p] for p in group) for group in parts.values()],
                      [all(self.joined[p] == 2 for p in group) for group in parts.values()])


def by_triangles(points, faces, births, corners, vertices):
    """The curves of a mesh that was cut along its intersections; None if it is not cut as crossing sheets are.

    births are the triangles of which faces are parts; these have corners, places in vertices. A curve's edge has
    parts of two triangles on both of its sides. Behind its ends the curve goes on in the same two, or in one of
    them and a neighbour of the other, but not behind a vertex of the mesh, or an edge of three triangles."""
    sides = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    edges, where, counts = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(where.ravel(), kind="stable")
    starts = np.concatenate([[0], np.cumsum(counts)])
    fixed = {tuple(vertex) for vertex in vertices.tolist()}
    sets = [set(map(int, triangle)) for triangle in corners]
    pairs, used = [], []
    for edge in np.flatnonzero(counts > 2):
        pair = sorted({int(births[side // 3]) for side in order[starts[edge] : starts[edge + 1]]})
        if len(pair) == counts[edge] and len(set.intersection(*(sets[x] for x in pair))) > 1:
            continue  # an edge of three or more triangles of the mesh
        if counts[edge] != 4 or len(pair) != 2:
            return None
        pairs.append(tuple(pair))
        used.append(edge)
    ends = edges[np.array(used, int)]
    links = Links(np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1).tolist())
    at = collections.defaultdict(list)
    for part, both in enumerate(ends.tolist()):
        for vertex in both:
            at[vertex].append(part)

    def goes_on(a, b):
        others = set(a) ^ set(b)
        return not others or len(others) == 2 and len(set.intersection(*(sets[x] for x in others))) == 2

    for vertex, parts in at.items():
        if tuple(points[vertex].tolist()) in fixed:
            continue
        following = {a: [b for b in parts if a != b and goes_on(pairs[a], pairs[b])] for a in parts}
        for a, behind in following.items():
            # Several: an edge of three or more triangles, at which curves end.
            if len(behind) == 1 and behind[0] < a and len(following[behind[0]]) == 1:
                links.join(a, behind[0])
    return links.curves()


def by_directions(polylines, vertices):
    """The curves of polylines, arrays of points. They end at vertices of the mesh. Where three meet, ends that are
    opposite each other are joined: there two triangles pass through a third, and all three segments go on straight."""
    fixed = {tuple(vertex) for vertex in vertices.tolist()}
    parts = []
    for line in polylines:
        inside = [i for i, point in enumerate(line.tolist()) if 0 < i < len(line) - 1 and tuple(point) in fixed]
        bounds = [0, *inside, len(line) - 1]
        parts += [line[a : b + 1] for a, b in zip(bounds, bounds[1:])]
    links = Links([math.fsum(np.linalg.norm(np.diff(line, axis=0), axis=1)) for line in parts])
    at = collections.defaultdict(list)
    for part, line in enumerate(parts):
        for end, inner in ((line[0], line[1]), (line[-1], line[-2])):
            across = inner - end
            at[tuple(end.tolist())].append((part, across / np.linalg.norm(across)))
    for point, found in at.items():
        if point in fixed or len(found) not in (2, 6):
            continue
        free = set(range(len(found)))
        for _, i, j in sorted((float(a @ b), i, j) for i, (_, a) in enumerate(found)
                              for j, (_, b) in enumerate(found[:i])):
            if i in free and j in free:
                free -= {i, j}
                links.join(found[i][0], found[j][0])
    return links.curves()


# ---------------------------------------------------------------------------------------------------
# Peers: each is a function of a scene and of the command line, and returns version and ways


class Way:
    """One way of using a peer: query is timed; curves makes Curves of what it returned and of the vertices, or None
    if they cannot be told."""

    def __init__(self, what, query, curves=None):
        self.what, self.query, self.curves = what, query, curves


def libigl(scene, _):
    from igl.copyleft import cgal

    corners = np.array(scene.corners, dtype=np.int64).reshape(-1, 3)

    def query(vertices):
        return cgal.remesh_self_intersections(vertices, corners, stitch_all=True)

    def curves(found, vertices):
        points, faces, _, births, _ = found
        return by_triangles(points, faces, births, corners, vertices)

    return importlib.metadata.version("libigl"), [
        Way("remesh_self_intersections: exact constructions; the mesh cut and stitched", query, curves)]


def cgal(scene, arguments):
    try:
        library = ctypes.CDLL(arguments.cgal)
    except (OSError, TypeError) as error:
        raise peers.Skipped(f"its library: {error}") from None
    names = {"version": [], "new": [ctypes.c_size_t, ctypes.c_size_t, POINTER], "query": [POINTER, POINTER],
             "counts": [POINTER], "points": [POINTER]}
    results = {"version": ctypes.c_char_p, "query": ctypes.c_int64, "counts": ctypes.POINTER(U64),
               "points": ctypes.POINTER(DOUBLE)}
    calls = {}
    for name, taken in names.items():
        calls[name] = getattr(library, "trace_cgal_" + name)
        calls[name].argtypes, calls[name].restype = taken, results.get(name, POINTER)
    mesh = calls["new"](scene.vertices, scene.triangles, scene.corners.buffer_info()[0])
    if not mesh:
        raise peers.Skipped("the mesh is not an oriented 2-manifold")

    def query(vertices):
        count = calls["query"](mesh, vertices.ctypes.data)
        if count < 0:
            raise peers.Unusable(f"{scene.name}: CGAL raised an exception")
        return count

    def curves(count, vertices):
        if not count:
            return Curves([], [])
        counts = np.ctypeslib.as_array(calls["counts"](mesh), (count,)).astype(int)
        points = np.ctypeslib.as_array(calls["points"](mesh), (int(counts.sum()), 3))
        return by_directions(np.split(points, np.cumsum(counts)[:-1]), vertices)

    return calls["version"]().decode(), [
        Way("surface_self_intersection: exact constructions; polylines", query, curves)]


def meshlib(scene, _):
    mesh, place = peers.meshlib_mesh(scene, np)
    from meshlib import mrmeshpy

    part = mrmeshpy.MeshPart(mesh)

    def pairs(vertices):
        place(vertices)
        return mrmeshpy.findSelfCollidingEdgeTrisPrecise(part, mrmeshpy.getVectorConverters(part).toInt)

    def contours(vertices):
        return mrmeshpy.orderSelfIntersectionContours(mesh.topology, pairs(vertices))

    def curves(found, _):
        lines = [found[i] for i in range(0, found.size(), 2)]  # each is there twice, the other way round
        return Curves([0] * len(lines), [line[0] == line[line.size() - 1] for line in lines])

    return importlib.metadata.version("meshlib"), [
        Way("findSelfCollidingEdgeTrisPrecise: boxes refitted; pairs", pairs),
        Way("the same and orderSelfIntersectionContours: contours", contours, curves)]


# Function, coordinates, and whether its answers are exact.
PEERS = {"libigl": (libigl, "d", True), "cgal": (cgal, "d", True), "meshlib": (meshlib, "f", False)}


# ---------------------------------------------------------------------------------------------------
# Turns


def timed(ask, given):
    start = time.perf_counter()
    found = ask(given)
    return time.perf_counter() - start, found


def measure(scene, arguments, out):
    """All on a scene. Returns whether curves are the same where they have to be."""
    make, scalar, exact = PEERS[arguments.peer]
    version, ways = make(scene, arguments)
    ours = Trace(arguments.lib, scene, scalar)
    right = True
    for frame in [f for f in arguments.frames or range(scene.frames) if f < scene.frames]:
        positions = scene.frame(frame, scalar)
        vertices = np.array(positions).reshape(-1, 3)
        touching = ours.touches(positions)
        contenders = [("pairs", ours.pairs, positions), ("sc_trace", ours.contours_of, positions)]
        contenders += [(way.what, way.query, vertices) for way in ways]
        times, answers = [[] for _ in contenders], {}
        for turn in range(arguments.repeats + 1):
            for (what, ask, given), taken in zip(contenders, times):
                if turn > 0 and taken[0] > SLOW:
                    continue
                found = None  # what is long takes its time to free
                elapsed, found = timed(ask, given)
                taken.append(elapsed)
                way = next((way for way in ways if way.what == what), None)
                if turn == 0 and way and way.curves:
                    answers[what] = way.curves(found, vertices)
        mine = ours.curves()
        for (what, _, _), taken in zip(contenders, times):
            shown, own, verdict, off = None, what in ("pairs", "sc_trace"), "", ""
            if what == "sc_trace":
                shown = mine
            elif what in answers:
                shown, verdict = answers[what], "degenerate"
                if shown and exact:
                    off = f"{mine.off(shown):.2g}"
                if not touching:
                    same = shown and ((len(mine.closed), len(mine.open)) == (len(shown.closed), len(shown.open))
                                      if not exact else ours.judge(positions, shown))
                    verdict = "match" if same else "differ"
                    right &= bool(same) or not exact
                if verdict == "differ":
                    print(f"different curves: {arguments.peer} on {scene.name}, frame {frame}", flush=True)
            milliseconds = [1000 * t for t in taken[1:] or taken]
            counts = [len(shown.closed), len(shown.open)] if shown else ["", ""]
            counts.append(f"{shown.total:.17g}" if shown and (own or exact) else "")
            print(scene.name, scene.triangles, frame, peers.NOTHING_ELSE if own else arguments.peer,
                  ours.ours.version if own else version, what, f"{statistics.median(milliseconds):.4f}",
                  f"{min(milliseconds):.4f}", ours.ours.count, *counts, off, verdict, arguments.peer,
                  sep=",", file=out, flush=True)
        if arguments.csv:
            print(f"{scene.name:<14} frame {frame}: {len(mine.closed)} closed, {len(mine.open)} open, "
                  + "degenerate; " * touching
                  + "; ".join(f"{what.split(':')[0]} {1000 * statistics.median(taken[1:] or taken):.3f} ms"
                              for (what, _, _), taken in zip(contenders, times)), flush=True)
    return right


def parse():
    parser = argparse.ArgumentParser(description="Times others that trace curves beside sc_trace.")
    parser.add_argument("--peer", choices=sorted(PEERS), required=True)
    parser.add_argument("--lib", required=True, help="starcontour's shared library")
    parser.add_argument("--cgal", help="the shared library made of trace_cgal.cpp, for --peer cgal")
    parser.add_argument("--frames", help="their numbers, such as 0,5 [all]")
    parser.add_argument("--repeats", type=int, default=3, help="turns that are timed; 0: the first, which compares, is [3]")
    parser.add_argument("--csv", help="file to add lines to [standard output]")
    parser.add_argument("scenes", nargs="+", metavar="SCENE", help="folder of a scene")
    arguments = parser.parse_args()
    try:
        arguments.frames = [int(f) for f in arguments.frames.split(",")] if arguments.frames else None
    except ValueError:
        parser.error("--frames: numbers, with commas between")
    if arguments.repeats < 0:
        parser.error("repeats are 0 or more")
    return arguments


def main():
    arguments = parse()

    def measure_all(out):
        status = 0
        for folder in arguments.scenes:
            scene = peers.Scene(folder)
            try:
                if not measure(scene, arguments, out):
                    status = 1
            except (peers.Skipped, ImportError) as reason:
                print(f"skipped: {arguments.peer} on {scene.name}: {reason}", flush=True)
                print(f"# skipped: {arguments.peer} on {scene.name}: {reason}", file=out, flush=True)
                status = status or 3
        return status

    return peers.run_measured(arguments.csv, COLUMNS, 1, measure_all)


if __name__ == "__main__":
    sys.exit(main())

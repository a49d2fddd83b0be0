#!/usr/bin/env python3
"""Times ipc-toolkit beside starcontour on what is within a distance in a pose, and compares answers.

    bench/peers/near.py --lib LIBRARY [--distances D,...] [--frames F,...] [--repeats N] [--csv FILE] SCENE...

A SCENE is a folder as sc-bench --export writes it. Distances are in median edges of its first frame, as
in sc-bench --pairs near. In one process, on one processor, all ways have their turn in each frame:

  near               sc_query_near: sorted pairs of a vertex and a face, and of two edges
  near counted       the same, no lists
  near by boxes      the same lists by the plain tree of boxes
  near; merged       the lists, sc_near_stencils of all pairs and sc_near_merge: what a barrier method needs
  Candidates         ipc-toolkit, LBVH of boxes inflated by half the distance: no distances yet
  NormalCollisions   ipc-toolkit, the same, distances and merging

Answers are compared in a walk that is not timed, but for distances within 1e-9 of the one asked for, as
others round:

  Candidates         missing: pairs of ours that are no candidates. extra: candidates that are nearer by a
                     distance computed here (numpy), and not among ours
  NormalCollisions   features (two vertices, a vertex and an edge, ...) after merging, missing and extra.
                     ipc-toolkit keeps nearly parallel edges as such whichever feature is closest: those
                     count as the feature that starcontour names for the pair

Several features of a pair may be as close; rounding then decides for ipc-toolkit which one it names, so
that features may differ on regular grids. Only candidates decide the exit status: 0, or 1 if pairs are
missing or extra there; 2 if a scene cannot be read. Without ipc-toolkit only ours are timed.

SPDX-License-Identifier: MIT
"""

import argparse
import ctypes
import importlib.metadata
import statistics
import sys
import time

import numpy as np

import peers

COLUMNS = "scene,triangles,frame,edges,peer,version,what,ms,ms_min,pairs,missing,extra"
DISTANCES = "0.05,0.2,0.5,1,2"

# Distances this near to the one asked for are ties, relative to it.
TIE = 1e-9

# More than so many candidates are not compared, as they are Python objects.
COMPARED = 3000000

U32, U64, POINTER, DOUBLE = ctypes.c_uint32, ctypes.c_uint64, ctypes.c_void_p, ctypes.c_double
sc_near_options = peers.structure(
    "sc_near_options",
    *[(name, U32) for name in ("struct_size", "output", "kinds", "method", "simd", "reserved")],
    ("distance", DOUBLE), ("vertex_face_filter", POINTER), ("edge_edge_filter", POINTER),
    ("rest", POINTER), ("rest_distance", DOUBLE), ("tasks", POINTER), ("cancel", POINTER),
    ("budget", U64))
sc_near_result = peers.structure(
    "sc_near_result",
    *[(name, U32) for name in ("struct_size", "found", "verdict", "reserved")],
    ("vertex_face_count", U64), ("vertex_face_capacity", U64), ("vertex_faces", POINTER),
    ("edge_edge_count", U64), ("edge_edge_capacity", U64), ("edge_edges", POINTER),
    ("stats", POINTER))
STENCIL = np.dtype([("feature", "u4"), ("flags", "u4"), ("vertices", "u4", 4), ("weights", "f8", 4),
                    ("vector", "f8", 3), ("distance", "f8")])
SC_WORKSPACE_NEAR, SC_OUTPUT_PAIRS, SC_OUTPUT_COUNT = 2, 0, 1
SC_NEAR_VERTEX_FACE, SC_NEAR_EDGE_EDGE = 1, 2
SC_NEAR_METHOD_SCTT, SC_NEAR_METHOD_BOXES = 1, 2
VERTEX_VERTEX, VERTEX_EDGE, EDGE_EDGE, VERTEX_FACE = 1, 2, 3, 4


class Near:
    """starcontour on a scene: what is within a distance."""

    def __init__(self, library, scene):
        self.ours = peers.Starcontour(library, scene, "d")
        self.library, self.scene = self.ours.library, scene
        self.library.sc_query_near.argtypes = [POINTER] * 5
        self.library.sc_near_stencils.argtypes = [POINTER, POINTER, U32, POINTER, U64, POINTER]
        self.library.sc_near_merge.argtypes = [POINTER, U64, POINTER, POINTER]
        self.version = self.ours.version
        workspace = POINTER()
        how = peers.sc_workspace_options(struct_size=ctypes.sizeof(peers.sc_workspace_options),
                                         flags=SC_WORKSPACE_NEAR)
        self.ours.must(self.library.sc_workspace_create_for(self.ours.model, ctypes.byref(how),
                                                            ctypes.byref(workspace)))
        self.ours.workspaces["near"] = self.workspace = workspace
        self.lists = [np.empty((1024, 2), np.uint32) for _ in range(2)]
        self.room = np.empty(0, STENCIL)
        self.multiplicities = np.empty(0, np.uint32)

    def pose(self, positions):
        return peers.sc_pose(struct_size=ctypes.sizeof(peers.sc_pose),
                             vertex_count=self.scene.vertices, position_type=1,
                             positions=positions.ctypes.data)

    def query(self, positions, distance, method=SC_NEAR_METHOD_SCTT, output=SC_OUTPUT_PAIRS):
        """The numbers of vertex-face and edge-edge pairs, which are in the lists then."""
        pose = self.pose(positions)
        options = sc_near_options(struct_size=ctypes.sizeof(sc_near_options), output=output,
                                  method=method, distance=distance)
        while True:
            faces, edges = self.lists
            result = sc_near_result(struct_size=ctypes.sizeof(sc_near_result),
                                    vertex_face_capacity=len(faces), vertex_faces=faces.ctypes.data,
                                    edge_edge_capacity=len(edges), edge_edges=edges.ctypes.data)
            status = self.library.sc_query_near(self.ours.model, self.workspace, ctypes.byref(pose),
                                                ctypes.byref(options), ctypes.byref(result))
            counts = result.vertex_face_count, result.edge_edge_count
            if status != peers.SC_ERROR_SHORT_BUFFER:
                self.ours.must(status)
                return counts
            self.lists = [np.empty((max(count + count // 4, len(old)), 2), np.uint32)
                          for count, old in zip(counts, self.lists)]

    def stencils(self, positions, kind, pairs):
        """Those of these pairs, an array."""
        found = np.empty(len(pairs), STENCIL)
        self.into(positions, kind, pairs, found)
        return found

    def into(self, positions, kind, pairs, found):
        pose = self.pose(positions)
        self.ours.must(self.library.sc_near_stencils(
            self.ours.model, ctypes.byref(pose), kind, pairs.ctypes.data, len(pairs),
            found.ctypes.data))

    def merged(self, positions, distance):
        """The stencils of all pairs, after merging: a view of what the next call overwrites."""
        faces, edges = self.query(positions, distance)
        if len(self.room) < faces + edges:
            self.room = np.empty((faces + edges) * 5 // 4, STENCIL)
            self.multiplicities = np.empty(len(self.room), np.uint32)
        both = self.room[: faces + edges]
        self.into(positions, SC_NEAR_VERTEX_FACE, self.lists[0][:faces], both[:faces])
        self.into(positions, SC_NEAR_EDGE_EDGE, self.lists[1][:edges], both[faces:])
        count = U64()
        self.ours.must(self.library.sc_near_merge(both.ctypes.data, len(both), ctypes.byref(count),
                                                  self.multiplicities.ctypes.data))
        return both[: count.value]


# ---------------------------------------------------------------------------------------------------
# Distances, in doubles, of many pairs at once: arrays of points, n x 3


def dot(a, b):
    return np.einsum("ij,ij->i", a, b)


def to_segment(p, a, b):
    """Squared distance of a point from a segment."""
    along = b - a
    size = dot(along, along)
    t = np.clip(dot(p - a, along) / np.where(size > 0, size, 1), 0, 1)
    rest = p - a - t[:, None] * along
    return dot(rest, rest)


def point_triangle(p, a, b, c):
    least = np.minimum(np.minimum(to_segment(p, a, b), to_segment(p, b, c)), to_segment(p, c, a))
    normal = np.cross(b - a, c - a)
    size = dot(normal, normal)
    inside = size > 0
    for q, r in ((a, b), (b, c), (c, a)):
        inside &= dot(np.cross(r - q, p - q), normal) >= 0
    above = dot(p - a, normal) ** 2 / np.where(size > 0, size, 1)
    return np.sqrt(np.where(inside, np.minimum(above, least), least))


def edge_edge(a, b, c, d):
    least = np.minimum(np.minimum(to_segment(a, c, d), to_segment(b, c, d)),
                       np.minimum(to_segment(c, a, b), to_segment(d, a, b)))
    u, v, w = b - a, d - c, c - a
    normal = np.cross(u, v)
    size = dot(normal, normal)
    safe = np.where(size > 0, size, 1)
    s = dot(np.cross(w, v), normal) / safe
    t = dot(np.cross(w, u), normal) / safe
    inside = (size > 0) & (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
    between = dot(w, normal) ** 2 / safe
    return np.sqrt(np.where(inside, np.minimum(between, least), least))


# ---------------------------------------------------------------------------------------------------
# Comparing


class Peer:
    """ipc-toolkit on a scene."""

    def __init__(self, scene):
        import ipctk

        self.ipctk = ipctk
        self.version = importlib.metadata.version("ipctk")
        self.faces = np.array(scene.corners, dtype=np.int32).reshape(-1, 3)
        self.rest = np.asfortranarray(np.array(scene.frame(0, "d")).reshape(-1, 3))
        self.edges = np.sort(ipctk.edges(self.faces), axis=1).astype(np.int64)
        self.mesh = ipctk.CollisionMesh(self.rest, ipctk.edges(self.faces), self.faces)
        keys = self.edges[:, 0] << 32 | self.edges[:, 1]
        order = np.argsort(keys)
        ends = self.faces.astype(np.int64)
        sides = np.stack([ends, np.roll(ends, -1, axis=1)], axis=2).reshape(-1, 2)
        sides.sort(axis=1)
        self.edge_of_corner = order[np.searchsorted(keys[order], sides[:, 0] << 32 | sides[:, 1])]
        self.keys, self.order = keys[order], order

    def candidates(self, vertices, distance):
        found = self.ipctk.Candidates()
        found.build(self.mesh, vertices, distance / 2, self.ipctk.LBVH())
        return found

    def collisions(self, vertices, distance):
        found = self.ipctk.NormalCollisions()
        found.build(self.mesh, vertices, distance, 0, self.ipctk.LBVH())
        return found

    def edge_of(self, a, b):
        """The numbers of edges with these ends, arrays."""
        low, high = np.minimum(a, b).astype(np.int64), np.maximum(a, b).astype(np.int64)
        return self.order[np.searchsorted(self.keys, low << 32 | high)]


def packed(a, b):
    """One number for each pair of numbers."""
    return np.asarray(a, np.int64) << 32 | np.asarray(b, np.int64)


def packed_edges(a, b):
    return packed(np.minimum(a, b), np.maximum(a, b))


def judge_candidates(near, peer, positions, distance, found):
    """Missing and extra pairs of ipc-toolkit's candidates, see above; None if there are too many."""
    faces, edges = near.query(positions, distance)
    points = positions.reshape(-1, 3)
    missing = extra = 0
    low, high = distance * (1 - TIE), distance * (1 + TIE)
    if len(found.fv_candidates) + len(found.ee_candidates) > COMPARED:
        return None
    theirs = np.array([(c.vertex_id, c.face_id) for c in found.fv_candidates],
                      np.int64).reshape(-1, 2)
    ours = near.lists[0][:faces].astype(np.int64)
    mine, others = packed(ours[:, 0], ours[:, 1]), packed(theirs[:, 0], theirs[:, 1])

    def face_distance(pairs):
        corners = peer.faces[pairs & 0xFFFFFFFF]
        return point_triangle(points[pairs >> 32], *(points[corners[:, k]] for k in range(3)))

    lost, unknown = np.setdiff1d(mine, others), np.setdiff1d(others, mine)
    missing += int((face_distance(lost) < low).sum())
    extra += int((face_distance(unknown) < low).sum()) + int((face_distance(mine) > high).sum())
    theirs = np.array([(c.edge0_id, c.edge1_id) for c in found.ee_candidates],
                      np.int64).reshape(-1, 2)
    ours = peer.edge_of_corner[near.lists[1][:edges]]
    mine, others = packed_edges(ours[:, 0], ours[:, 1]), packed_edges(theirs[:, 0], theirs[:, 1])

    def edge_distance(pairs):
        a, b = peer.edges[pairs >> 32], peer.edges[pairs & 0xFFFFFFFF]
        return edge_edge(points[a[:, 0]], points[a[:, 1]], points[b[:, 0]], points[b[:, 1]])

    lost, unknown = np.setdiff1d(mine, others), np.setdiff1d(others, mine)
    missing += int((edge_distance(lost) < low).sum())
    extra += int((edge_distance(unknown) < low).sum()) + int((edge_distance(mine) > high).sum())
    return missing, extra


def features(peer, stencils):
    """Sets of features of stencils: a list by kind of arrays of numbers."""
    found = [np.empty(0, np.int64)] * 5
    v, used = stencils["vertices"].astype(np.int64), stencils["weights"] != 0
    for feature in (VERTEX_VERTEX, VERTEX_EDGE, EDGE_EDGE, VERTEX_FACE):
        here = stencils["feature"] == feature
        of, active = v[here], used[here]
        if not len(of):
            continue
        if feature == VERTEX_FACE:
            faces = np.sort(peer.faces, axis=1).astype(np.int64)
            corners = np.sort(of[:, 1:], axis=1)
            order = np.lexsort(faces.T[::-1])
            where = {tuple(face): i for i, face in zip(order, faces[order])}
            found[feature] = packed(of[:, 0], [where[tuple(face)] for face in corners])
        elif feature == EDGE_EDGE:
            a, b = peer.edge_of(of[:, 0], of[:, 1]), peer.edge_of(of[:, 2], of[:, 3])
            found[feature] = packed_edges(a, b)
        elif feature == VERTEX_VERTEX:
            two = of[active].reshape(-1, 2)
            found[feature] = packed_edges(two[:, 0], two[:, 1])
        else:  # of the side with one vertex, that one; of the other the edge
            weights = stencils["weights"][here]
            alone = np.where(((weights < 0).sum(axis=1) == 1)[:, None], weights < 0, weights > 0)
            pair = of[active & ~alone].reshape(-1, 2)
            found[feature] = packed(peer.edge_of(pair[:, 0], pair[:, 1]), of[alone])
    return found


def judge_collisions(near, peer, positions, distance, found):
    """Missing and extra features of ipc-toolkit's collisions, see above; None if there are too many."""
    lists = found.vv_collisions, found.ev_collisions, found.ee_collisions, found.fv_collisions
    if sum(map(len, lists)) > COMPARED:
        return None
    merged = near.merged(positions, distance)
    merged = merged[merged["distance"] < distance * (1 - TIE)]
    ours = features(peer, merged)
    points = positions.reshape(-1, 3)
    theirs = [np.empty(0, np.int64)] * 5
    if lists[0]:
        of = np.array([(c.vertex0_id, c.vertex1_id) for c in lists[0]])
        theirs[VERTEX_VERTEX] = packed_edges(of[:, 0], of[:, 1])
    if lists[1]:
        of = np.array([(c.edge_id, c.vertex_id) for c in lists[1]])
        theirs[VERTEX_EDGE] = packed(of[:, 0], of[:, 1])
    if lists[3]:
        of = np.array([(c.vertex_id, c.face_id) for c in lists[3]])
        theirs[VERTEX_FACE] = packed(of[:, 0], of[:, 1])
    if lists[2]:
        of = np.array([(c.edge0_id, c.edge1_id) for c in lists[2]])
        a, b = peer.edges[of[:, 0]], peer.edges[of[:, 1]]
        across = np.cross(points[a[:, 1]] - points[a[:, 0]], points[b[:, 1]] - points[b[:, 0]])
        softened = dot(across, across) < np.array([c.eps_x for c in lists[2]])
        theirs[EDGE_EDGE] = packed_edges(of[~softened, 0], of[~softened, 1])
        corner = np.empty(len(peer.edges), np.uint32)
        corner[peer.edge_of_corner] = np.arange(len(peer.edge_of_corner), dtype=np.uint32)
        pairs = np.ascontiguousarray(np.sort(corner[of[softened]], axis=1))
        named = features(peer, near.stencils(positions, SC_NEAR_EDGE_EDGE, pairs))
        theirs = [np.concatenate([x, y]) for x, y in zip(theirs, named)]
    missing = sum(len(np.setdiff1d(mine, other)) for mine, other in zip(ours, theirs))
    with_ties = features(peer, near.merged(positions, distance * (1 + TIE)))
    extra = sum(len(np.setdiff1d(other, mine)) for mine, other in zip(with_ties, theirs))
    return missing, extra


# ---------------------------------------------------------------------------------------------------
# Turns


def median_edge(scene):
    """As near_method.h has it."""
    corners = np.array(scene.corners, dtype=np.int64).reshape(-1, 3)
    sides = np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    sides = np.unique(sides, axis=0)
    points = np.array(scene.frame(0, "d")).reshape(-1, 3)
    across = points[sides[:, 0]] - points[sides[:, 1]]
    lengths = np.sort(np.sqrt((across ** 2).sum(axis=1)))
    return float(lengths[(len(lengths) - 1) // 2])


def measure(scene, arguments, out):
    """All ways on a scene. Returns whether candidates hold what they should, and nothing is lost."""
    near, right = Near(arguments.lib, scene), True
    try:
        peer = None if arguments.alone else Peer(scene)
    except ImportError as error:
        print(f"skipped: ipctk on {scene.name}: {error}", flush=True)
        peer = None
    edge = median_edge(scene)
    frames = [f for f in arguments.frames or range(scene.frames) if f < scene.frames]
    ways = [("near", lambda p, _, d: sum(near.query(p, d))),
            ("near counted", lambda p, _, d: sum(near.query(p, d, output=SC_OUTPUT_COUNT))),
            ("near by boxes", lambda p, _, d: sum(near.query(p, d, SC_NEAR_METHOD_BOXES))),
            ("near; merged", lambda p, _, d: len(near.merged(p, d)))]
    judges = {}
    if peer:
        ways += [("Candidates", lambda _, v, d: peer.candidates(v, d)),
                 ("NormalCollisions", lambda _, v, d: peer.collisions(v, d))]
        judges = {"Candidates": judge_candidates, "NormalCollisions": judge_collisions}
    for frame in frames:
        positions = np.array(scene.frame(frame, "d"))
        vertices = np.asfortranarray(positions.reshape(-1, 3))
        for edges in arguments.distances:
            distance = edges * edge
            counts, verdicts, times = {}, {}, {what: [] for what, _ in ways}
            for turn in range(arguments.repeats + 1):
                for what, ask in ways:
                    found = None  # long lists take their time to free
                    start = time.perf_counter()
                    found = ask(positions, vertices, distance)
                    elapsed = time.perf_counter() - start
                    if turn > 0:
                        times[what].append(1000 * elapsed)
                        continue
                    counts[what] = found if isinstance(found, int) else len(found)
                    if what in judges:
                        verdicts[what] = judges[what](near, peer, positions, distance, found)
            if not counts["near"] == counts["near counted"] == counts["near by boxes"]:
                raise peers.Unusable(f"{scene.name}: ours disagree: this is a bug, please report it")
            for what, _ in ways:
                verdict = verdicts.get(what, (0, 0))
                right &= what != "Candidates" or verdict is None or verdict == (0, 0)
                name, version = (("ipctk", peer.version) if what in judges else
                                 (peers.NOTHING_ELSE, near.version))
                print(scene.name, scene.triangles, frame, f"{edges:g}", name, version, what,
                      f"{statistics.median(times[what]):.4f}", f"{min(times[what]):.4f}",
                      counts[what], *(verdict or ("", "")), sep=",", file=out, flush=True)
    return right


def parse():
    parser = argparse.ArgumentParser(description="Times ipc-toolkit beside starcontour on what is near.")
    parser.add_argument("--lib", required=True, help="starcontour's shared library")
    parser.add_argument("--distances", default=DISTANCES, help=f"in median edges [{DISTANCES}]")
    parser.add_argument("--frames", help="their numbers, such as 0,5 [all]")
    parser.add_argument("--repeats", type=int, default=3, help="turns that are timed [3]")
    parser.add_argument("--alone", action="store_true", help="ours alone")
    parser.add_argument("--csv", help="file to add lines to [standard output]")
    parser.add_argument("scenes", nargs="+", metavar="SCENE", help="folder of a scene")
    arguments = parser.parse_args()
    try:
        arguments.distances = [float(d) for d in arguments.distances.split(",")]
        arguments.frames = [int(f) for f in arguments.frames.split(",")] if arguments.frames else None
    except ValueError:
        parser.error("--distances and --frames: numbers, with commas between")
    if not all(0 < d < 1e6 for d in arguments.distances) or arguments.repeats < 1:
        parser.error("distances are above 0, repeats 1 or more")
    return arguments


def main():
    arguments = parse()

    def measure_all(out):
        right = [measure(peers.Scene(folder), arguments, out) for folder in arguments.scenes]
        return 0 if all(right) else 1

    return peers.run_measured(arguments.csv, COLUMNS, 1, measure_all)


if __name__ == "__main__":
    sys.exit(main())

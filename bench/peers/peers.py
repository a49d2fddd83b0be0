#!/usr/bin/env python3
"""Times peers from PyPI beside starcontour, in one process each, and compares their pairs.

    peers.py [--peer NAME] [--threads 1|all|N] [--repeats N] [--frames N] [--csv FILE] [--lib FILE]
             [--step PART [--from FRAME,...]] SCENE...
    peers.py --list

What a SCENE is, how turns are taken and what is written is the same as in driver.cpp. Positions are
brought into the form that a peer asks for (floats, another order in memory) before the clock starts.
starcontour is asked through its C interface (ctypes); it gets floats where the peer takes floats.

--step measures steps alone, of small motion: from each FRAME (all but the last, unless named) a PART of
the way to the next, such as 1/50. 1 is the whole way.

Without --peer all are run, each in a process of its own, since they bring different versions of the
same libraries. The peer "starcontour" runs nothing else, and needs no package. A peer that cannot be
had is reported as skipped, with the reason.

Exit status: 0 if pairs match, or differ only where a peer computes with rounded arithmetic; 1 if
others differ or a peer failed; 2 if a scene cannot be read or an option is wrong.

SPDX-License-Identifier: MIT
"""

import argparse
import array
import contextlib
import ctypes
import fractions
import glob
import importlib.metadata
import math
import os
import statistics
import subprocess
import sys
import time

COLUMNS = ("scene,triangles,frame,peer,version,what,threads,ms,pairs,matches,ms_min,missing,extra,"
           "beside,processors")

# What an answer is compared with.
ALL = "all"  # all pairs of triangles
APART = "apart"  # pairs of triangles that share no vertex
ANY_APART = "any apart"  # whether there is one of those
FACES = "faces"  # at least all triangles in pairs of APART, and none that is in no pair
ANY_EDGE = "any edge"  # whether there is a pair of an edge and a triangle that share no vertex
EDGES = "edges"  # at least all pairs of an edge and a triangle that share no vertex
STEPS = "steps"  # at least all that collide in the step to the next frame; candidates are counted
TIME = "time"  # how large a part of the step is free: not more than until the first contact

# The first contact is found with so small a tolerance, of distances, that rounding alone limits it.
# A part of the step may be larger by the slack.
FINEST_TOLERANCE = 1e-300
TIME_SLACK = 1e-6

# Without --step, only meshes of so many triangles are asked for steps, as whole ones take seconds
# on others.
STEP_TRIANGLES = 20000

# Candidates of a step are compared as Python objects, of which more take too much time and memory.
COMPARED_CANDIDATES = 4000000


class Skipped(Exception):
    """A peer or a scene cannot be measured, for the reason given."""


class Unusable(Exception):
    """A scene or an argument is wrong."""


class Scene:
    """An animation of one mesh, read from a folder."""

    def __init__(self, folder):
        self.name = os.path.basename(os.path.normpath(folder))
        try:
            with open(os.path.join(folder, "meta.txt"), encoding="ascii") as file:
                self.triangles, self.vertices, self.frames = map(int, file.read().split())
        except (OSError, ValueError) as error:
            raise Unusable(f"{folder}/meta.txt: {error}") from None
        if min(self.triangles, self.vertices, self.frames) < 1:
            raise Unusable(f"{folder}/meta.txt: not three usable numbers")
        self.corners = self.read(os.path.join(folder, "tris.u32"), "I", 3 * self.triangles)
        if max(self.corners) >= self.vertices:
            raise Unusable(f"{folder}/tris.u32: no such vertex")
        doubles = os.path.join(folder, "frames.f64")
        path, scalar = (doubles, "d") if os.path.exists(doubles) else (doubles[:-2] + "32", "f")
        self.positions = self.read(path, scalar, 3 * self.vertices * self.frames)
        if not all(map(math.isfinite, self.positions)):
            raise Unusable(f"{path}: a position is not finite")
        self.part = None  # of the way to the next frame, a Fraction: steps alone are measured

    @staticmethod
    def read(path, scalar, count):
        numbers = array.array(scalar)
        try:
            with open(path, "rb") as file:
                numbers.frombytes(file.read())
        except (OSError, ValueError) as error:
            raise Unusable(f"{path}: {error}") from None
        if len(numbers) != count:
            raise Unusable(f"{path}: not as long as meta.txt says")
        if sys.byteorder != "little":
            numbers.byteswap()
        return numbers

    def frame(self, number, scalar):
        """Positions of a frame, as an array of floats ("f") or doubles ("d")."""
        size = 3 * self.vertices
        return array.array(scalar, self.positions[size * number : size * (number + 1)])

    def end(self, number, scalar):
        """Positions at the end of the step from a frame; None if it is the last."""
        if number + 1 >= self.frames:
            return None
        end = self.frame(number + 1, scalar)
        if self.part in (None, 1):
            return end
        part = float(self.part)
        return array.array(scalar, (a + part * (b - a)
                                    for a, b in zip(self.frame(number, scalar), end)))

    def step_name(self):
        """What descriptions of steps begin with."""
        return "step" if self.part is None else f"step {self.part}"

    def edge(self, corner):
        """The vertices of an edge that a corner of a triangle names, in ascending order."""
        triangle, k = divmod(corner, 3)
        return tuple(sorted((self.corners[corner], self.corners[3 * triangle + (k + 1) % 3])))

    def adjacent(self, a, b):
        """Whether two triangles have a vertex in common."""
        v = self.corners
        return not {v[3 * a], v[3 * a + 1], v[3 * a + 2]}.isdisjoint(v[3 * b : 3 * b + 3])


# --------------------------------------------------------------------------------------------------
# starcontour, as include/starcontour.h declares it


def structure(name, *fields):
    return type(name, (ctypes.Structure,), {"_fields_": fields})


U32, U64, POINTER = ctypes.c_uint32, ctypes.c_uint64, ctypes.c_void_p
sc_mesh = structure(
    "sc_mesh",
    *[(name, U32) for name in ("struct_size", "vertex_count", "triangle_count", "position_type",
                               "position_stride", "index_type", "index_stride", "reserved")],
    ("positions", POINTER), ("indices", POINTER))
sc_pose = structure(
    "sc_pose",
    *[(name, U32) for name in ("struct_size", "vertex_count", "position_type", "position_stride")],
    ("positions", POINTER))
sc_build_options = structure(
    "sc_build_options",
    *[(name, U32) for name in ("struct_size", "weld", "partition", "tree_count")],
    *[(name, POINTER) for name in ("weld_map", "order", "tree", "bisect", "bisect_user",
                                   "allocator")])
sc_query_options = structure(
    "sc_query_options",
    *[(name, U32) for name in ("struct_size", "output", "pairs", "contact", "method", "contour",
                               "rest_cache", "simd")])
sc_result = structure(
    "sc_result", ("struct_size", U32), ("collides", U32), ("count", U64), ("capacity", U64),
    ("pairs", POINTER), ("stats", POINTER))
sc_workspace_options = structure(
    "sc_workspace_options",
    *[(name, U32) for name in ("struct_size", "flags", "workers", "reserved")],
    ("allocator", POINTER))
sc_step_options = structure(
    "sc_step_options",
    *[(name, U32) for name in ("struct_size", "output", "pairs", "times", "method", "contour", "simd",
                               "reserved")],
    ("separation", ctypes.c_double), ("tolerance", ctypes.c_double), ("tasks", POINTER),
    ("cancel", POINTER), ("budget", U64))
sc_step_result = structure(
    "sc_step_result",
    *[(name, U32) for name in ("struct_size", "collides", "verdict", "reserved")],
    ("vertex_face_count", U64), ("vertex_face_capacity", U64), ("vertex_faces", POINTER),
    ("vertex_face_times", POINTER), ("edge_edge_count", U64), ("edge_edge_capacity", U64),
    ("edge_edges", POINTER), ("edge_edge_times", POINTER), ("earliest", ctypes.c_double),
    ("stats", POINTER))
SC_WORKSPACE_STEP = 1
SC_STEP_COLLISIONS, SC_STEP_CANDIDATES = 0, 1
SC_STEP_TIMES_NONE, SC_STEP_TIMES_EARLIEST, SC_STEP_TIMES_EACH = 0, 1, 2
SC_OUTPUT_ANY = 2
SC_ERROR_SHORT_BUFFER, SC_WELD_NONE, SC_PAIRS_TRIANGLE, SC_PAIRS_EDGE = 11, 2, 0, 1
SC_CONTACT_TOUCHING, SC_CONTACT_PROPER = 0, 1
SC_METHOD_SCTT, SC_METHOD_AABB = 1, 3
SC_CONTOUR_DEFAULT, SC_CONTOUR_STAR, SC_CONTOUR_NONE, SC_CONTOUR_EXACT = 0, 1, 2, 3

# Method and contour test of our ways, asked for by name so that they stay what they are called.
OWN_WAYS = {"exact": (SC_METHOD_SCTT, SC_CONTOUR_EXACT),  # the default
            "star": (SC_METHOD_SCTT, SC_CONTOUR_STAR),
            "aabb": (SC_METHOD_AABB, SC_CONTOUR_DEFAULT)}


class Starcontour:
    """A model of a scene, with a workspace of its own for each way."""

    def __init__(self, path, scene, scalar):
        try:
            self.library = ctypes.CDLL(path)
        except OSError as error:
            raise Unusable(f"{path}: {error}") from None
        self.library.sc_status_string.restype = ctypes.c_char_p
        self.library.sc_version_string.restype = ctypes.c_char_p
        self.library.sc_workspace_free.argtypes = self.library.sc_model_free.argtypes = [POINTER]
        self.library.sc_workspace_create.argtypes = [POINTER, POINTER, POINTER]
        self.library.sc_query.argtypes = [POINTER] * 5
        self.library.sc_workspace_create_for.argtypes = [POINTER] * 3
        self.library.sc_query_step.argtypes = [POINTER] * 6
        self.version = self.library.sc_version_string().decode()
        self.scene, self.type = scene, {"f": 0, "d": 1}[scalar]
        rest = scene.frame(0, scalar)
        mesh = sc_mesh(struct_size=ctypes.sizeof(sc_mesh), vertex_count=scene.vertices,
                       triangle_count=scene.triangles, position_type=self.type,
                       positions=rest.buffer_info()[0], indices=scene.corners.buffer_info()[0])
        options = sc_build_options(struct_size=ctypes.sizeof(sc_build_options), weld=SC_WELD_NONE)
        self.model, self.workspaces = POINTER(), {}
        self.must(self.library.sc_build(ctypes.byref(mesh), ctypes.byref(options),
                                        ctypes.byref(self.model)))
        self.pairs = array.array("I", bytes(8 * 1024))
        self.lists = [array.array("I", bytes(8 * 1024)) for _ in range(2)]
        self.count = 0

    def __del__(self):
        for workspace in getattr(self, "workspaces", {}).values():
            self.library.sc_workspace_free(workspace)
        if getattr(self, "model", None):
            self.library.sc_model_free(self.model)

    def must(self, status):
        if status != 0:
            raise Unusable("starcontour: " + self.library.sc_status_string(status).decode())

    def query(self, way, positions, kind=SC_PAIRS_TRIANGLE, contact=SC_CONTACT_TOUCHING):
        """Finds pairs in a pose, an array of the scalar type given at first."""
        if way not in self.workspaces:
            workspace = POINTER()
            self.must(self.library.sc_workspace_create(self.model, None, ctypes.byref(workspace)))
            self.workspaces[way] = workspace
        pose = sc_pose(struct_size=ctypes.sizeof(sc_pose), vertex_count=self.scene.vertices,
                       position_type=self.type, positions=positions.buffer_info()[0])
        method, contour = OWN_WAYS[way]
        options = sc_query_options(struct_size=ctypes.sizeof(sc_query_options), method=method,
                                   contour=contour, pairs=kind, contact=contact)
        while True:
            result = sc_result(struct_size=ctypes.sizeof(sc_result), capacity=len(self.pairs) // 2,
                               pairs=self.pairs.buffer_info()[0])
            status = self.library.sc_query(self.model, self.workspaces[way], ctypes.byref(pose),
                                           ctypes.byref(options), ctypes.byref(result))
            self.count = result.count
            if status != SC_ERROR_SHORT_BUFFER:
                return self.must(status)
            self.pairs = array.array("I", bytes(8 * self.count))

    def pose(self, positions):
        return sc_pose(struct_size=ctypes.sizeof(sc_pose), vertex_count=self.scene.vertices,
                       position_type=self.type, positions=positions.buffer_info()[0])

    def step_workspace(self):
        """A workspace for steps, made when it is first asked for."""
        if "step" not in self.workspaces:
            workspace = POINTER()
            how = sc_workspace_options(struct_size=ctypes.sizeof(sc_workspace_options),
                                       flags=SC_WORKSPACE_STEP)
            self.must(self.library.sc_workspace_create_for(self.model, ctypes.byref(how),
                                                           ctypes.byref(workspace)))
            self.workspaces["step"] = workspace
        return self.workspaces["step"]

    def free_part(self, start, end, **options):
        """The largest part of a step between two poses that is known to be free, from 0 to 1."""
        poses = [self.pose(start), self.pose(end)]
        how = sc_step_options(struct_size=ctypes.sizeof(sc_step_options), output=SC_OUTPUT_ANY,
                              pairs=SC_STEP_COLLISIONS, times=SC_STEP_TIMES_EARLIEST, **options)
        result = sc_step_result(struct_size=ctypes.sizeof(sc_step_result))
        self.must(self.library.sc_query_step(self.model, self.step_workspace(),
                                             ctypes.byref(poses[0]), ctypes.byref(poses[1]),
                                             ctypes.byref(how), ctypes.byref(result)))
        return result.earliest

    def step(self, start, end, pairs=SC_STEP_CANDIDATES, **options):
        """Asks about a step between two poses: how many candidates there are, or, for collisions, these:
        vertex-face and edge-edge pairs, a list each of (a, b, time), and the earliest time."""
        poses = [self.pose(start), self.pose(end)]
        timed = pairs == SC_STEP_COLLISIONS
        how = sc_step_options(struct_size=ctypes.sizeof(sc_step_options), pairs=pairs,
                              times=SC_STEP_TIMES_EACH if timed else SC_STEP_TIMES_NONE, **options)
        while True:
            room = [len(numbers) // 2 for numbers in self.lists]
            times = [(ctypes.c_double * (count if timed else 1))() for count in room]
            result = sc_step_result(
                struct_size=ctypes.sizeof(sc_step_result),
                vertex_face_capacity=room[0], vertex_faces=self.lists[0].buffer_info()[0],
                vertex_face_times=ctypes.addressof(times[0]) if timed else None,
                edge_edge_capacity=room[1], edge_edges=self.lists[1].buffer_info()[0],
                edge_edge_times=ctypes.addressof(times[1]) if timed else None)
            status = self.library.sc_query_step(self.model, self.step_workspace(),
                                                ctypes.byref(poses[0]), ctypes.byref(poses[1]),
                                                ctypes.byref(how), ctypes.byref(result))
            found = [result.vertex_face_count, result.edge_edge_count]
            if status != SC_ERROR_SHORT_BUFFER:
                break
            self.lists = [array.array("I", bytes(8 * max(pair))) for pair in zip(room, found)]
        self.must(status)
        if not timed:
            return sum(found)
        faces, edges = (list(zip(numbers[0 : 2 * count : 2], numbers[1 : 2 * count : 2], when))
                        for numbers, count, when in zip(self.lists, found, times))
        return faces, edges, result.earliest

    def list(self):
        """The latest pairs."""
        return list(zip(self.pairs[0 : 2 * self.count : 2], self.pairs[1 : 2 * self.count : 2]))


class Expected:
    """What starcontour says of a pose, in each of the forms that answers are compared with."""

    def __init__(self, ours, positions, end):
        self.ours, self.positions, self.end, self.scene = ours, positions, end, ours.scene
        ours.query("exact", positions)
        self.all = ours.list()

    def apart(self):
        return [pair for pair in self.all if not self.scene.adjacent(*pair)]

    def edges(self):
        """Pairs of an edge, by its two vertices in ascending order, and a triangle."""
        self.ours.query("exact", self.positions, SC_PAIRS_EDGE)
        return {(self.scene.edge(a), b) for a, b in self.ours.list()}

    def steps(self):
        """Collisions on the way to the next frame: of a vertex and a triangle, and of two edges."""
        faces, edges, _ = self.ours.step(self.positions, self.end, SC_STEP_COLLISIONS)
        return ([pair[:2] for pair in faces] +
                [tuple(sorted((self.scene.edge(a), self.scene.edge(b)))) for a, b, _ in edges])

    def judge(self, kind, answer):
        """How many pairs are missing in an answer, in the form that Way says, and how many extra."""
        if kind in (ANY_APART, ANY_EDGE):
            there = bool(self.apart() if kind == ANY_APART else self.edges())
            return int(there > answer), int(there < answer)
        if kind == TIME:
            first = self.ours.free_part(self.positions, self.end, tolerance=FINEST_TOLERANCE)
            if first >= 1:  # nothing meets
                return 0, int(answer < 1)
            return int(answer >= 1 or answer > first + TIME_SLACK), 0
        if kind == FACES:
            wanted, allowed = ({face for pair in pairs for face in pair}
                               for pairs in (self.apart(), self.all))
            return len(wanted - set(answer)), len(set(answer) - allowed)
        if kind == STEPS:  # the answer tells which of ours it has
            return sum(not there for there in answer(self.steps())), 0
        wanted = {ALL: lambda: self.all, APART: self.apart, EDGES: self.edges}[kind]()
        missing = len(set(wanted) - set(answer))
        return missing, 0 if kind == EDGES else len(answer) - len(wanted) + missing


# --------------------------------------------------------------------------------------------------
# Peers: each is a function that takes a scene and numpy, and returns ways to use the peer.


class Way:
    """One way of using a peer, or starcontour.

    what     says what a query does, without commas
    kind     what its answer is compared with
    query    everything there is to do for a new pose, timed: takes what prepare made, and returns
             anything that answer understands. Of STEPS and TIME: for two poses
    answer   not timed: a list of pairs, or whether there is one, as kind says. Of FACES: a list of
             triangles. Of STEPS: how many
             candidates there are, and a function that says of each pair of a list whether it is one,
             or None if there are too many to look. Of TIME: the part of the step that is free
    prepare  not timed: brings an array of positions, vertices x 3, into the peer's form
    exact    whether it claims exactness, so that a wrong answer is an error and not only reported
    """

    def __init__(self, what, kind, query, answer=lambda found: found, prepare=lambda p: p,
                 exact=True):
        self.what, self.kind, self.query = what, kind, query
        self.answer, self.prepare, self.exact = answer, prepare, exact
        self.own = False  # starcontour's
        self.times, self.counts, self.errors = [], [], []


def without_neighbours(scene, pairs):
    """Pairs of triangles that share no vertex, smaller number first."""
    return [(min(pair), max(pair)) for pair in pairs if not scene.adjacent(*pair)]


def ipctk(scene, np):
    """Rebuilds a linear bounding-volume hierarchy of edges and of triangles."""
    import ipctk as ipc

    faces = np.array(scene.corners, dtype=np.int32).reshape(-1, 3)
    rest = np.asfortranarray(np.array(scene.frame(0, "d")).reshape(-1, 3))
    edges = ipc.edges(faces)
    mesh = ipc.CollisionMesh(rest, edges, faces)
    ends = [tuple(sorted(map(int, edge))) for edge in edges]

    def candidates(vertices):
        tree = ipc.LBVH()
        tree.build(vertices, edges, faces)
        return tree.detect_edge_face_candidates()

    def step_candidates(start, end):
        found = ipc.Candidates()
        found.build(mesh, start, end, 0, ipc.LBVH())
        return found

    def holds(found):
        """How many candidates there are, and whether they hold each pair of a list."""
        if len(found) > COMPARED_CANDIDATES:
            return len(found), None
        faces, pairs = found.fv_candidates, found.ee_candidates

        def check(wanted):
            wanted = set(wanted)
            there = {(c.vertex_id, c.face_id) for c in faces} & wanted if wanted else set()
            if wanted:
                there |= {pair for pair in (tuple(sorted((ends[c.edge0_id], ends[c.edge1_id])))
                                            for c in pairs) if pair in wanted}
            return [pair in there for pair in wanted]

        return len(faces) + len(pairs), check

    ways = [] if scene.part else [
        Way("has_intersections: trees rebuilt; robust edge-triangle test; yes or no",
            ANY_EDGE, lambda vertices: ipc.has_intersections(mesh, vertices, ipc.LBVH()),
            prepare=np.asfortranarray),
        Way("LBVH: trees rebuilt; edge-triangle candidates only; as a Python list",
            EDGES, candidates, lambda found: [(ends[c.edge_id], c.face_id) for c in found],
            np.asfortranarray),
    ]
    if scene.part:
        ways.append(
            Way(f"{scene.step_name()}: time of impact: compute_collision_free_stepsize: LBVH rebuilt; "
                "tight inclusion with conservative rescaling 0.8", TIME,
                lambda start, end: ipc.compute_collision_free_stepsize(mesh, start, end, 0, ipc.LBVH()),
                prepare=np.asfortranarray, exact=False))
    if scene.part or scene.triangles <= STEP_TRIANGLES:
        kind = "candidates: " if scene.part else ""
        ways.append(
            Way(f"{scene.step_name()}: {kind}LBVH round the motion: trees rebuilt; vertex-face and "
                "edge-edge candidates", STEPS, step_candidates, holds, np.asfortranarray))
    return ways


def meshlib_mesh(scene, np):
    """A mesh of MeshLib's, and a function that places its vertices and refits its boxes; it takes floats and
    an oriented 2-manifold."""
    from meshlib import mrmeshnumpy, mrmeshpy

    faces = np.array(scene.corners, dtype=np.int32).reshape(-1, 3)
    rest = np.array(scene.frame(0, "f")).reshape(-1, 3)
    mesh = mrmeshnumpy.meshFromFacesVerts(faces, rest)
    if mesh.points.size() != scene.vertices or not np.array_equal(
            mrmeshnumpy.getNumpyFaces(mesh.topology), faces):
        raise Skipped("the mesh is not an oriented 2-manifold")
    every = mrmeshpy.VertBitSet()
    every.resize(scene.vertices, True)
    mesh.getAABBTree()

    def place(vertices):
        ctypes.memmove(mesh.points.vec.data_pointer(), vertices.ctypes.data, vertices.nbytes)
        mesh.updateCaches(every)

    return mesh, place


def meshlib(scene, np):
    """Refits a tree of boxes of triangles; takes floats and an oriented 2-manifold."""
    from meshlib import mrmeshpy

    mesh, place = meshlib_mesh(scene, np)
    part = mrmeshpy.MeshPart(mesh)

    def query(vertices):
        place(vertices)
        return mrmeshpy.findSelfCollidingTriangles(part, touchIsIntersection=True)

    def answer(found):
        if found.size() == 0:
            return []
        numbers = array.array("i", ctypes.string_at(found.data_pointer(), 8 * found.size()))
        return without_neighbours(scene, zip(numbers[0::2], numbers[1::2]))

    return [Way("findSelfCollidingTriangles: boxes refitted; rounded arithmetic; all pairs",
                APART, query, answer, exact=False)]


def libigl(scene, np):
    """Rebuilds a tree of boxes of triangles; exact predicates."""
    from igl import predicates

    faces = np.array(scene.corners, dtype=np.int64).reshape(-1, 3)
    return [Way("find_self_intersections: tree rebuilt; exact predicates; all pairs",
                APART, lambda vertices: predicates.find_self_intersections(vertices, faces),
                lambda found: without_neighbours(scene, found[1].tolist()))]


def open3d(scene, np):
    """Compares all triangles with all others; rounded arithmetic."""
    import open3d as o3d

    mesh = o3d.geometry.TriangleMesh()
    mesh.triangles = o3d.utility.Vector3iVector(
        np.array(scene.corners, dtype=np.int32).reshape(-1, 3))

    def query(vertices):
        mesh.vertices = vertices
        return mesh.get_self_intersecting_triangles()

    return [Way("get_self_intersecting_triangles: every two triangles; rounded arithmetic; all pairs",
                APART, query, lambda found: without_neighbours(scene, np.asarray(found).tolist()),
                o3d.utility.Vector3dVector, exact=False)]


def pymeshlab(scene, np):
    """Makes the mesh and a grid of boxes anew; rounded arithmetic; triangles, not pairs."""
    import pymeshlab as ml

    faces = np.array(scene.corners, dtype=np.int32).reshape(-1, 3)

    def query(vertices):
        meshes = ml.MeshSet()
        meshes.add_mesh(ml.Mesh(vertices, faces))
        meshes.compute_selection_by_self_intersections_per_face()
        return meshes.current_mesh().face_selection_array()

    def answer(found):
        if len(found) != scene.triangles:
            raise Unusable(f"{scene.name}: PyMeshLab has other triangles than the scene")
        return np.flatnonzero(found).tolist()

    return [Way("compute_selection_by_self_intersections_per_face: mesh and grid rebuilt; "
                "rounded arithmetic; triangles", FACES, query, answer, exact=False)]


def python_fcl(scene, np):
    """Rebuilds a tree of boxes of triangles; rounded arithmetic; what trimesh asks."""
    import fcl

    faces = np.array(scene.corners, dtype=np.int32).reshape(-1, 3)

    def query(vertices):
        model = fcl.BVHModel()
        model.beginModel(len(vertices), len(faces))
        model.addSubModel(vertices, faces)
        model.endModel()
        one, other = (fcl.CollisionObject(model, fcl.Transform()) for _ in range(2))
        result = fcl.CollisionResult()
        # There is no pair that would not fit.
        fcl.collide(one, other, fcl.CollisionRequest(num_max_contacts=2 ** 31 - 1), result)
        return result.contacts

    return [Way("collide of the mesh with itself: tree rebuilt; rounded arithmetic; all pairs in both "
                "orders and with neighbours", APART, query,
                lambda found: without_neighbours(
                    scene, {(c.b1, c.b2) for c in found if c.b1 < c.b2}), exact=False)]


def trueform(scene, np):
    """Rebuilds a tree of boxes of triangles."""
    import trueform as tf

    faces = np.array(scene.corners, dtype=np.int32).reshape(-1, 3)
    rest = np.array(scene.frame(0, "d")).reshape(-1, 3)

    def way(what, kind, ask, answer=lambda found: found, exact=True):
        mesh = tf.Mesh(faces, rest)

        def query(vertices):
            mesh.points = vertices
            return ask(mesh)

        return Way(what, kind, query, answer, exact=exact)

    return [
        way("has_self_intersections: tree rebuilt; exact; yes or no", ANY_APART,
            tf.has_self_intersections),
        way("gather_intersecting_ids of the mesh with itself: tree rebuilt; rounded arithmetic; "
            "all pairs in both orders and with neighbours", APART,
            lambda mesh: tf.gather_intersecting_ids(mesh, mesh),
            lambda found: without_neighbours(scene, (p for p in found.tolist() if p[0] < p[1])),
            exact=False),
    ]


# Name, which is also the package on PyPI: function, licence, type of coordinates, whether it can
# use more than one thread.
PEERS = {
    "ipctk": (ipctk, "MIT", "d", True),
    "libigl": (libigl, "MPL-2.0", "d", False),
    "meshlib": (meshlib, "non-commercial, evaluation, education", "f", True),
    "open3d": (open3d, "MIT", "d", True),
    "pymeshlab": (pymeshlab, "GPL-3.0", "d", False),
    "python-fcl": (python_fcl, "BSD-3-Clause", "d", False),
    "trueform": (trueform, "PolyForm Noncommercial 1.0.0", "d", True),
}
NOTHING_ELSE = "starcontour"


def find_ways(peer, scene):
    """Version of a peer and ways of using it."""
    if peer == NOTHING_ELSE:
        return "-", []
    try:
        import numpy as np

        return importlib.metadata.version(peer), PEERS[peer][0](scene, np)
    except (ImportError, AttributeError) as error:
        raise Skipped(" ".join(f"{type(error).__name__}: {error}".split())) from None


# --------------------------------------------------------------------------------------------------
# Turns

UNKNOWN = (None, None)  # pairs missing and extra, where answers are not compared


def own_ways(ours, scene, steps):
    """What starcontour is asked for. steps: these as well."""
    ways = [] if scene.part else [
        Way(what, ALL, lambda positions, w=what: ours.query(w, positions), lambda found: ours.list())
        for what in OWN_WAYS]
    if steps:
        ways.append(Way(f"{scene.step_name()}: candidates", STEPS, ours.step,
                        lambda count: (count, lambda wanted: [True for _ in wanted])))
    if scene.part:
        ways.append(Way(f"{scene.step_name()}: time of impact", TIME, ours.free_part, exact=False))
        ways.append(Way(f"{scene.step_name()}: pairs at the start", ALL,
                        lambda positions: ours.query("exact", positions), lambda found: ours.list()))
    for way in ways:
        way.own = True
    return ways


def walk(scene, scalar, ours, ways, frames, first):
    """Walks through these frames once; compares answers if first, else records times."""
    for k, f in enumerate(frames):
        poses = [scene.frame(f, scalar), scene.end(f, scalar)]
        expected = Expected(ours, *poses) if first else None
        for way in ways:
            if way.kind not in (STEPS, TIME):
                given = poses[:1]
            elif poses[1] is not None:
                given = poses
            else:
                continue
            if not way.own:
                import numpy as np

                given = [way.prepare(np.frombuffer(pose, dtype=scalar).reshape(-1, 3))
                         for pose in given]
            found = None  # long lists take their time to free, which is not the next one's
            start = time.perf_counter()
            found = way.query(*given)
            elapsed = time.perf_counter() - start
            if not first:
                way.times[k].append(1000 * elapsed)
                continue
            answer = way.answer(found)
            if way.kind == STEPS:
                count, check = answer
                way.counts.append(count)
                way.errors.append(expected.judge(STEPS, check) if check else UNKNOWN)
            elif way.kind == TIME:
                way.counts.append(f"{answer:.9g}")
                way.errors.append(expected.judge(TIME, answer))
            else:
                way.counts.append(int(answer) if isinstance(answer, bool) else len(answer))
                way.errors.append(expected.judge(way.kind, answer))


def measure(peer, scene, arguments, out):
    """Measures a peer on a scene. Returns whether all answers that claim exactness were right."""
    scalar = PEERS[peer][2] if peer in PEERS else "d"
    if arguments.threads > 1 and not (peer in PEERS and PEERS[peer][3]):
        print(f"skipped: {peer} on {scene.name}: it uses one thread only", flush=True)
        return True
    try:
        version, ways = find_ways(peer, scene)
    except Skipped as reason:
        print(f"skipped: {peer} on {scene.name}: {reason}", flush=True)
        if arguments.csv:
            print(f"# skipped: {peer} on {scene.name}: {reason}", file=out)
        return True
    ours = Starcontour(arguments.lib, scene, scalar)
    ways += own_ways(ours, scene, scene.part or any(way.kind == STEPS for way in ways))
    frames = list(range(min(scene.frames, arguments.frames or scene.frames)))
    if scene.part:
        frames = arguments.starts or [f for f in frames if f + 1 < scene.frames]
        if not frames or max(frames) + 1 >= scene.frames:
            raise Unusable(f"{scene.name}: of {scene.frames} frames none follows one that was named")
    for way in ways:
        way.times = [[] for _ in frames]
    for repeat in range(arguments.repeats + 1):
        walk(scene, scalar, ours, ways, frames, repeat == 0)

    same = True
    for way in ways:
        name, number = (NOTHING_ELSE, ours.version) if way.own else (peer, version)
        threads = 1 if way.own else arguments.threads
        medians = [statistics.median(times) for times in way.times if times]
        for k, median in enumerate(medians):
            errors = way.errors[k]
            verdict = "unknown" if errors == UNKNOWN else "no" if any(errors) else "yes"
            print(scene.name, scene.triangles, frames[k], name, number, way.what, threads,
                  f"{median:.4f}", way.counts[k], verdict, f"{min(way.times[k]):.4f}",
                  *(count or 0 for count in errors), peer, arguments.threads, sep=",", file=out)
        if arguments.csv:
            print(f"{scene.name:<14} {name:<12} {threads} thread{' ' if threads == 1 else 's'}"
                  f"{statistics.fmean(medians):10.3f} ms a frame  {way.what}" if medians else "no steps")
        different = len(way.errors) - way.errors.count((0, 0)) - way.errors.count(UNKNOWN)
        if different:
            same &= not way.exact
            print(f"different answers in {different} of {len(frames)} frames: {name} on {scene.name}")
    sys.stdout.flush()
    return same


# --------------------------------------------------------------------------------------------------
# Command line


def processors():
    """The processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return sorted(os.sched_getaffinity(0))
    return list(range(os.cpu_count() or 1))


def has_heading(path):
    """Whether a file has more than lines that begin with #."""
    if not os.path.exists(path):
        return False
    with open(path, encoding="utf-8") as file:
        return any(not line.startswith("#") for line in file)


def run_measured(path, columns, threads, measure_all):
    """Measures on so many processors, and adds lines to a CSV file, or writes them to standard output where
    path is None. measure_all takes the open file and returns the exit status; 2 if a file cannot be used."""
    if hasattr(os, "sched_setaffinity"):  # before a library looks how many processors there are
        os.sched_setaffinity(0, processors()[:threads])
    try:
        headed = path and has_heading(path)
        with contextlib.ExitStack() as files:
            out = files.enter_context(open(path, "a", encoding="utf-8")) if path else sys.stdout
            if not headed:
                print(columns, file=out)
            return measure_all(out)
    except (OSError, Unusable) as error:
        print(error, file=sys.stderr)
        return 2


def read_step(parser, arguments):
    """--step as a Fraction, --from as a list of numbers."""
    try:
        if arguments.step is not None:
            arguments.step = fractions.Fraction(arguments.step)
            if not 0 < arguments.step <= 1:
                raise ValueError
    except (ValueError, ZeroDivisionError):
        parser.error("--step: a part of the way to the next frame, such as 1/50")
    if arguments.starts is not None:
        if arguments.step is None:
            parser.error("--from goes with --step")
        numbers = arguments.starts.split(",")
        if not all(number.isdigit() for number in numbers):
            parser.error("--from: numbers of frames, such as 0,19")
        arguments.starts = [int(number) for number in numbers]


def parse():
    top = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    names = sorted(PEERS) + [NOTHING_ELSE]
    parser = argparse.ArgumentParser(description="Times peers beside starcontour.")
    parser.add_argument("--list", action="store_true", help="peers, their licences, what they do")
    parser.add_argument("--peer", choices=names, help="only this one")
    parser.add_argument("--threads", default="1", help="1, all, or how many [1]")
    parser.add_argument("--repeats", type=int, default=5, help="walks that are timed [5]")
    parser.add_argument("--frames", type=int, help="only the first frames")
    parser.add_argument("--step", metavar="PART", help="steps alone: this part of the way to the next "
                        "frame, from more than 0 to 1, such as 1/50")
    parser.add_argument("--from", dest="starts", metavar="FRAME,...",
                        help="frames at which these steps start [all but the last]")
    parser.add_argument("--csv", help="file to add lines to [standard output]")
    parser.add_argument("--lib", help="starcontour's shared library [build/lib]")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="folder of a scene")
    arguments = parser.parse_args()
    if not arguments.list:
        if not arguments.scenes:
            parser.error("no scene given")
        count = len(processors())
        if arguments.threads != "all" and not arguments.threads.isdigit():
            parser.error("--threads: 1, all, or how many")
        arguments.threads = count if arguments.threads == "all" else int(arguments.threads)
        if arguments.threads < 1 or arguments.repeats < 1 or (arguments.frames or 1) < 1:
            parser.error("threads, repeats and frames are 1 or more")
        read_step(parser, arguments)
        if not arguments.lib:
            libraries = glob.glob(os.path.join(top, "build", "lib", "libstarcontour.*"))
            shared = [path for path in sorted(libraries) if not path.endswith(".a")]
            if not shared:
                parser.error("no shared library in build/lib: run make, or name it by --lib")
            arguments.lib = shared[0]
    return arguments


def run_each():
    """Runs all peers, each in a process of its own."""
    status = 0
    for peer in sorted(PEERS):
        done = subprocess.run([sys.executable, os.path.abspath(__file__), "--peer", peer,
                               *sys.argv[1:]], check=False)
        if done.returncode < 0:
            print(f"failed: {peer} was ended by signal {-done.returncode}", flush=True)
        status = max(status, 1 if done.returncode < 0 else done.returncode)
    return status


def main():
    arguments = parse()
    if arguments.list:
        for name, (function, licence, _, _) in sorted(PEERS.items()):
            print(f"{name:<10} {licence:<40} {function.__doc__}")
        return 0
    if not arguments.peer:
        return run_each()

    def measure_all(out):
        same = True
        for folder in arguments.scenes:
            scene = Scene(folder)
            scene.part = arguments.step
            same &= measure(arguments.peer, scene, arguments, out)
        return 0 if same else 1

    return run_measured(arguments.csv, COLUMNS, arguments.threads, measure_all)


if __name__ == "__main__":
    sys.exit(main())

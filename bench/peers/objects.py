#!/usr/bin/env python3
"""Times ipc-toolkit on the one mesh of several objects, beside starcontour's scene of them.

    bench/peers/objects.py --lib LIBRARY [--threads N] [--repeats N] [--csv FILE] SCENE...

A SCENE is a folder as sc-objects --export writes it. ipc-toolkit knows no objects: it gets all of them
in one mesh. In one process both have their turn in each frame:

  near   within half an edge (the median one of the first object): candidates and collisions
         (NormalCollisions) beside Scene.near
  step   to the next frame, a thousandth of that edge apart: candidates beside Scene.step, which has the
         time of each pair as well

Trees are LBVH. Candidates have no distances yet: missing are pairs of ours that are not among them. Of
more than three million that is not looked for ("unknown"), as they are Python objects; collisions,
which are merged, are not compared here, but in near.py. Pairs of an
object with itself that are not wanted (a body) stay in ipc-toolkit's lists: its filter of two vertices
is a Python function here. So what is near is not asked of scenes that have such an object.

Lines have the columns of peers.py, with "ipctk near" or "ipctk step" as what they ran beside. Exit
status: 0, 1 if a pair is missing, 2 if a scene cannot be read.

SPDX-License-Identifier: MIT
"""

import argparse
import importlib.metadata
import itertools
import os
import statistics
import sys
import time

import numpy as np

import near
import peers

COMPARED = 3000000


class Objects:
    """Several objects, read from a folder."""

    def __init__(self, folder):
        self.name = os.path.basename(os.path.normpath(folder))
        try:
            with open(os.path.join(folder, "objects.txt"), encoding="ascii") as file:
                lines = [line.split() for line in file]
            self.itself = [bool(int(itself)) for _, itself in lines]
        except (OSError, ValueError) as error:
            raise peers.Unusable(f"{folder}/objects.txt: {error}") from None
        self.scenes = [peers.Scene(os.path.join(folder, name)) for name, _ in lines]
        self.first_vertex = self.firsts(scene.vertices for scene in self.scenes)
        self.first_face = self.firsts(scene.triangles for scene in self.scenes)
        self.triangles = sum(scene.triangles for scene in self.scenes)
        self.frames = max(scene.frames for scene in self.scenes)
        self.corners = np.concatenate([np.asarray(scene.corners, np.int64) + first
                                       for scene, first in zip(self.scenes, self.first_vertex)])

    @staticmethod
    def firsts(counts):
        return [0, *itertools.accumulate(counts)][:-1]

    def moves(self, number):
        return self.scenes[number].frames > 1

    def positions(self, number, frame):
        """Of an object, of shape (n, 3)."""
        return np.array(self.scenes[number].frame(frame if self.moves(number) else 0, "d")).reshape(-1, 3)

    def frame(self, number, _):
        """Of all of them, as peers.Scene has it."""
        return np.concatenate([self.positions(i, number) for i in range(len(self.scenes))]).ravel()


class Ours:
    """starcontour's scene of them."""

    def __init__(self, objects):
        import starcontour

        self.objects, self.version = objects, starcontour.version
        self.scene, models = starcontour.Scene(), {}
        for i, scene in enumerate(objects.scenes):
            rest = objects.positions(i, 0)
            model = starcontour.Model(rest, np.array(scene.corners, np.uint32).reshape(-1, 3), weld="none")
            model = models.setdefault((scene.triangles, scene.corners.tobytes()), model)
            self.scene.add(model, rest, itself=objects.itself[i])

    def move(self, starts, ends=None):
        """Places what moves."""
        for i, one in enumerate(self.scene):
            if self.objects.moves(i):
                one.pose = starts[i]
                one.end = ends[i] if ends else None


def answers(objects, peer, found):
    """Pairs of a scene as numbers of the one mesh's vertices, faces and edges, packed, two arrays."""
    faces, edges = [np.empty(0, np.int64)], [np.empty(0, np.int64)]
    for a, b, pairs, _ in found.vertex_faces:
        pairs = pairs.astype(np.int64)
        faces.append(near.packed(pairs[:, 0] + objects.first_vertex[a.number],
                                 pairs[:, 1] + objects.first_face[b.number]))
    for a, b, pairs, _ in found.edge_edges:
        pairs = pairs.astype(np.int64)
        edges.append(near.packed_edges(
            peer.edge_of_corner[pairs[:, 0] + 3 * objects.first_face[a.number]],
            peer.edge_of_corner[pairs[:, 1] + 3 * objects.first_face[b.number]]))
    return np.concatenate(faces), np.concatenate(edges)


def missing(objects, peer, ours, candidates):
    """How many pairs of ours are no candidates; None if there are too many to look through."""
    if len(candidates) > COMPARED:
        return None
    faces, edges = answers(objects, peer, ours)
    of_faces = np.array([(c.vertex_id, c.face_id) for c in candidates.fv_candidates], np.int64).reshape(-1, 2)
    of_edges = np.array([(c.edge0_id, c.edge1_id) for c in candidates.ee_candidates], np.int64).reshape(-1, 2)
    return (len(np.setdiff1d(faces, near.packed(of_faces[:, 0], of_faces[:, 1]))) +
            len(np.setdiff1d(edges, near.packed_edges(of_edges[:, 0], of_edges[:, 1]))))


def count(found):
    return sum(len(one.pairs) for one in found.vertex_faces + found.edge_edges)


def measure_question(question, frame, arguments, objects, ours, peer, out):
    """Both in turns, in one frame. Returns how many pairs are missing."""
    number = range(len(objects.scenes))
    starts = [objects.positions(i, frame) for i in number]
    start = np.asfortranarray(np.concatenate(starts))
    if question == "near":
        distance, ends = peer.half_edge, None
        ways = {"Candidates": lambda: peer.candidates(start, distance),
                "NormalCollisions": lambda: peer.collisions(start, distance)}
    else:
        distance, ends = peer.half_edge / 500, [objects.positions(i, frame + 1) for i in number]
        end = np.asfortranarray(np.concatenate(ends))
        ways = {"Candidates of a step": lambda: peer.step_candidates(start, end, distance)}

    def ask():
        ours.move(starts, ends)
        if question == "near":
            return ours.scene.near(distance, threads=arguments.threads)
        return ours.scene.step(separation=distance, threads=arguments.threads)

    ways["objects"] = ask
    times, counts, lost = {what: [] for what in ways}, {}, dict.fromkeys(ways)
    for turn in range(arguments.repeats + 1):
        for what, way in ways.items():
            found = None
            begun = time.perf_counter()
            found = way()
            elapsed = time.perf_counter() - begun
            if turn:
                times[what].append(1000 * elapsed)
                continue
            counts[what] = count(found) if what == "objects" else len(found)
            if what == "objects":
                lost[what] = 0
            if what.startswith("Candidates"):
                lost[what] = missing(objects, peer, ask(), found)
    for what in ways:
        name, version = ("starcontour", ours.version) if what == "objects" else ("ipctk", peer.version)
        match = "unknown" if lost[what] is None else "no" if lost[what] else "yes"
        print(objects.name, objects.triangles, frame, name, version, what if what == "objects" else
              f"one mesh: {what}", arguments.threads, f"{statistics.median(times[what]):.4f}", counts[what],
              match, f"{min(times[what]):.4f}", lost[what] or 0, 0, f"ipctk {question}", arguments.threads,
              sep=",", file=out, flush=True)
    return sum(one or 0 for one in lost.values())


class Peer(near.Peer):
    """ipc-toolkit on the one mesh."""

    def __init__(self, objects, threads):
        super().__init__(objects)
        self.ipctk.set_num_threads(threads)
        self.half_edge = near.median_edge(objects.scenes[0]) / 2

    def step_candidates(self, start, end, distance):
        found = self.ipctk.Candidates()
        found.build(self.mesh, start, end, distance / 2, self.ipctk.LBVH())
        return found


def measure(folder, arguments, out):
    """All frames of a scene but the last. Returns whether no pair is missing."""
    objects = Objects(folder)
    ours, peer = Ours(objects), Peer(objects, arguments.threads)
    questions = ["near", "step"] if all(objects.itself) else ["step"]
    if len(questions) == 1 and arguments.threads == 1:
        print(f"# skipped: ipctk near on {objects.name}: it would list what a body has with itself", file=out)
    lost = 0
    for question in questions:
        for frame in range(objects.frames - 1):
            lost += measure_question(question, frame, arguments, objects, ours, peer, out)
    return lost == 0


def main():
    parser = argparse.ArgumentParser(description="Times ipc-toolkit beside starcontour on several objects.")
    parser.add_argument("--lib", required=True, help="starcontour's shared library")
    parser.add_argument("--threads", default="1", help="1, all, or how many [1]")
    parser.add_argument("--repeats", type=int, default=3, help="turns that are timed [3]")
    parser.add_argument("--csv", help="file to add lines to [standard output]")
    parser.add_argument("scenes", nargs="+", metavar="SCENE", help="folder of a scene")
    arguments = parser.parse_args()
    if arguments.threads != "all" and not arguments.threads.isdigit():
        parser.error("--threads: 1, all, or how many")
    arguments.threads = len(peers.processors()) if arguments.threads == "all" else int(arguments.threads)
    if arguments.threads < 1 or arguments.repeats < 1:
        parser.error("threads and repeats are 1 or more")
    os.environ["STARCONTOUR_LIBRARY"] = os.path.abspath(arguments.lib)
    sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../tools/python"))

    def measure_all(out):
        return 0 if all([measure(folder, arguments, out) for folder in arguments.scenes]) else 1

    return peers.run_measured(arguments.csv, peers.COLUMNS, arguments.threads, measure_all)


if __name__ == "__main__":
    sys.exit(main())

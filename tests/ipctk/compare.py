#!/usr/bin/env python3
"""`make test-ipctk`: compares steps with ipc-toolkit, frame by frame.

    tests/ipctk/compare.py --lib LIBRARY [--every N] [--contour-none] SCENE...

A SCENE is a folder as sc-bench --export writes it. For each step, or every Nth, from a frame to the next:

  - every pair of ipc-toolkit's candidates (LBVH) for which its narrow phase (Tight-Inclusion) reports a
    collision is among sc_query_step's collisions. What only its tolerance makes one is not looked for:
    a pair that we have not is asked again with a thousandth of the tolerance, and a millionth;
  - all of our collisions are candidates, and come within the tolerance: at the time that we report,
    ipc-toolkit's own distance of the pair is no more than that;
  - the collision-free part of the step is the same to the tolerance: at the time that each of the two
    says, some pair is as near as that, or both say 1.

Both get the same doubles and the same tolerance. Candidates that stay apart along an axis or a diagonal, by
more than the tolerance, are not handed to the narrow phase: it takes microseconds for each of millions.

One line for each scene; exit status 1 if something is wrong, 2 if a scene cannot be read.

SPDX-License-Identifier: MIT
"""

import argparse
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "bench",
                                "peers"))

import ipctk  # pylint: disable=wrong-import-position
import numpy as np  # pylint: disable=wrong-import-position
import peers  # pylint: disable=wrong-import-position

DIRECTIONS = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, -1, 0], [1, 0, 1], [1, 0, -1],
                       [0, 1, 1], [0, 1, -1], [1, 1, 1], [1, 1, -1], [1, -1, 1], [-1, 1, 1]], float)
DIRECTIONS /= np.linalg.norm(DIRECTIONS, axis=1)[:, None]

# Rounding of distances, relative to the size of the mesh.
ROUNDING = 1e-12

# Boxes that Tight-Inclusion looks at before it gives up and says yes.
ITERATIONS = 100000


def may_meet(first, second, along, reach):
    """Of pairs of vertex sets, arrays of numbers, those that along no direction stay farther apart than reach.
    along: a pair of arrays, directions x vertices, of the two poses."""
    above = below = None
    for pose in along:
        low = [pose[:, v].min(axis=2) for v in (first, second)]
        high = [pose[:, v].max(axis=2) for v in (first, second)]
        up, down = low[0] - high[1] > reach, low[1] - high[0] > reach
        above = up if above is None else above & up
        below = down if below is None else below & down
    return ~(above | below).any(axis=0)


class Step:
    """A step of a scene between two frames, and what ipc-toolkit says of it."""

    def __init__(self, mesh, edges, faces, poses, tolerance):
        self.mesh, self.edges, self.faces = mesh, edges, faces
        self.poses, self.tolerance = poses, tolerance
        self.narrow = ipctk.TightInclusionCCD(tolerance, ITERATIONS, 1.0)
        self.narrower = [ipctk.TightInclusionCCD(tolerance * part, ITERATIONS, 1.0)
                         for part in (1e-3, 1e-6)]
        self.candidates = ipctk.Candidates()
        self.candidates.build(mesh, *poses, 0, ipctk.LBVH())

    def stencil(self, vertices, which):
        return self.poses[which][vertices].reshape(-1)

    def collides(self, candidate, vertices):
        return all(candidate.ccd(self.stencil(vertices, 0), self.stencil(vertices, 1), 0.0, 1.0, way)[0]
                   for way in (self.narrow, *self.narrower))

    def others(self, ours):
        """Candidates that collide and are not among ours, and how many of ours are candidates. A pair is (vertex,
        face) or two edges, each by its vertices in ascending order."""
        size = np.abs(np.concatenate(self.poses)).max()
        along = [DIRECTIONS @ pose.T for pose in self.poses]
        reach = 2 * self.tolerance + ROUNDING * size
        faces = self.candidates.fv_candidates
        edges = self.candidates.ee_candidates
        found, known = [], 0
        if faces:
            v = np.array([[c.vertex_id] for c in faces])
            f = self.faces[[c.face_id for c in faces]]
            for i in np.flatnonzero(may_meet(v, f, along, reach)):
                pair = (int(v[i][0]), int(faces[i].face_id))
                if pair in ours:
                    known += 1
                elif self.collides(faces[i], [v[i][0], *f[i]]):
                    found.append(pair)
        if edges:
            a = self.edges[[c.edge0_id for c in edges]]
            b = self.edges[[c.edge1_id for c in edges]]
            for i in np.flatnonzero(may_meet(a, b, along, reach)):
                pair = tuple(sorted(tuple(sorted(map(int, e))) for e in (a[i], b[i])))
                if pair in ours:
                    known += 1
                elif self.collides(edges[i], [*a[i], *b[i]]):
                    found.append(pair)
        return found, known

    def distance(self, pair, time):
        """Of a (vertex, face) or of two edges at a time."""
        pose = (1 - time) * self.poses[0] + time * self.poses[1]
        if isinstance(pair[0], tuple):
            return ipctk.edge_edge_distance(*pose[list(pair[0] + pair[1])]) ** 0.5
        return ipctk.point_triangle_distance(pose[pair[0]], *pose[self.faces[pair[1]]]) ** 0.5

    def free_part(self):
        return self.candidates.compute_collision_free_stepsize(self.mesh, *self.poses, 0.0, self.narrow)


def compare(scene, library, every, contour):
    """Compares steps of a scene; returns what is wrong."""
    faces = np.array(scene.corners, dtype=np.int32).reshape(-1, 3)
    edges = ipctk.edges(faces)
    frames = [scene.frame(f, "d") for f in range(scene.frames)]
    poses = [np.asfortranarray(np.array(frame).reshape(-1, 3)) for frame in frames]
    mesh = ipctk.CollisionMesh(poses[0], edges, faces)
    ours = peers.Starcontour(library, scene, "d")
    wrong, steps, total = [], 0, 0
    for f in range(0, scene.frames - 1, every):
        both = np.concatenate(poses[f : f + 2])
        extent = (both.max(axis=0) - both.min(axis=0)).max()
        tolerance = 1e-6 * extent
        reach = tolerance + ROUNDING * np.abs(both).max() + ROUNDING * extent
        step = Step(mesh, edges, faces, poses[f : f + 2], tolerance)
        found, crossed, earliest = ours.step(frames[f], frames[f + 1], peers.SC_STEP_COLLISIONS,
                                             tolerance=tolerance, contour=contour)
        mine = {(a, b): time for a, b, time in found}
        mine.update({tuple(sorted((scene.edge(a), scene.edge(b)))): time for a, b, time in crossed})
        missed, known = step.others(mine)
        steps += 1
        total += len(mine)
        if known != len(mine):
            wrong.append(f"step {f}: {len(mine) - known} of ours are no candidates")
        for pair in missed:
            wrong.append(f"step {f}: we miss {pair}")
        for pair, time in mine.items():
            apart = step.distance(pair, time)
            if not apart <= reach:
                wrong.append(f"step {f}: {pair} is {apart:g} apart at {time:g}")
        free = step.free_part()
        if earliest != min(mine.values(), default=1):
            wrong.append(f"step {f}: earliest is {earliest}, of {len(mine)} collisions")
        if mine and (free < 1 or earliest < 1):
            for name, time in (("we say", earliest), ("ipc-toolkit says", free)):
                apart = min(step.distance(pair, time) for pair in mine)
                # Their time is a lower bound to a tolerance along each of three parameters.
                if not apart <= (reach if name == "we say" else 4 * reach):
                    wrong.append(f"step {f}: {name} {time:g}, when all are {apart:g} apart")
        elif free < 1 and not mine:
            wrong.append(f"step {f}: ipc-toolkit stops at {free:g}, we find nothing")
    print(f"{'wrong' if wrong else 'good':<6} {scene.name}: {scene.triangles} triangles, {steps} steps, "
          f"{total} collisions", flush=True)
    return wrong


def main():
    parser = argparse.ArgumentParser(description="Compares steps with ipc-toolkit.")
    parser.add_argument("--lib", required=True, help="starcontour's shared library")
    parser.add_argument("--every", type=int, default=1, help="one of so many steps [1]")
    parser.add_argument("--contour-none", action="store_true",
                        help="ask without a contour test, which misses collisions")
    parser.add_argument("--skipped", type=int, default=0,
                        help="how many scenes the caller left out, for the last line [0]")
    parser.add_argument("scenes", nargs="+", metavar="SCENE", help="folder of a scene")
    arguments = parser.parse_args()
    ipctk.set_logger_level(ipctk.LoggerLevel.error)
    failed = 0
    try:
        for folder in arguments.scenes:
            wrong = compare(peers.Scene(folder), arguments.lib, arguments.every,
                            peers.SC_CONTOUR_NONE if arguments.contour_none else
                            peers.SC_CONTOUR_DEFAULT)
            failed += bool(wrong)
            for line in wrong[:10]:
                print("    " + line)
    except (OSError, peers.Unusable) as error:
        print(error, file=sys.stderr)
        return 2
    print(f"{len(arguments.scenes) - failed} passed, {failed} failed, {arguments.skipped} skipped")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

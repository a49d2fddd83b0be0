"""ipc-toolkit with starcontour as its broad phase, beside its own: the same collisions and step sizes in a
simulation with barriers.

    python test_client.py [--frames N] [--cells N]

A cloth falls on a sphere (fall.py); each step is cut to what is free of collisions. In each frame both
broad phases are asked for NormalCollisions and for the step size. Prints how long both took. Exit status
1 if anything differs.

SPDX-License-Identifier: MIT
"""

import argparse
import sys
import time

import ipctk

from fall import Fall
from starcontour_ipctk import BroadPhase


def features(collision, mesh):
    """The vertices of a collision; of two edges, or two vertices, the lower one first."""
    ids = [i for i in collision.vertex_ids(mesh.edges, mesh.faces) if i >= 0]
    if isinstance(collision, ipctk.EdgeEdgeNormalCollision):
        ids = sorted([sorted(ids[:2]), sorted(ids[2:])])
        ids = ids[0] + ids[1]
    elif isinstance(collision, ipctk.VertexVertexNormalCollision):
        ids = sorted(ids)
    return tuple(ids)


def listed(collisions, mesh):
    """All collisions, sorted, with their weights, which are sums in an order of its own."""
    return sorted((type(one).__name__, features(one, mesh), float("%.9g" % one.weight))
                  for one in (collisions[i] for i in range(len(collisions))))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--frames", type=int, default=40)
    parser.add_argument("--cells", type=int, default=24)
    options = parser.parse_args()
    fall = Fall(options.cells)
    mesh = fall.mesh
    own, ours = ipctk.LBVH(), BroadPhase(fall.rest, fall.faces)
    names = [own.name(), ours.name()]
    seconds, differences, compared, touching = [[0.0, 0.0], [0.0, 0.0]], 0, 0, 0
    for frame in range(options.frames):
        answers = []
        for k, broad_phase in enumerate((own, ours)):
            collisions = ipctk.NormalCollisions()
            begin = time.perf_counter()
            collisions.build(mesh, fall.at, fall.dhat, 0.0, broad_phase)
            seconds[0][k] += time.perf_counter() - begin
            answers.append(collisions)
        compared += len(answers[0])
        if listed(answers[0], mesh) != listed(answers[1], mesh):
            differences += 1
            print(f"frame {frame}: {len(answers[0])} collisions by {names[0]}, {len(answers[1])} by {names[1]}")
        goal = fall.goal(answers[0])
        sizes = []
        for k, broad_phase in enumerate((own, ours)):
            candidates = ipctk.Candidates()
            begin = time.perf_counter()
            candidates.build(mesh, fall.at, goal, 0.0, broad_phase)
            seconds[1][k] += time.perf_counter() - begin
            sizes.append(candidates.compute_collision_free_stepsize(mesh, fall.at, goal))
        touching += sizes[0] < 1
        if sizes[0] != sizes[1]:
            differences += 1
            print(f"frame {frame}: step size {sizes[0]!r} by {names[0]}, {sizes[1]!r} by {names[1]}")
        fall.go(goal, sizes[0])
    print(f"{options.frames} frames, {compared} collisions, {touching} steps cut short, {differences} differences")
    for what, (a, b) in zip(("collisions", "candidates of steps"), seconds):
        print(f"{what}: {names[0]} {1e3 * a / options.frames:.2f} ms a frame, {names[1]} {1e3 * b / options.frames:.2f}")
    if not compared or not touching:
        print("nothing was compared: no collision, or no step that was cut short")
        return 1
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main())

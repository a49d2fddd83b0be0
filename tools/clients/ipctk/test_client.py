"""ipc-toolkit with starcontour as its broad phase, beside its own: the same collisions and step sizes in a
simulation with barriers.

    python test_client.py [--frames N] [--cells N]

A cloth falls on a sphere and on itself: springs along its edges, gravity, and ipc-toolkit's barrier; each
step is cut to what is free of collisions. In each frame both broad phases are asked for NormalCollisions
and for the step size. Prints how long both took. Exit status 1 if anything differs.

SPDX-License-Identifier: MIT
"""

import argparse
import sys
import time

import ipctk
import numpy as np

from starcontour_ipctk import BroadPhase


def make_cloth(cells):
    """A square from -1 to 1, slightly wrinkled."""
    x, y = np.meshgrid(np.linspace(-1, 1, cells + 1), np.linspace(-1, 1, cells + 1))
    vertices = np.stack([x.ravel(), y.ravel(), 0.62 + 0.01 * np.sin(7 * x.ravel()) * np.cos(5 * y.ravel())], 1)
    first = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    faces = np.concatenate([np.stack([first, first + 1, first + cells + 2], 1),
                            np.stack([first, first + cells + 2, first + cells + 1], 1)])
    return vertices, faces


def make_sphere(around):
    """A sphere of radius 0.5, open at its poles."""
    angle, height = np.meshgrid(2 * np.pi * np.arange(around) / around,
                                np.pi * (np.arange(around // 2) + 1) / (around // 2 + 1))
    vertices = 0.5 * np.stack([np.sin(height) * np.cos(angle), np.sin(height) * np.sin(angle), np.cos(height)],
                              -1).reshape(-1, 3)
    j, i = np.meshgrid(np.arange(around // 2 - 1), np.arange(around), indexing="ij")
    a, b = (j * around + i).ravel(), (j * around + (i + 1) % around).ravel()
    return vertices, np.concatenate([np.stack([a, a + around, b + around], 1), np.stack([a, b + around, b], 1)])


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
    cloth, cloth_faces = make_cloth(options.cells)
    sphere, sphere_faces = make_sphere(options.cells)
    rest = np.asfortranarray(np.concatenate([cloth, sphere]))
    faces = np.asfortranarray(np.concatenate([cloth_faces, sphere_faces + len(cloth)]).astype(np.int32))
    edges = np.asfortranarray(ipctk.edges(faces))
    mesh = ipctk.CollisionMesh(rest, edges, faces)
    moves = np.arange(len(rest)) < len(cloth)
    springs = edges[moves[edges].all(1)]
    lengths = np.linalg.norm(rest[springs[:, 0]] - rest[springs[:, 1]], axis=1)
    own, ours = ipctk.LBVH(), BroadPhase(rest, faces)
    names = [own.name(), ours.name()]
    seconds, differences, compared, touching = [[0.0, 0.0], [0.0, 0.0]], 0, 0, 0
    dhat, stiffness, dt = 0.4 / options.cells, 50.0, 0.02
    barrier = ipctk.BarrierPotential(dhat, 1e3)
    at, velocity = rest.copy(order="F"), np.zeros_like(rest)
    for frame in range(options.frames):
        answers = []
        for k, broad_phase in enumerate((own, ours)):
            collisions = ipctk.NormalCollisions()
            begin = time.perf_counter()
            collisions.build(mesh, at, dhat, 0.0, broad_phase)
            seconds[0][k] += time.perf_counter() - begin
            answers.append(collisions)
        compared += len(answers[0])
        if listed(answers[0], mesh) != listed(answers[1], mesh):
            differences += 1
            print(f"frame {frame}: {len(answers[0])} collisions by {names[0]}, {len(answers[1])} by {names[1]}")
        force = np.zeros_like(rest)
        way = at[springs[:, 1]] - at[springs[:, 0]]
        length = np.linalg.norm(way, axis=1)
        pull = (stiffness * (length - lengths) / lengths / np.maximum(length, 1e-12))[:, None] * way
        np.add.at(force, springs[:, 0], pull)
        np.add.at(force, springs[:, 1], -pull)
        force[:, 2] -= 9.81
        if len(answers[0]):
            force -= barrier.gradient(answers[0], mesh, at).reshape(-1, 3)
        velocity = np.where(moves[:, None], 0.97 * (velocity + dt * force), 0)
        goal = np.asfortranarray(at + dt * velocity)
        sizes = []
        for k, broad_phase in enumerate((own, ours)):
            candidates = ipctk.Candidates()
            begin = time.perf_counter()
            candidates.build(mesh, at, goal, 0.0, broad_phase)
            seconds[1][k] += time.perf_counter() - begin
            sizes.append(candidates.compute_collision_free_stepsize(mesh, at, goal))
        touching += sizes[0] < 1
        if sizes[0] != sizes[1]:
            differences += 1
            print(f"frame {frame}: step size {sizes[0]!r} by {names[0]}, {sizes[1]!r} by {names[1]}")
        at = np.asfortranarray(at + 0.9 * sizes[0] * (goal - at)) if sizes[0] < 1 else goal
        if sizes[0] < 1:
            velocity *= sizes[0]
    print(f"{options.frames} frames, {compared} collisions, {touching} steps cut short, {differences} differences")
    for what, (a, b) in zip(("collisions", "candidates of steps"), seconds):
        print(f"{what}: {names[0]} {1e3 * a / options.frames:.2f} ms a frame, {names[1]} {1e3 * b / options.frames:.2f}")
    if not compared or not touching:
        print("nothing was compared: no collision, or no step that was cut short")
        return 1
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main())

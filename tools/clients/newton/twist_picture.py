"""Draws what measure.py saved: the last pose of two runs, triangles that intersect in red, and both tables.

    python twist_picture.py THEIRS.npz OURS.npz PICTURE.png [--pose N] [--eye ELEVATION AZIMUTH]

Needs matplotlib. SPDX-License-Identifier: MIT
"""

import argparse

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

import starcontour


def draw(axes, pose, triangles, title, eye):
    """Triangles shaded by their normals, seen along -x and turned a little, those that intersect in red."""
    pairs = starcontour.Model(pose, triangles, weld="none").query(pose)
    corners = pose[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
    light = 0.35 + 0.6 * np.abs(normal @ np.array([0.6, 0.3, 0.74]))
    colors = np.stack([light * 0.55, light * 0.72, light], axis=1)
    colors[np.unique(pairs)] = [0.85, 0.1, 0.1]
    axes.add_collection3d(Poly3DCollection(corners, facecolors=colors, edgecolors=colors * 0.9, linewidths=0.1))
    middle, size = (pose.max(0) + pose.min(0)) / 2, np.ptp(pose, axis=0).max() / 2 * 0.6
    axes.set(xlim=(middle[0] - size, middle[0] + size), ylim=(middle[1] - size, middle[1] + size),
             zlim=(middle[2] - size, middle[2] + size))
    axes.set_box_aspect((1, 1, 1), zoom=1.8)
    axes.view_init(*eye)
    axes.set_axis_off()
    axes.set_title(f"{title}: {len(pairs)} pairs intersect", fontsize=9)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("theirs")
    parser.add_argument("ours")
    parser.add_argument("picture")
    parser.add_argument("--pose", type=int, default=-1)
    parser.add_argument("--eye", type=float, nargs=2, default=(15, 0))
    options = parser.parse_args()
    figure = plt.figure(figsize=(8, 5.6), dpi=100)
    grid = figure.add_gridspec(2, 2, height_ratios=(1, 1.3))
    runs = [np.load(name) for name in (options.theirs, options.ours)]
    names = ["newton's detector", "starcontour"]
    for k, (run, name) in enumerate(zip(runs, names)):
        poses = run["poses"]
        at = options.pose % len(poses)
        draw(figure.add_subplot(grid[0, k], projection="3d"), poses[at].astype(float), run["triangles"].reshape(-1, 3),
             f"{name}, frame {10 * at + 10}", options.eye)
    end = 10 * (options.pose % len(runs[0]["poses"])) + 10
    axes = figure.add_subplot(grid[1, 0])
    for run, name, color in zip(runs, names, ("C3", "C0")):
        axes.plot(run["table"][:end, 1], color=color, label=name)
    axes.set(xlabel="frame", title="pairs of triangles that intersect")
    axes.legend(fontsize=8)
    axes = figure.add_subplot(grid[1, 1])
    axes.plot(runs[0]["table"][:end, 2] / 1e3, color="C7", label="found")
    axes.plot(runs[0]["table"][:end, 3] / 1e3, color="C3", label="dropped, rows of 16 and 20")
    axes.set(xlabel="frame", title="newton's contacts in a search, thousands")
    axes.legend(fontsize=8)
    for axes in figure.axes[2:]:
        axes.title.set_fontsize(9)
        axes.tick_params(labelsize=8)
    figure.tight_layout()
    figure.savefig(options.picture)


if __name__ == "__main__":
    main()

"""The smallest scene of untangle.py ends without a pair, its edges as long as at rest within 5 %.

    python test_untangle.py

SPDX-License-Identifier: MIT
"""

import sys

import numpy as np

import starcontour
import untangle

scene = untangle.cloths(12)
before = starcontour.Model(scene.rest, scene.triangles, weld="none").count(scene.pose)
pose, history, error, model = untangle.untangle(scene, seconds=120)
a, b = untangle.Edges(scene).ends.T
change = np.linalg.norm(pose[b] - pose[a], axis=1) / np.linalg.norm(scene.rest[b] - scene.rest[a], axis=1)
checks = {
    f"{before} pairs at first": before > 0,
    f"{model.count(pose)} pairs after {len(history) - 1} iterations": model.count(pose) == 0,
    f"edges from {change.min():.4f} to {change.max():.4f} of their length": 0.95 < change.min() and change.max() < 1.05,
    "all is finite": bool(np.isfinite(pose).all()),
}
for name, holds in checks.items():
    print(f"{'passed' if holds else 'FAILED'}: {name}")
sys.exit(not all(checks.values()))

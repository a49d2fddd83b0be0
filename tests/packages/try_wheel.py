"""Asks the installed Python package for the pairs that consumer.c asks the library for, and prints
them as that does; then that a step ends where two triangles meet.

    python tests/packages/try_wheel.py [VERSION]

SPDX-License-Identifier: MIT
"""

import sys
from importlib.metadata import version

import numpy as np
import starcontour

SIDE = 24
row, column = np.divmod(np.arange(SIDE * SIDE), SIDE)
rest = np.stack([column, row, 0 * row], 1).astype(np.float32)
wound = np.stack([column % 4 + row % 3 / 2, row, column % 3 - column % 5 / 2], 1).astype(np.float32)
v = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)[:-1, :-1].ravel()
triangles = np.stack([v, v + 1, v + SIDE, v + SIDE, v + 1, v + SIDE + 1], 1).reshape(-1, 3)

model = starcontour.Model(rest, triangles.astype(np.uint16))
for name, pose in ("flat", rest), ("wound", wound):
    pairs = model.query(pose)
    print(f"{name}: {len(pairs)} pairs")
    for a, b in pairs:
        print(a, b)

start = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, 1], [2, 1, 1], [1, 2, 1]], np.float64)
end = start.copy()
end[3, 2] = -1
step = starcontour.Model(start, [[0, 1, 2], [3, 4, 5]]).step(start, end)
assert 0.4999 < step.earliest <= 0.5, step.earliest
assert sys.argv[1:] in ([], [version("starcontour")]), version("starcontour")

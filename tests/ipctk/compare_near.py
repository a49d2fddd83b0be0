#!/usr/bin/env python3
"""`make test-ipctk`: compares what is near, and how near, with ipc-toolkit.

    tests/ipctk/compare_near.py --lib LIBRARY [--every N] [--shift S] SCENE...

A SCENE is a folder as sc-bench --export writes it. In every Nth frame, at each of five distances in median
edges:

  - our pairs are among ipc-toolkit's candidates, and those of them that are nearer than the distance, by
    doubles computed in bench/peers/near.py, are ours, but for distances within 1e-9 of the one asked for;
  - of some thousand pairs drawn from ours, distances of sc_near_stencils are those that ipc-toolkit's
    point_triangle_distance and edge_edge_distance give, but for its rounding.

--shift makes the library's distance larger by this factor than the one that is compared with, so that the
comparison can be seen to fail. One line for each scene; exit status 1 if something is wrong, 2 if a scene
cannot be read.

SPDX-License-Identifier: MIT
"""

import argparse
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "bench",
                                "peers"))

import ipctk  # pylint: disable=wrong-import-position
import near as near_peer  # pylint: disable=wrong-import-position
import numpy as np  # pylint: disable=wrong-import-position
import peers  # pylint: disable=wrong-import-position

DISTANCES = (0.05, 0.2, 0.5, 1, 2)

# Pairs of a kind whose distances are compared, in a frame at a distance.
DRAWN = 300

# ipc-toolkit's distances are those of doubles: relative, and, as it subtracts coordinates and takes a
# root of what is left, relative to the mesh's size.
RELATIVE, OF_SIZE = 1e-10, 1e-13


class Shifted(near_peer.Near):
    """The library, asked for a distance that is a little larger."""

    shift = 1.0

    def query(self, positions, distance, *rest, **more):
        return super().query(positions, distance * self.shift, *rest, **more)


def compare_distances(near, positions, counts, generator):
    """Of pairs drawn from the lists: how many were compared, the worst difference relative to what is
    allowed."""
    points = positions.reshape(-1, 3)
    size = np.abs(points).max()
    worst, compared = 0.0, 0
    kinds = ((near_peer.SC_NEAR_VERTEX_FACE, ipctk.point_triangle_distance),
             (near_peer.SC_NEAR_EDGE_EDGE, ipctk.edge_edge_distance))
    for (kind, distance), pairs, count in zip(kinds, near.lists, counts):
        chosen = generator.choice(count, min(count, DRAWN), replace=False) if count else []
        for stencil in near.stencils(positions, kind, np.ascontiguousarray(pairs[:count][chosen])):
            theirs = distance(*points[stencil["vertices"]]) ** 0.5
            ours = float(stencil["distance"])
            allowed = RELATIVE * max(ours, theirs) + OF_SIZE * size
            worst = max(worst, abs(ours - theirs) / allowed)
            compared += 1
    return compared, worst


def compare(scene, library, every, shift):
    """Compares frames of a scene; returns what is wrong."""
    near, peer = Shifted(library, scene), near_peer.Peer(scene)
    edge, generator = near_peer.median_edge(scene), np.random.default_rng(1)
    wrong, pairs, drawn, skipped = [], 0, 0, 0
    for frame in range(0, scene.frames, every):
        positions = np.array(scene.frame(frame, "d"))
        vertices = np.asfortranarray(positions.reshape(-1, 3))
        for edges in DISTANCES:
            distance = edges * edge
            near.shift = shift
            counts = near.query(positions, distance)
            compared, worst = compare_distances(near, positions, counts, generator)
            drawn += compared
            pairs += sum(counts)
            if worst > 1:
                wrong.append(f"frame {frame}, {edges} edges: a distance differs {worst:.3g} times as much "
                             "as it may")
            verdict = near_peer.judge_candidates(near, peer, positions, distance,
                                                 peer.candidates(vertices, distance))
            if verdict is None:
                skipped += 1
            elif verdict != (0, 0):
                wrong.append(f"frame {frame}, {edges} edges: of ours %d are no candidates; %d candidates "
                             "that are near are not ours, or ours are not near" % verdict)
    if not drawn:
        wrong.append("nothing is near in any frame")
    print(f"{'wrong' if wrong else 'good':<6} {scene.name}: {scene.triangles} triangles, {pairs} pairs, "
          f"{drawn} distances" + (f"; too many pairs {skipped} times" if skipped else ""), flush=True)
    return wrong


def main():
    parser = argparse.ArgumentParser(description="Compares what is near with ipc-toolkit.")
    parser.add_argument("--lib", required=True, help="starcontour's shared library")
    parser.add_argument("--every", type=int, default=1, help="one of so many frames [1]")
    parser.add_argument("--shift", type=float, default=1.0,
                        help="factor of the library's distance [1]")
    parser.add_argument("--skipped", type=int, default=0,
                        help="how many scenes the caller left out, for the last line [0]")
    parser.add_argument("scenes", nargs="+", metavar="SCENE", help="folder of a scene")
    arguments = parser.parse_args()
    ipctk.set_logger_level(ipctk.LoggerLevel.error)
    failed = 0
    try:
        for folder in arguments.scenes:
            wrong = compare(peers.Scene(folder), arguments.lib, arguments.every, arguments.shift)
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

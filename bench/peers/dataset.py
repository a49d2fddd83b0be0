#!/usr/bin/env python3
"""Times a peer from PyPI beside starcontour on the poses of a dataset, each once, and compares answers.

    dataset.py --peer NAME [--poses N] [--threads 1|all|N] [--csv FILE] --lib FILE SCENE

SCENE is a folder that `sc-dataset --export` wrote: frame 0 is the character at rest, of which models
are built, every other one a pose. Both are asked about each pose in turn, in one process: the peer, as
peers.py has it, and sc_query for all pairs, by one thread. The first pose is asked about once more
before, without a clock. A line of the CSV file is a way of the peer:

    scene                           the folder's name
    peer, version, what, threads    as in peers.csv
    triangles, poses                of the character; how many poses were asked about
    ms, ours_ms                     medians over the poses
    mean, ours_mean                 means: where they are much more, other programs ran at the same time
    colliding                       in how many there is a pair
    wrong                           in how many the peer's answer to "does it collide?" is wrong
    missing, extra                  pairs in all poses that it did not find, or found and are none;
                                    of what answers with triangles, these; of yes or no: answers
    unequal                         in how many poses something is missing or extra

Pairs of triangles that share a vertex are left out, as in peers.csv.

Exit status: 0; 3 if a peer that claims exactness was wrong; 2 if the scene cannot be read or an option
is wrong.

SPDX-License-Identifier: MIT
"""

import argparse
import statistics
import sys
import time

sys.dont_write_bytecode = True  # nothing is to appear beside this file

import peers

COLUMNS = ("scene,peer,version,what,threads,triangles,poses,ms,ours_ms,mean,ours_mean,colliding,wrong,missing,"
           "extra,unequal")

# What a peer may be asked of one pose.
KINDS = (peers.ALL, peers.APART, peers.FACES, peers.ANY_APART)


def is_wrong(expected, kind, answer):
    """Whether the peer's verdict, is there a pair or not, is wrong."""
    if kind == peers.FACES:  # of triangles that share a vertex, some pairs count for it
        return bool(expected.apart()) > bool(answer) or bool(answer) > bool(expected.all)
    return bool(answer) != bool(expected.all if kind == peers.ALL else expected.apart())


class Tally:
    """What a way did over all poses."""

    def __init__(self, way):
        self.way = way
        self.ms, self.ours = [], []
        self.colliding = self.wrong = self.missing = self.extra = self.unequal = 0

    def add(self, expected, answer):
        kind = self.way.kind
        missing, extra = expected.judge(kind, answer)
        self.colliding += bool(expected.all if kind == peers.ALL else expected.apart())
        self.wrong += is_wrong(expected, kind, answer)
        self.missing += missing
        self.extra += extra
        self.unequal += bool(missing or extra)


def measure(scene, arguments, out):
    """Measures a peer. Returns whether all answers that claim exactness were right."""
    scalar = peers.PEERS[arguments.peer][2]
    version, ways = peers.find_ways(arguments.peer, scene)
    import numpy as np

    ours = peers.Starcontour(arguments.lib, scene, scalar)
    tallies = [Tally(way) for way in ways if way.kind in KINDS]
    poses = min(arguments.poses, scene.frames - 1)
    for pose in range(-1, poses):
        positions = scene.frame(max(pose, 0) + 1, scalar)
        for tally in tallies:
            given = tally.way.prepare(np.frombuffer(positions, dtype=scalar).reshape(-1, 3))
            start = time.perf_counter()
            found = tally.way.query(given)
            between = time.perf_counter()
            ours.query("exact", positions)
            end = time.perf_counter()
            if pose < 0:
                continue
            tally.ms.append(1000 * (between - start))
            tally.ours.append(1000 * (end - between))
            tally.add(peers.Expected(ours, positions, None), tally.way.answer(found))
    right = True
    for tally in tallies:
        way = tally.way
        print(scene.name, arguments.peer, version, way.what, arguments.threads, scene.triangles, poses,
              *(f"{middle(times):.4f}" for middle in (statistics.median, statistics.fmean)
                for times in (tally.ms, tally.ours)),
              tally.colliding, tally.wrong, tally.missing, tally.extra, tally.unequal, sep=",", file=out)
        if arguments.csv:
            print(f"{scene.name:<8} {arguments.peer:<12} {arguments.threads} thread{' ' if arguments.threads == 1 else 's'}"
                  f"{statistics.median(tally.ms):12.3f} ms a pose, "
                  f"ours {statistics.median(tally.ours):.3f}; "
                  f"{tally.unequal} of {poses} answers are not ours")
        if tally.unequal and way.exact:
            right = False
            print(f"different answers: {arguments.peer}, {way.what}")
    sys.stdout.flush()
    return right


def parse():
    parser = argparse.ArgumentParser(description="Times a peer beside starcontour on many poses.")
    parser.add_argument("--peer", choices=sorted(peers.PEERS), required=True)
    parser.add_argument("--poses", type=int, default=200, help="at most so many [200]")
    parser.add_argument("--threads", default="1", help="1, all, or how many [1]")
    parser.add_argument("--csv", help="file to add lines to [standard output]")
    parser.add_argument("--lib", required=True, help="starcontour's shared library")
    parser.add_argument("scene", metavar="SCENE", help="folder that sc-dataset --export wrote")
    arguments = parser.parse_args()
    if arguments.threads != "all" and not arguments.threads.isdigit():
        parser.error("--threads: 1, all, or how many")
    arguments.threads = (len(peers.processors()) if arguments.threads == "all"
                         else int(arguments.threads))
    if arguments.threads < 1 or arguments.poses < 1:
        parser.error("threads and poses are 1 or more")
    return arguments


def main():
    arguments = parse()

    def measure_all(out):
        if arguments.threads > 1 and not peers.PEERS[arguments.peer][3]:
            print(f"skipped: {arguments.peer}: it uses one thread only", flush=True)
            return 0
        scene = peers.Scene(arguments.scene)
        if scene.frames < 2:
            raise peers.Unusable(f"{scene.name}: there is no pose behind the rest pose")
        try:
            return 0 if measure(scene, arguments, out) else 3
        except peers.Skipped as reason:
            print(f"skipped: {arguments.peer}: {reason}", flush=True)
            print(f"# skipped: {arguments.peer}: {reason}", file=out)
            return 0

    return peers.run_measured(arguments.csv, COLUMNS, arguments.threads, measure_all)


if __name__ == "__main__":
    sys.exit(main())

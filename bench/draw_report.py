#!/usr/bin/env python3
"""Makes tables and plots of what was measured: summary.csv, frames.csv, report.md, SVG and PNG.

    bench/draw_report.py [--command TEXT] [--seconds N] [--readme FILE] [--programs FOLDER] RESULTS [RAW]

RAW is a folder with JSON Lines of sc-bench; without it, the CSV files in RESULTS are taken as they are.
peers.csv in RESULTS, if there is one, is what `make peers` wrote. Every figure in report.md comes from these
files. Needs matplotlib for plots; without it they are left out, and the report says so.

SPDX-License-Identifier: MIT
"""

import argparse
import collections
import csv
import glob
import json
import math
import os
import sys

sys.dont_write_bytecode = True  # nothing is to appear beside this file

import report_dataset
import report_near
import report_objects
import report_pictures
import report_plots
import report_targets as targets
import report_trace
import report_wasm
from report_text import figure, mean, table, times, whole

HERE = os.path.dirname(os.path.abspath(__file__))

PEERS = ["cgal", "embree", "fcl", "ipctk", "libigl", "meshlib", "open3d", "pymeshlab", "python-fcl", "trueform"]

METHODS = list(report_plots.STYLES)

STEP_METHODS = ["step", "step-star", "step-none", "step-two-boxes", "step-swept"]

TASKS = ["update_boxes", "update_normals", "orientation", "boxes_orientation",
         "primitives_orientation", "update_contours", "contour", "boxes_contour",
         "primitives_contour"]

TASK_TITLES = ["update boxes", "update normals", "orientation", "boxes (o.)", "primitives (o.)",
               "update contours", "contour", "boxes (c.)", "primitives (c.)"]

SUMMARY = (["scene", "triangles", "vertices", "partition", "pairs_kind", "contact", "mode",
            "threads", "frames", "repeats", "method", "rest_ms", "mean_ms", "worst_ms",
            "mean_of_minima_ms", "ns_per_triangle", "times_floor", "floor_ns_per_triangle",
            "rest_pairs", "mean_pairs", "most_pairs", "missed", "most_missed", "missed_percent",
            "extra"] + [task + "_ms" for task in TASKS] +
           ["nodes", "boxes", "primitives", "build_ms", "model_bytes", "workspace_bytes",
            "hash_bytes", "cpu_share", "rest_contour_ms", "rest_contour_edges",
            "mean_of_maxima_ms"])

# Of steps: means over the animation, a line a scene and method.
STEPS = ["scene", "triangles", "partition", "steps", "method", "collisions", "missed", "candidates",
         "candidates_ms", "mean_ms", "worst_ms", "cpu_share"]

# Methods that are timed in every pass: all but the hash.
REPEATED = [method for method in METHODS if method != "hash"]

# A line a frame: milliseconds of each method; the least and the greatest of those with repeats.
FRAMES = (["scene", "triangles", "partition", "frame", "pairs", "missed_by_none"] + METHODS +
          ["exact_min", "aabb_min"] + [m + "_min" for m in REPEATED if m not in ("exact", "aabb")] +
          [m + "_max" for m in REPEATED])


# ---------------------------------------------------------------------------------------------------
# Reading and condensing

def short(number):
    """Six digits at most, as text; whole numbers whole."""
    if number is None:
        return ""
    if float(number) == int(number):
        return str(int(number))
    return "%.6g" % number


def read_lines(folder, ending):
    """Names of files without ending, and their JSON Lines."""
    for path in sorted(glob.glob(os.path.join(folder, "*" + ending))):
        with open(path, encoding="utf-8") as file:
            yield os.path.basename(path), [json.loads(line) for line in file if line.strip()]


def read_runs(folder, ending=".jsonl"):
    """Each run: its description and its records."""
    return [(lines[0], lines[1:]) for _, lines in read_lines(folder, ending) if len(lines) > 1]


def summarize(description, records):
    """A row for each method of a run."""
    rows = []
    for method in METHODS:
        own = [r for r in records if r["method"] == method]
        if not own:
            continue
        row = {key: description.get(key) for key in
               ("scene", "triangles", "vertices", "partition", "pairs_kind", "contact", "mode",
                "threads", "frames", "repeats", "floor_ns_per_triangle", "build_ms", "model_bytes",
                "workspace_bytes", "hash_bytes", "cpu_share")}
        average = mean(r["ms"] for r in own)
        complete = sum(r["pairs"] + r["missed"] - r["extra"] for r in own)
        missed = sum(r["missed"] for r in own)
        row.update({
            "method": method,
            "rest_ms": own[0]["ms"],
            "mean_ms": average,
            "worst_ms": max(r["ms"] for r in own),
            "mean_of_minima_ms": mean(r["ms_min"] for r in own),
            "ns_per_triangle": 1e6 * average / description["triangles"],
            "times_floor": mean(r["times_floor"] for r in own),
            "rest_pairs": own[0]["pairs"],
            "mean_pairs": mean(r["pairs"] for r in own),
            "most_pairs": max(r["pairs"] for r in own),
            "missed": missed,
            "most_missed": max(r["missed"] for r in own),
            "missed_percent": 100.0 * missed / complete if complete else 0.0,
            "extra": sum(r["extra"] for r in own),
        })
        if "ms_max" in own[0]:
            row["mean_of_maxima_ms"] = mean(r["ms_max"] for r in own)
        if own[0]["nodes"] is not None:
            row["rest_contour_ms"] = own[0]["update_contours_ms"] + own[0]["contour_ms"]
            row["rest_contour_edges"] = own[0]["contour_edges"]
        for key in [task + "_ms" for task in TASKS] + ["nodes", "boxes", "primitives"]:
            values = [r[key] for r in own if r[key] is not None]
            row[key] = mean(values) if values else None
        rows.append(row)
    return rows


def summarize_steps(description, records):
    """A row for each method of a run on steps."""
    rows = []
    for method in STEP_METHODS:
        own = [r for r in records if r["method"] == method]
        if own:
            rows.append({
                "scene": description["scene"], "triangles": description["triangles"],
                "partition": description["partition"], "steps": len(own), "method": method,
                "collisions": mean(r["pairs"] for r in own),
                "missed": sum(r["missed"] for r in own),
                "candidates": mean(r["candidates"] for r in own),
                "candidates_ms": mean(r["candidates_ms"] for r in own),
                "mean_ms": mean(r["ms"] for r in own), "worst_ms": max(r["ms"] for r in own),
                "cpu_share": description["cpu_share"]})
    return rows


def write_csv(path, columns, rows, description):
    with open(path, "w", encoding="utf-8", newline="") as file:
        for key in ("command", "seconds", "skipped", "commit", "compiler", "flags", "cpu", "cores"):
            file.write("# %s: %s\n" % (key, description[key]))
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        for row in rows:
            values = [row.get(c) for c in columns]
            writer.writerow([v if isinstance(v, str) else short(v) for v in values])


def number(text):
    try:
        return float(text)
    except ValueError:
        return text if text else None


def read_csv(path):
    """The rows, numbers as numbers, and what stands in the lines that begin with #."""
    description, lines = {}, []
    with open(path, encoding="utf-8", newline="") as file:
        for line in file:
            if line.startswith("#"):
                key, _, value = line[1:].strip().partition(": ")
                description[key] = value
            else:
                lines.append(line)
    rows = [{key: number(value) for key, value in row.items()} for row in csv.DictReader(lines)]
    return rows, description


def read_peers(path, last="processors"):
    """Rows of peers.csv, its lines "# skipped: ..." and the commit; nothing if it is not there, or has not
    the columns that are read here, of which last is one."""
    if not os.path.exists(path):
        return [], [], "?"
    with open(path, encoding="utf-8") as file:
        skipped = [line[len("# skipped: "):].strip() for line in file if line.startswith("# skipped: ")]
    rows, description = read_csv(path)
    if rows and last not in rows[0]:
        print("draw_report.py: %s lacks columns: run 'make peers' again" % path, file=sys.stderr)
        rows = []
    return rows, skipped, description.get("commit", "?")


def collect(raw, results, command, seconds):
    """JSON Lines to summary.csv and frames.csv, which has the main runs alone."""
    runs = read_runs(raw)
    if not runs:
        sys.exit("draw_report.py: nothing was measured: no results in " + raw)
    if len({d["commit"] for d, _ in runs}) > 1:
        sys.exit("draw_report.py: results of different commits in " + raw)
    steps = [row for d, records in runs if d["pairs_kind"] == "step"
             for row in summarize_steps(d, records)]
    near = report_near.collect([run for run in runs if run[0]["pairs_kind"] == "near"])
    runs = [(d, records) for d, records in runs if d["pairs_kind"] not in ("step", "near")]
    if not runs:
        sys.exit("draw_report.py: no run on pairs of triangles, or of edges and triangles, in " + raw)
    turns = [row for d, records in runs if targets.kind_of_turns(d, records)
             for row in targets.collect_turns(d, records)]
    runs = [(d, records) for d, records in runs if not targets.kind_of_turns(d, records)]
    shots = [row for _, rows in read_lines(raw, ".shots") for row in rows]
    built = targets.collect_built([(name.split(".")[0], lines[0], lines[1:])
                                   for name, lines in read_lines(raw, ".built") if len(lines) > 1])
    summary = [row for d, records in runs for row in summarize(d, records)]
    frames = []
    for d, records in runs:
        by_frame = collections.OrderedDict()
        for r in records:
            by_frame.setdefault(r["frame"], {})[r["method"]] = r
        if (d["pairs_kind"], d["mode"], d["threads"]) != ("edge", "once", 1) or \
                len(by_frame[0]) < len(METHODS):
            continue
        for frame, methods in by_frame.items():
            row = {"scene": d["scene"], "triangles": d["triangles"], "partition": d["partition"],
                   "frame": frame, "pairs": methods["exact"]["pairs"],
                   "missed_by_none": methods["none"]["missed"]}
            row.update({m: float("%.4g" % methods[m]["ms"]) for m in METHODS})
            row.update({"%s_%s" % (m, end): float("%.4g" % methods[m]["ms_" + end])
                        for m in REPEATED for end in ("min", "max") if "ms_" + end in methods[m]})
            frames.append(row)
    skipped = []
    log = os.path.join(raw, "skipped.log")
    if os.path.exists(log):
        with open(log, encoding="utf-8") as file:
            skipped = [line.strip() for line in file]
    description = dict(runs[0][0], command=command, seconds=seconds,
                       skipped="; ".join(skipped) or "nothing")
    write_csv(os.path.join(results, "summary.csv"), SUMMARY, summary, description)
    write_csv(os.path.join(results, "frames.csv"), FRAMES, frames, description)
    for name, columns, rows in (("steps.csv", STEPS, steps), ("turns.csv", targets.TURNS, turns),
                                ("shots.csv", targets.SHOTS, shots),
                                ("built.csv", targets.BUILT, built),
                                ("near.csv", report_near.NEAR, near),
                                ("objects.csv", report_objects.OBJECTS, report_objects.collect(raw)),
                                ("dataset.csv", report_dataset.DATASET, report_dataset.collect(raw))):
        if rows:
            write_csv(os.path.join(results, name), columns, rows, description)


# ---------------------------------------------------------------------------------------------------
# Tables

class Results:
    """What was measured: a row of summary.csv by run and method."""

    def __init__(self, folder):
        self.rows, self.description = read_csv(os.path.join(folder, "summary.csv"))
        self.frames, _ = read_csv(os.path.join(folder, "frames.csv"))
        (self.steps, self.turns, self.shots, self.built, self.near, self.near_peers, self.objects,
         self.dataset) = (
            read_csv(path)[0] if os.path.exists(path) else []
            for path in (os.path.join(folder, name + ".csv")
                         for name in ("steps", "turns", "shots", "built", "near",
                                      "near_peers", "objects", "dataset")))
        near = os.path.join(folder, "near.csv")
        self.near_commit = read_csv(near)[1].get("commit") if os.path.exists(near) else None
        self.objects_peers = read_peers(os.path.join(folder, "objects_peers.csv"))
        self.dataset_peers = read_peers(os.path.join(folder, "dataset_peers.csv"), "unequal")
        self.trace_peers = read_peers(os.path.join(folder, "trace_peers.csv"), "verdict")
        self.wasm = read_peers(os.path.join(folder, "wasm.csv"), "same")
        peers = os.path.join(folder, "peers.csv")
        rows, skipped, self.peers_commit = read_peers(peers)
        self.peers_skipped = [line for line in skipped if "(step " not in line]
        self.small_steps_skipped = [line for line in skipped if "(step " in line]
        self.peers = [row for row in rows if not row["what"].startswith(("step: ", "step "))]
        self.peer_steps = [row for row in rows if row["what"].startswith("step: ")]
        self.peer_small_steps = [row for row in rows if row["what"].startswith("step ")]
        self.runs = collections.OrderedDict()
        for row in self.rows:
            key = (row["scene"], row["triangles"], row["partition"], row["pairs_kind"],
                   row["mode"], row["threads"])
            self.runs.setdefault(key, {})[row["method"]] = row

    def main_runs(self, pairs="edge"):
        """One thread, one query a frame, all methods; (scene, triangles): run."""
        found = collections.OrderedDict()
        for key, run in self.runs.items():
            if key[3] == pairs and key[4] == "once" and key[5] == 1 and len(run) == len(METHODS):
                found.setdefault(key[:2], run)
        return found


def overview(results):
    """The table that README.md shows: the largest size of each scene with all methods and 60 frames,
    or as many as there are; and how peers did on frames of the same meshes, in a process of each."""
    best = collections.OrderedDict()
    for (scene, triangles), run in results.main_runs().items():
        frames = run["exact"]["frames"]
        if scene not in best or (frames, triangles) >= best[scene][:2]:
            best[scene] = (frames, triangles, run)
    shown = [m for m in METHODS if m not in ("none", "hash")]
    peers = {}
    for (peer, _, what), scenes in peer_runs(results).items():
        for name, begin in (("Embree", "rtcCollide: tree refitted"), ("CGAL", "self_intersections")):
            if peer == name.lower() and what.startswith(begin):
                peers.update({(name,) + scene: processes[1].ratio
                              for scene, processes in scenes.items() if 1 in processes})
    rows = []
    for scene, (_, triangles, run) in best.items():
        rest, average = run["exact"]["rest_ms"], run["exact"]["mean_ms"]
        rows.append([scene, whole(triangles)] + [figure(run[m]["mean_ms"]) for m in shown] +
                    [times(run["aabb"]["rest_ms"] / rest), times(run["aabb"]["mean_ms"] / average),
                     times(targets.worst_frame(results.turns, scene, triangles))] +
                    [times(ratio) if ratio else "–" for ratio in
                     (peers.get((name, scene, triangles)) for name in ("Embree", "CGAL"))])
    return table(["scene", "triangles"] + shown +
                 ["rest: × aabb", "mean: × aabb", "worst frame: × aabb", "mean: × Embree",
                  "mean: × CGAL"], rows)


def matches_of_paper(results):
    """Rows of the paper's table with the run of the same scene and about the same size, or None."""
    paper, _ = read_csv(os.path.join(HERE, "paper_table1.csv"))
    runs = results.main_runs()
    matches = []
    for row in paper:
        near = [(abs(math.log(t / row["triangles"])), run) for (scene, t), run in runs.items()
                if scene == row["scene"] and abs(math.log(t / row["triangles"])) < 0.25]
        matches.append((row, min(near, key=lambda pair: pair[0])[1] if near else None))
    return matches


def table1_times(results):
    rows = []
    for paper, run in matches_of_paper(results):
        theirs = [paper[m + when] for when in ("_rest", "_mean")
                  for m in ("hash", "aabb", "star", "none")]
        rows.append(["%s, paper" % paper["scene"], whole(paper["triangles"])] +
                    ["%.1f" % v for v in theirs[:4]] + [""] +
                    ["%.1f" % v for v in theirs[4:]] + [""])
        if run:
            order = ("hash", "aabb-sctt", "star", "none", "exact")
            rows.append(["%s, here" % paper["scene"], whole(run["star"]["triangles"])] +
                        [figure(run[m][when]) for when in ("rest_ms", "mean_ms") for m in order])
    return table(["milliseconds", "triangles", "hash (0)", "AABB (0)", "star (0)", "none (0)",
                  "exact (0)", "hash", "AABB", "star", "none", "exact"], rows)


def table1_speed(results):
    rows = []
    for paper, run in matches_of_paper(results):
        row = ["%s %s" % (paper["scene"], whole(paper["triangles"]))]
        for when in ("_rest", "_mean"):
            for other, ours in (("hash", "hash"), ("aabb", "aabb-sctt")):
                row.append(times(paper[other + when] / paper["star" + when]))
                for method in ("star", "exact"):
                    row.append(times(run[ours][when[1:] + "_ms"] / run[method][when[1:] + "_ms"])
                               if run else "–")
        rows.append(row)
    names = ["over hash (0)", "over AABB (0)", "over hash", "over AABB"]
    return table(["scene"] + [title for name in names
                              for title in (name + ": paper", "star", "exact")], rows)


def table1_shares(results):
    rows = []
    for paper, run in matches_of_paper(results):
        name = "%s %s" % (paper["scene"], whole(paper["triangles"]))
        rows.append([name + ", paper"] + ["%.1f" % paper[task] for task in TASKS])
        for method in ("star", "exact") if run else ():
            values = [run[method][task + "_ms"] for task in TASKS]
            rows.append(["%s, %s" % (name, method)] +
                        ["%.1f" % (100.0 * v / sum(values)) for v in values])
    return table(["percent"] + TASK_TITLES, rows)


def misses(results):
    rows = []
    for (scene, triangles), run in results.main_runs().items():
        none = run["none"]
        rows.append([scene, whole(triangles), whole(none["frames"]),
                     figure(run["exact"]["mean_pairs"]), whole(run["exact"]["most_pairs"]),
                     whole(none["missed"]), whole(none["most_missed"]),
                     "%.3f" % none["missed_percent"],
                     times(run["exact"]["mean_ms"] / none["mean_ms"]),
                     times(run["star"]["mean_ms"] / none["mean_ms"])])
    return table(["scene", "triangles", "frames", "pairs, mean", "pairs, most", "missed, all frames",
                  "missed, worst frame", "missed, %", "exact ÷ none", "star ÷ none"], rows)


def floors(results):
    rows = []
    for (scene, triangles), run in results.main_runs().items():
        rows.append([scene, whole(triangles), "%.2f" % run["exact"]["floor_ns_per_triangle"]] +
                    ["%s (%s)" % (times(run[m]["rest_ms"] * 1e6 / triangles /
                                        run[m]["floor_ns_per_triangle"]),
                                  times(run[m]["times_floor"])) for m in METHODS])
    return table(["scene", "triangles", "floor, ns/triangle"] + METHODS, rows)


def slopes(results):
    """For each scene with three sizes or more, the exponent of each method's time: mean, and at rest. Sizes below
    10,000 triangles, which fit the innermost caches, count only where there are too few others."""
    sizes = collections.OrderedDict()
    for (scene, triangles), run in results.main_runs().items():
        sizes.setdefault(scene, []).append((triangles, run))
    rows, found = [], {}
    for scene, runs in sizes.items():
        if len(runs) < 3:
            continue
        runs.sort(key=lambda pair: pair[0])
        large = [pair for pair in runs if pair[0] >= 10000]
        runs = large if len(large) >= 3 else runs
        row = [scene, "%s – %s" % (whole(runs[0][0]), whole(runs[-1][0]))]
        for method in METHODS:
            exponents = []
            for when in ("mean_ms", "rest_ms"):
                x = [math.log(t) for t, _ in runs]
                y = [math.log(run[method][when]) for _, run in runs]
                mx, my = mean(x), mean(y)
                exponents.append(sum((a - mx) * (b - my) for a, b in zip(x, y)) /
                                 sum((a - mx) ** 2 for a in x))
            found[scene, method] = exponents[0]
            row.append("%.2f (%.2f)" % tuple(exponents))
        rows.append(row)
    return table(["scene", "triangles"] + METHODS, rows), found, sizes


def memory(results):
    rows, seen = [], set()
    for key, run in results.runs.items():
        any_row = next(iter(run.values()))
        if key[:3] in seen:
            continue
        seen.add(key[:3])
        t = any_row["triangles"]
        size = any_row["hash_bytes"]
        rows.append([key[0], whole(t), key[2], figure(1e6 * any_row["build_ms"] / t),
                     figure(any_row["build_ms"]), "%.0f" % (any_row["model_bytes"] / t),
                     "%.0f" % (any_row["workspace_bytes"] / t),
                     "%.0f" % (size / t) if size else "–"])
    return table(["scene", "triangles", "partition", "build, ns/triangle", "build, ms",
                  "model, bytes/triangle", "workspace, bytes/triangle", "hash, bytes/triangle"],
                 rows)


def partitions(results):
    groups = collections.OrderedDict()
    for key, run in results.runs.items():
        if key[3:] == ("edge", "once", 1.0):
            groups.setdefault(key[:2], []).append((key[2], run))
    rows = []
    for (scene, triangles), runs in groups.items():
        if len(runs) < 2:
            continue
        for partition, run in runs:
            rows.append([scene, whole(triangles), partition] +
                        ["%s (%s)" % (figure(run[m]["rest_ms"]), figure(run[m]["mean_ms"]))
                         for m in ("exact", "star", "aabb-sctt", "aabb")])
    return table(["scene", "triangles", "partition", "exact", "star", "aabb-sctt", "aabb"], rows)


def other_pairs(results):
    rows = []
    for (scene, triangles), run in results.main_runs("triangle").items():
        rows.append([scene, whole(triangles)] +
                    ["%s (%s)" % (figure(run[m]["rest_ms"]), figure(run[m]["mean_ms"]))
                     for m in METHODS])
    return table(["scene", "triangles"] + METHODS, rows)


def steps(results):
    """For each scene, what each method leaves to the narrow phase, in what time, and the whole step."""
    scenes = collections.OrderedDict()
    for row in results.steps:
        scenes.setdefault((row["scene"], row["triangles"]), {})[row["method"]] = row
    rows = [[], []]
    for (scene, triangles), run in scenes.items():
        if "step" not in run or "step-two-boxes" not in run:
            continue
        ours, boxes = run["step"], run["step-two-boxes"]
        begin = [scene, whole(triangles)]
        rows[0].append(begin + [whole(ours["collisions"])] +
                       [whole(run[m]["candidates"]) if m in run else "–" for m in STEP_METHODS] +
                       [whole(run["step-none"]["missed"]) if "step-none" in run else "–"])
        rows[1].append(begin + ["%s (%s)" % (figure(run[m]["candidates_ms"]), figure(run[m]["mean_ms"]))
                                if m in run else "–" for m in STEP_METHODS] +
                       ["%s (%s)" % (times(boxes["candidates_ms"] / ours["candidates_ms"]),
                                     times(boxes["mean_ms"] / ours["mean_ms"]))])
    if not rows[0]:
        return ""
    return table(["scene", "triangles", "collisions"] + STEP_METHODS + ["missed by none, all steps"],
                 rows[0]) + "\n" + table(["scene", "triangles"] + STEP_METHODS + ["× two boxes"], rows[1])


def peer_steps(results):
    """Candidates of peers beside those of ours, of the same steps in the same process."""
    groups = collections.OrderedDict()
    for row in results.peer_steps:
        process = (row["beside"], row["scene"], row["triangles"], row["processors"])
        groups.setdefault(process, {}).setdefault(row["peer"] == "starcontour", []).append(row)
    rows = []
    for (peer, scene, triangles, processors), both in groups.items():
        if len(both) < 2:
            continue
        theirs, ours = both[False], both[True]
        count, ms = ([mean(r[key] for r in side) for side in (theirs, ours)] for key in ("pairs", "ms"))
        wrong = sum(r["matches"] == "no" for r in theirs)
        unknown = sum(r["matches"] == "unknown" for r in theirs)
        rows.append(["%s %s" % (theirs[0]["peer"], theirs[0]["version"]), scene, whole(triangles),
                     whole(len(theirs)), whole(processors), whole(count[0]), whole(count[1]),
                     "%.2f" % (100.0 * count[1] / count[0]) if count[0] else "–",
                     figure(ms[0]), figure(ms[1]), times(ms[0] / ms[1]),
                     "%d steps lack collisions" % wrong if wrong else
                     "hold all collisions" if not unknown else
                     "hold all collisions; not looked through in %d steps" % unknown
                     if unknown < len(theirs) else "not looked through"])
    return table(["peer", "scene", "triangles", "steps", "threads", "candidates", "ours", "%", "ms",
                  "ours, ms", "× ours", "candidates of the peer"], rows, left=2) if rows else ""


def small_steps(results):
    """Steps of a part of a frame beside those of a peer: candidates, times of impact. A row for each step
    that has both sides of both."""
    groups = collections.OrderedDict()
    for row in results.peer_small_steps:
        part, asked = row["what"].split(": ")[:2]
        step = (row["beside"], row["scene"], row["triangles"], row["frame"], row["processors"], part)
        side = "ours" if row["peer"] == "starcontour" else "theirs"
        groups.setdefault(step, {})[side, asked] = row
    rows = []
    for (_, scene, triangles, frame, _, part), of in groups.items():
        begin = [scene, whole(triangles), whole(frame), part[len("step "):]]
        try:
            pairs = [whole(of["ours", "pairs at the start"]["pairs"])]
            for asked in ("candidates", "time of impact"):
                ours, theirs = of["ours", asked], of["theirs", asked]
                show = whole if asked == "candidates" else part_of_step
                pairs += [show(theirs["pairs"]), show(ours["pairs"]), figure(theirs["ms"]),
                          figure(ours["ms"]), times(theirs["ms"] / ours["ms"])]
        except KeyError:
            continue
        rows.append(begin + pairs + [verdict_of_step(of)])
    return table(["scene", "triangles", "frame", "step", "pairs at start", "candidates", "ours", "ms",
                  "ours, ms", "× ours", "free until", "ours", "ms", "ours, ms", "× ours",
                  "answers"], rows) if rows else ""


def part_of_step(value):
    """A time of impact: 1 is the end of the step."""
    return "1" if value == 1 else figure(value)


def verdict_of_step(rows):
    """What is wrong with a peer's candidates and with both times, or what was not looked at."""
    parts = []
    candidates = rows["theirs", "candidates"]
    if candidates["matches"] != "yes":
        parts.append("candidates not looked through" if candidates["matches"] == "unknown" else
                     "%s collisions not in its candidates" % whole(candidates["missing"]))
    for side, whose in (("theirs", "its"), ("ours", "our")):
        time = rows[side, "time of impact"]
        if time["matches"] != "yes":
            parts.append("%s time is %s" % (whose, "after the first contact" if time["missing"] else
                                            "less than 1 though nothing meets"))
    return "; ".join(parts) or "right"


def modes(results):
    """Repeated queries beside single ones of the same frames where the runs are as long."""
    rows = []
    for key, run in results.runs.items():
        if key[4] != "warm":
            continue
        once = results.runs.get(key[:4] + ("once",) + key[5:])
        if not once:
            continue
        same = [m for m in METHODS if m in run and m in once]
        rows.append([key[0], whole(key[1]), "rest, once"] +
                    [figure(once[m]["rest_ms"]) for m in same])
        rows.append(["", "", "rest, repeated"] + [figure(run[m]["rest_ms"]) for m in same])
    if not rows:
        return ""
    return table(["scene", "triangles", ""] + same, rows)


def threads(results):
    rows = []
    for key, run in results.runs.items():
        if key[5] == 1:
            continue
        single = results.runs.get(key[:5] + (1.0,))
        for method in run:
            rows.append([key[0], whole(key[1]), method, whole(key[5]),
                         figure(run[method]["rest_ms"]),
                         figure(single[method]["rest_ms"]) if single else "–",
                         figure(run[method]["mean_ms"])])
    return table(["scene", "triangles", "method", "threads", "rest, ms a frame",
                  "rest on one thread", "mean, ms a frame"], rows) if rows else ""


class PeerRun:
    """A peer's way beside ours: frames of one process, on one scene."""

    def __init__(self, rows, ours):
        self.rows = rows
        self.ms = mean(r["ms"] for r in rows)
        self.exact_ms = mean(r["ms"] for r in ours) if ours else None
        self.ratio = self.ms / self.exact_ms if ours else None
        self.pairs = mean(r["pairs"] for r in ours)

    def verdict(self):
        """Whether answers match in all frames, or what is wrong in how many."""
        wrong = [r for r in self.rows if r["matches"] != "yes"]
        if not wrong:
            return "match"
        parts = ["%s %s" % (whole(sum(r[key] for r in wrong)), key)
                 for key in ("missing", "extra") if any(r[key] for r in wrong)]
        return "%s in %d of %d frames" % (", ".join(parts), len(wrong), len(self.rows))


def peer_runs(results):
    """By (peer, version, what), then (scene, triangles), then processors of the process: its runs. Only rows
    of the same process are set beside each other."""
    groups, ours = collections.OrderedDict(), {}
    for row in results.peers:
        scene = (row["scene"], row["triangles"])
        process = (row["beside"], scene, row["processors"])
        if row["peer"] == "starcontour":
            if row["what"] == "exact":
                ours.setdefault(process, {})[row["frame"]] = row
            continue
        way = (row["peer"], str(row["version"]), row["what"])
        groups.setdefault(way, collections.OrderedDict()).setdefault(scene, {}).setdefault(
            process, {})[row["frame"]] = row
    for scenes in groups.values():
        for scene, processes in scenes.items():
            scenes[scene] = {process[2]: PeerRun(list(rows.values()),
                                                 list(ours.get(process, {}).values()))
                             for process, rows in processes.items()}
    return groups


def span(values):
    """The least and the greatest."""
    low, high = (times(f(values)) for f in (min, max)) if values else ("–", "–")
    return low if low == high else "%s – %s" % (low, high)


def peers_overview(groups):
    rows = []
    for (peer, version, what), scenes in groups.items():
        runs = [run for processes in scenes.values() for run in processes.values()]
        ratios = [[run.ratio for processes in scenes.values() for count, run in processes.items()
                   if (count == 1) == single and run.ratio] for single in (True, False)]
        good = sum(run.verdict() == "match" for run in runs)
        rows.append(["%s %s" % (peer, version), what, whole(len(scenes)), span(ratios[0]),
                     span(ratios[1]), "match" if good == len(runs) else
                     "match in %d of %d runs" % (good, len(runs))])
    return table(["peer", "what it does a frame", "scenes", "1 thread: × exact",
                  "all threads: × exact", "pairs"], rows, left=2)


def peers_details(groups):
    """A table for each way of a peer, a row for each scene."""
    out = []
    for (peer, version, what), scenes in groups.items():
        rows = []
        for (scene, triangles), processes in scenes.items():
            single = processes.get(1)
            several = processes.get(max(processes)) if max(processes) > 1 else None
            both = [run for run in (single, several) if run]
            row = [scene, whole(triangles), whole(len(both[0].rows)),
                   whole(both[0].pairs)]
            for run in (single, several):
                row += [figure(run.ms), figure(run.exact_ms), times(run.ratio)] if run else ["–"] * 3
            verdicts = list(collections.OrderedDict.fromkeys(run.verdict() for run in both))
            rows.append(row + ["; ".join(verdicts)])
        count = max(max(processes) for processes in scenes.values())
        several = "%d threads" % count if count > 1 else "all threads"
        out.append("**%s %s**, %s.\n" % (peer, version, what))
        out.append(table(["scene", "triangles", "frames", "pairs, mean", "1 thread: ms", "exact, ms",
                          "× exact", several + ": ms", "exact, ms", "× exact", "pairs"], rows))
    return "\n".join(out)


def peers_absent(results, groups):
    """What was not measured, and why."""
    measured = {peer for peer, _, _ in groups}
    lines = list(collections.OrderedDict.fromkeys(results.peers_skipped))
    said = {line.split(":")[0] for line in lines}
    lines += ["%s: no results; `make peers` said why" % peer for peer in PEERS
              if peer not in measured and
              not any(name == peer or name.startswith(peer + " on ") for name in said)]
    return "".join("- %s\n" % line for line in lines)


# ---------------------------------------------------------------------------------------------------
# Plots

def draw_figures(pyplot, results, folder):
    """The plots, by name. Pictures of scenes are those that are in folder."""
    _, found, sizes = slopes(results)
    pictures = {scene: report_pictures.load(pyplot, folder, scene, triangles, frame)
                for scene, triangles, _, frame in report_plots.wanted_pictures(results.frames)}
    plots = (("frames", report_plots.draw_frames(pyplot, results, pictures)),
             ("scaling", report_plots.draw_scaling(pyplot, results, found, sizes, pictures)),
             ("near", report_near.draw(pyplot, results.near, results.near_peers, pictures)))
    return collections.OrderedDict((name, plot) for name, plot in plots if plot)


def draw_all(results, folder, programs, scenes):
    """The names of the plots that were drawn; none without matplotlib. programs: a folder with sc-bench and
    sc-query, which make the pictures of scenes anew; without it those are taken that are there."""
    pyplot = report_plots.import_pyplot()
    if not pyplot:
        print("draw_report.py: matplotlib is not there: plots are skipped "
              "('make deps with=bench')", file=sys.stderr)
        return []
    if programs:
        report_pictures.make_all(pyplot, programs, scenes, folder, report_plots.wanted_pictures(results.frames))
    plots = draw_figures(pyplot, results, folder)
    for name, plot in plots.items():
        report_plots.save(plot, folder, name)
        pyplot.close(plot)
    return list(plots)


# ---------------------------------------------------------------------------------------------------
# The report

def add_targets(out, results):
    """The sections that compare the library with itself, but for heavy contact and one shot, which have peers."""
    out.append("## Contour test\n")
    out.append("`exact` beside `none`, which has no contour test; then at rest: the edges of contours that it looked\n"
               "at, and its time by clocks that take time themselves (update contours and contour).\n")
    out.append(targets.contour_test(results.main_runs(), results.turns))
    sections = (
        ("Threads of one query", "One thread and all, in turn in each frame, in every other pass the other way round, as the second finds\n"
         "what it reads of the model in the caches; *least* and *most*: of single frames.\n",
         targets.threads_of_query(results.turns)),
        ("Instructions", "*Speed*: as a part of that with the best instructions, in turn in each frame. *Base* is SSE2 on\n"
         "x86-64.\n", targets.instructions(results.turns)),
        ("Compilers", "*Ours* is the library as everything else here; *plain* is plain C99 without any instruction set's\n"
         "own functions. Processes of each in turn; the least times of each frame.\n",
         targets.built_by(results.built)),
    )
    for title, text, rows in sections:
        if rows:
            out.extend(["## %s\n" % title, text, rows])
    ours, theirs = targets.heavy_contact(results.turns, results.peers)
    if ours:
        out.append("## Heavy contact\n")
        out.append("Frames with %s near pairs and more: pairs of triangles that share no vertex and whose boxes\n"
                   "overlap.\n" % whole(targets.HEAVY))
        out.append(ours)
    if theirs:
        out.append("Other libraries on the same frames, pairs of triangles, one thread:\n")
        out.append(theirs)
    rows = targets.builds(results.shots)
    if rows:
        out.append("## Builds and single queries from nothing\n")
        out.append("Memory is that with the built-in partition; then that of a model for boxes alone (`SC_MODEL_BOXES`).\n"
                   "*One shot*: build, workspace, one query of the first frame, and freeing them, by boxes alone.\n")
        out.append(rows)
    rows = targets.one_shot_of_peers(results.peers)
    if rows:
        out.append("Beside libraries that make everything anew for each pose, on the same mesh in one process: their\n"
                   "first frame, without what they make of its topology.\n")
        out.append(rows)
    rows = targets.peers_compact(results.peers)
    if rows:
        out.append("## Other libraries, in short\n")
        out.append("How many times as fast `exact` is, one thread, pairs of triangles, built-in partition; the section\n"
                   "on peers below has more.\n")
        out.append(rows)


def add_near(out, results, drawn):
    """What is within a distance, if it was measured."""
    own, beside = report_near.own_table(results.near), report_near.peer_table(results.near_peers)
    if not own and not beside:
        return
    out.append("## What is near\n")
    if own:
        out.append("Pairs of a vertex and a face, and of two edges, within a distance in median *edges* of the first\n"
                   "frame; nothing left out, one thread, one query a frame. `near` sorts its pairs; *counted* lists\n"
                   "none. How many times as fast it is as the plain tree of *boxes* with the same distances, a step\n"
                   "that stands *still*, and such a step by *inflated* boxes; milliseconds of all frames.%s\n"
                   % ("" if results.near_commit == results.description["commit"] else
                      "\nMeasured alone, at commit %s." % results.near_commit))
        if min(row["cpu_share"] for row in results.near) < 0.95:
            out.append("**Disturbed**: some of these runs had less than 95 % of a processor.\n")
        out.append(own)
    if "near" in drawn:
        out.append("![What a pair costs, and how many times as long others take](near.svg)\n")
    if beside:
        out.append("Beside ipc-toolkit, in one process, taking turns: LBVH candidates with inflated boxes, and\n"
                   "`NormalCollisions`, which also tells distances and merges. *Merged*: `near`, stencils of all\n"
                   "pairs, and `sc_near_merge`, which is as much. *Pairs*: ours against its candidates that are near;\n"
                   "*features* of the merged ones differ where several are as close. Made by `make near-peers`; see\n"
                   "bench/peers/README.md.\n")
        out.append(beside)
    out.append("What is to be reached, and the worst figure of the scenes that are measured:\n")
    out.append(report_near.goals(results.near, results.near_peers))


def report(results, drawn, slope_table, reading):
    d = results.description
    missing_plot = "(not drawn: matplotlib was not there)\n"
    out = []
    out.append("# Measurements on %s, %s cores\n" % (d["cpu"], d["cores"]))
    out.append("Made by `%s` in %s s at commit %s. Compiler: %s; flags: `%s`.\n" % (
        d["command"], d["seconds"], d["commit"], d["compiler"], d["flags"]))
    shares = [row["cpu_share"] for row in results.rows if row["threads"] == 1]
    if min(shares) < 0.95:
        out.append("**Disturbed**: other programs ran at the same time. The timed queries had %.0f %% of\n"
                   "a processor on the whole, and %.0f %% in the worst run; a quiet machine gives 99.\n"
                   "Single times can be far too long.\n" % (100 * mean(shares), 100 * min(shares)))
    out.append(
        "If not said otherwise: one thread, one query a frame in sequence, the methods in turn in each\n"
        "frame (`sc-bench --once`), the median of several passes over the animation; pairs of an edge\n"
        "and a triangle, touching ones included, as in the paper; models as `sc_build` makes them by\n"
        "default, with the built-in partition. Milliseconds. *Rest*, or (0), is the first frame, *mean* all of them. All methods\n"
        "but `none` found the same pairs in every frame: sc-bench fails otherwise. What the columns say is\n"
        "read in [bench/REPORT.md](%s); `summary.csv` holds the figures below.\n" % reading)
    if d["skipped"] != "nothing":
        out.append("**Not measured**, see what `%s` said: %s.\n" % (d["command"], d["skipped"]))
    out.append("## Overview\n")
    out.append("Milliseconds a frame, mean over the animation; then how many times as fast `exact` is as\n"
               "the other. *Worst frame*: the least of all frames, by the least times of both. *Embree* (tree refitted)\n"
               "and *CGAL* are measured in processes of their own, beside `exact` on six frames, triangle pairs.\n")
    out.append(overview(results))
    add_targets(out, results)
    out.append("## The paper's Table 1\n")
    out.append("Upper part: milliseconds. AABB is the paper's optimised form (`aabb-sctt`). The paper's\n"
               "processor is an Intel Core 2 Quad at 2.4 GHz.\n")
    out.append(table1_times(results))
    out.append("Speed-ups: how many times as fast as the hash, and as the optimised AABB tree.\n")
    out.append(table1_speed(results))
    out.append("Lower part: share of the nine tasks, in percent of their sum. (o.): after a failed\n"
               "orientation test; (c.): after a failed contour test.\n")
    out.append(table1_shares(results))
    out.append("## Figure 8: over the animation\n")
    out.append("![Milliseconds over frames](frames.svg)\n" if "frames" in drawn else missing_plot)
    out.append("## Resolution\n")
    out.append("Slope of mean time over triangles, both logarithmic, by least squares: 1 is linear. In brackets\n"
               "the same at rest. From 10,000 triangles on where there are three sizes of that.\n")
    out.append(slope_table)
    if "scaling" in drawn:
        out.append("![Time over resolution](scaling.svg)\n")
    out.append("## Without the contour test\n")
    out.append("Pairs that `none` misses, and what it gains.\n")
    out.append(misses(results))
    out.append("## Multiples of the physical floor\n")
    out.append("One vectorised pass over positions and indices; methods at rest, in brackets the mean.\n")
    out.append(floors(results))
    out.append("## Partitions\n")
    out.append("Rest, in brackets the mean over the frames of that run.\n")
    out.append(partitions(results))
    out.append("## Pairs of triangles\n")
    out.append("What the library reports unless told otherwise. Rest, in brackets the mean.\n")
    out.append(other_pairs(results))
    step_tables, peer_table = steps(results), peer_steps(results)
    if step_tables:
        out.append("## Steps\n")
        out.append("From each frame to the next, over the whole animation: means over the steps. Pairs of a vertex\n"
                   "and a face, and of two edges: collisions, and the candidates that each method leaves to the\n"
                   "narrow phase. `step-none` has no contour test and misses collisions.\n")
        parts = step_tables.split("\n\n")
        out.append(parts[0] + "\n")
        out.append("Milliseconds: candidates alone, in brackets the whole step; then how many times as fast\n"
                   "`step` is as two boxes.\n")
        out.append(parts[1])
    if peer_table:
        out.append("Candidates of other libraries on steps, in one process with ours, taking turns; made by\n"
                   "`make peers` at commit %s. *%%*: ours as a part of theirs. Ours runs on one thread.\n" %
                   results.peers_commit)
        out.append(peer_table)
    small = small_steps(results)
    if small:
        out.append("### Steps beside ipc-toolkit\n")
        out.append("From a frame a part of the way to the next of all 60, both on one thread in one process,\n"
                   "taking turns; made by `make peers` at commit %s. Candidates: trees of boxes rebuilt\n"
                   "(`Candidates.build`, LBVH) beside `SC_STEP_CANDIDATES`. *Free until*: the largest part of the\n"
                   "step known to be free, 1 if all of it (`compute_collision_free_stepsize` with tight inclusion,\n"
                   "beside `SC_OUTPUT_ANY` with `SC_STEP_TIMES_EARLIEST`); milliseconds include the candidates.\n"
                   "*Answers* are right if the candidates hold all collisions and no time is after the first\n"
                   "contact. Both stop a little early: ours where a pair is within a millionth of the mesh's\n"
                   "size. Frames with *pairs at start*, of triangles that meet, are in contact already, in which\n"
                   "a simulation that keeps meshes apart would not begin a step.\n" % results.peers_commit)
        out.append(small)
        absent = "".join("- %s\n" % line for line in results.small_steps_skipped)
        if absent:
            out.append("Left out:\n\n" + absent)
    add_near(out, results, drawn)
    out += report_trace.section(results.trace_peers)
    objects, beside = report_objects.own_table(results.objects), report_objects.peer_section(results.objects_peers)
    if objects or beside:
        out.append("## Several objects\n")
    if objects:
        out.append("Milliseconds a frame, least of several rounds in turns. *Objects*: one call about all of them.\n"
                   "*Cut*: the same, where of what does not move no more is there than what comes near the rest.\n"
                   "*One mesh*: of all objects, with groups of vertices where one is not asked about itself.\n"
                   "*Each alone*: those that are, in a call each, without what is between two. "
                   + "; ".join("*%s*: %s" % item for item in report_objects.SCENES.items()) + ".\n")
        out.append(objects)
        target = report_objects.target_table(results.objects)
        if target:
            out.append("What is to be reached:\n")
            out.append(target)
    out += beside
    peers, skipped, commit = results.dataset_peers
    out += report_dataset.section(results.dataset, peers, commit, skipped)
    out += report_wasm.section(results.wasm[0], results.wasm[2])
    out.append("## One query a frame, and repeated queries\n")
    out.append("The same frame asked for again and again, which favours what fits the cache.\n")
    out.append(modes(results))
    out.append("## Several threads\n")
    out.append("Throughput: as many frames at once as there are threads, wall time divided by them.\n"
               "Each query runs on one thread.\n")
    out.append(threads(results))
    out.append("## Peers\n")
    if results.peers:
        groups = peer_runs(results)
        out.append("Other libraries beside `exact`, each in a process with it, taking turns on the same\n"
                   "frames: made by `make peers` at commit %s and explained in bench/peers/README.md.\n"
                   "Pairs of triangles; built-in partition; doubles, floats beside MeshLib. Milliseconds are\n"
                   "means over the frames; *× exact* is the peer's time divided by that of `exact` in the same\n"
                   "process, which runs on one thread even where the peer has all, and finds all pairs even where\n"
                   "the peer answers yes or no and stops at the first. *Pairs*: whether answers\n"
                   "match, as far as they are compared (see there). `peers.csv` has `star` and `aabb` too.\n" %
                   results.peers_commit)
        exact = [r for r in results.peers if r["what"] == "exact"]
        spread = sum(r["ms"] for r in exact) / sum(r["ms_min"] for r in exact)
        if spread > 1.2:
            out.append("**Disturbed**: the medians of `exact` are %.1f times its minima, so other programs\n"
                       "ran at the same time. Single figures can be far off, those of several threads most.\n"
                       % spread)
        out.append("Least and greatest *× exact* over the scenes:\n")
        out.append(peers_overview(groups))
        out.append(peers_details(groups))
        absent = peers_absent(results, groups)
    else:
        out.append("Not measured: `make peers bench` measures them as well, `make peers bench-report` adds\n"
                   "them to what is here.\n")
        absent = "".join("- %s\n" % line for line in results.peers_skipped)
    if absent:
        out.append("Left out:\n\n" + absent)
    out.append("## Memory and build time\n")
    out.append(memory(results))
    return "\n".join(out)


def update_readme(path, results, folder):
    """Puts the overview and the plot of methods over frames between README.md's two marks."""
    begin, end = "<!-- made by make bench -->\n", "<!-- end -->\n"
    with open(path, encoding="utf-8") as file:
        text = file.read()
    before, found, rest = text.partition(begin)
    _, closed, after = rest.partition(end)
    if not found or not closed:
        sys.exit("draw_report.py: %s has no marks to put the overview between" % path)
    d = results.description
    shown = os.path.relpath(folder, os.path.dirname(os.path.abspath(path)))
    plot = ""
    if os.path.exists(os.path.join(folder, "frames.png")):
        plot = "![Milliseconds over frames](%s/frames.png)\n\n" % shown
    text = "%s%s%s\nBy `%s` at commit %s on %s, %s cores; all tables: `%s/report.md`.\n%s" % (
        begin, plot, overview(results), d["command"], d["commit"], d["cpu"], d["cores"], shown, end)
    with open(path, "w", encoding="utf-8") as file:
        file.write(before + text + after)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--command", default="make bench")
    parser.add_argument("--seconds", default="?", help="how long it took")
    parser.add_argument("--readme", help="a README.md to put the overview into")
    parser.add_argument("--programs", help="a folder with sc-bench and sc-query: make pictures of the scenes anew")
    parser.add_argument("--scenes", default="build/scenes", help="where sc-bench keeps them")
    parser.add_argument("results")
    parser.add_argument("raw", nargs="?")
    arguments = parser.parse_args()
    if arguments.raw:
        collect(arguments.raw, arguments.results, arguments.command, arguments.seconds)
    if not os.path.exists(os.path.join(arguments.results, "summary.csv")):
        sys.exit("draw_report.py: no summary.csv in %s: run 'make bench' first" % arguments.results)
    results = Results(arguments.results)
    drawn = draw_all(results, arguments.results, arguments.programs, arguments.scenes)
    with open(os.path.join(arguments.results, "report.md"), "w", encoding="utf-8") as file:
        file.write(report(results, drawn, slopes(results)[0],
                          os.path.relpath(os.path.join(HERE, "REPORT.md"), arguments.results)))
    if arguments.readme:
        update_readme(arguments.readme, results, arguments.results)
    print("report: " + os.path.join(arguments.results, "report.md"))


if __name__ == "__main__":
    main()

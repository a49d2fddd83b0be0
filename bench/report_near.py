"""What is within a distance, for the reports that draw_report.py makes: tables, a plot, and what is to be reached.

near.csv has a line a frame and method of sc-bench --pairs near; near_peers.csv is what bench/peers/near.py wrote.
A table without rows is "".

SPDX-License-Identifier: MIT
"""

import collections

from report_plots import NO_PICTURES, band, format_axis, legend_above, show_picture
from report_text import figure, ratio, table, times, whole

NEAR = ["scene", "triangles", "partition", "workers", "edges", "ignore_rings", "frame", "method", "ms", "ms_min",
        "pairs", "missed", "extra", "cpu_share", "ms_max"]

METHODS = ["near", "near-count", "near-boxes", "near-still", "near-inflated"]

STYLES = {"near": ("#0072B2", "o", "-"), "near-count": ("#009E73", "s", "-"), "near-boxes": ("#D55E00", "v", "--"),
          "near-still": ("#E69F00", "^", "--"), "near-inflated": ("#999999", "x", ":"),
          "NormalCollisions": ("#CC79A7", "d", "-."), "Candidates": ("#56B4E9", "+", "-.")}

# From so many pairs a frame on, the price is that of pairs and not of what is culled.
BULK = 50000

# Scenes whose mesh has a border; others are closed.
CLOTHS = ("twisted-cloth", "cloth-sphere", "wrinkled-cloth", "crushed-cloth")


# Where a run has these alone, they are taken from it, as bench/run_bench.sh says why.
ALONE = {"near", "near-count", "near-boxes"}


def collect(runs):
    """runs: description and records of each run of sc-bench --pairs near."""
    def asked(d):
        return d["scene"], d["triangles"], d["workers"], d["distance_edges"], d["ignore_rings"]

    def is_alone(records):
        return {r["method"] for r in records} == ALONE

    alone = {asked(d) for d, records in runs if is_alone(records)}
    return [{"scene": d["scene"], "triangles": d["triangles"], "partition": d["partition"], "workers": d["workers"],
             "edges": d["distance_edges"], "ignore_rings": d["ignore_rings"], "frame": r["frame"],
             "method": r["method"], "ms": r["ms"], "ms_min": r["ms_min"], "pairs": r["pairs"],
             "missed": r["missed"], "extra": r["extra"], "cpu_share": d["cpu_share"],
             "ms_max": r.get("ms_max")} for d, r in
            ((d, r) for d, records in runs for r in records
             if is_alone(records) or r["method"] not in ALONE or asked(d) not in alone)]


def total(rows, key):
    return sum(row[key] for row in rows)


def by_method(rows):
    methods = collections.OrderedDict()
    for row in rows:
        methods.setdefault(row["method"], []).append(row)
    return methods


def main_runs(rows):
    """One worker, no rings, all methods: (scene, triangles, edges): rows by method."""
    runs = collections.OrderedDict()
    for row in rows:
        if row["workers"] == 1 and row["ignore_rings"] == 0:
            runs.setdefault((row["scene"], row["triangles"], row["edges"]), []).append(row)
    runs = {key: by_method(run) for key, run in runs.items()}
    return {key: run for key, run in runs.items() if all(m in run for m in METHODS)}


def peer_runs(peers):
    """(scene, triangles, edges): rows by what was asked."""
    runs = collections.OrderedDict()
    for row in peers:
        runs.setdefault((row["scene"], row["triangles"], row["edges"]), {}).setdefault(
            row["what"], []).append(row)
    return runs


def per_pair(rows):
    """Nanoseconds a pair over all frames, or None."""
    pairs = total(rows, "pairs")
    return 1e6 * total(rows, "ms") / pairs if pairs else None


def own_table(rows):
    """Each scene and distance: pairs, what one costs, how many times as fast as the other ways, and the worst frame."""
    lines = []
    for (scene, triangles, edges), run in main_runs(rows).items():
        ours, boxes = run["near"], run["near-boxes"]
        lines.append([scene, whole(triangles), figure(edges, 2), whole(total(ours, "pairs") / len(ours)),
                      figure(total(ours, "ms") / len(ours)), figure(per_pair(ours)), figure(per_pair(run["near-count"]))] +
                     [ratio(total(run[m], "ms"), total(ours, "ms"))
                      for m in ("near-boxes", "near-still", "near-inflated")] +
                     [ratio(boxes[0]["ms"], ours[0]["ms"]),
                      times(min(b["ms_min"] / o["ms_min"] for b, o in zip(boxes, ours)))])
    return table(["scene", "triangles", "edges", "pairs a frame", "near, ms", "ns a pair", "counted, ns a pair",
                  "× boxes", "× still", "× inflated", "first frame: × boxes", "worst frame: × boxes"],
                 lines) if lines else ""


def peer_table(peers):
    """Beside ipc-toolkit: candidates and collisions."""
    lines = []
    for (scene, triangles, edges), run in peer_runs(peers).items():
        if "NormalCollisions" not in run:
            continue
        ours, theirs = run["near"], run["NormalCollisions"]
        judged = [r for r in run["Candidates"] if r["missing"] is not None]
        wrong = total(judged, "missing") + total(judged, "extra")
        other = [r for r in theirs if r["missing"] is not None]
        lines.append([scene, whole(triangles), figure(edges, 2), whole(total(ours, "pairs") / len(ours))] +
                     [figure(total(run[what], "ms") / len(run[what]))
                      for what in ("near", "near; merged", "Candidates", "NormalCollisions")] +
                     [ratio(total(run["Candidates"], "ms"), total(ours, "ms")),
                      ratio(total(theirs, "ms"), total(ours, "ms")),
                      ratio(total(theirs, "ms"), total(run["near; merged"], "ms")),
                      "%d wrong" % wrong if wrong else "right" if judged else "not compared",
                      "%s and %s of %s" % (whole(total(other, "missing")), whole(total(other, "extra")),
                                           whole(total(other, "pairs"))) if other else "–"])
    return table(["scene", "triangles", "edges", "pairs a frame", "near, ms", "merged, ms", "Candidates, ms",
                  "NormalCollisions, ms", "Candidates ÷ near", "NormalCollisions ÷ near", "÷ merged", "pairs",
                  "features missing, extra"], lines) if lines else ""


# ---------------------------------------------------------------------------------------------------
# What is to be reached


def goal(name, wanted, values, most):
    """A line: the worst of values, of which each has a number and where it was measured. most: the number is to be
    at most what is wanted, else at least."""
    values = [(value, where) for value, where in values if value is not None]
    sign = "≤" if most else "≥"
    if not values:
        return [name, "%s %s" % (sign, figure(wanted)), "–", "–", "not measured"]
    worst, where = (max if most else min)(values)
    met = worst <= wanted if most else worst >= wanted
    return [name, "%s %s" % (sign, figure(wanted)), figure(worst), where, "met" if met else "**not met**"]


def quotient(rows, divisor):
    low = total(divisor, "ms")
    return total(rows, "ms") / low if low else None


def goals(rows, peers):
    """Targets, the worst figure of all scenes that each is about, and whether it is met."""
    runs, beside, lines = main_runs(rows), peer_runs(peers), []

    def over(fits, value):
        return [(value(run), "%s, %s edges" % (key[0], figure(key[2], 2))) for key, run in runs.items() if fits(key, run)]

    def bulk(key, run):
        return key[2] >= 1 and total(run["near"], "pairs") >= BULK * len(run["near"])

    lines.append(goal("1 edge and more, counted: ns a pair", 20, over(bulk, lambda run: per_pair(run["near-count"])), True))
    lines.append(goal("the same, sorted", 40, over(bulk, lambda run: per_pair(run["near"])), True))
    for least, below, wanted in ((1, 1e9, 12), (0.5, 1, 6), (0.2, 0.5, 3), (0.05, 0.2, 2)):
        lines.append(goal("%s edges%s: × a step that does not move" % (figure(least, 2), " and more" if least == 1 else ""),
                          wanted, over(lambda key, _, l=least, b=below: l <= key[2] < b,
                                       lambda run: quotient(run["near-still"], run["near"])), False))
    rings = collections.OrderedDict()
    for row in rows:
        if (row["scene"], row["triangles"], row["edges"], row["ignore_rings"], row["workers"], row["method"]) == \
                ("twisted-cloth", 65536, 1, 4, 1, "near"):
            rings[row["frame"]] = row["ms"]
    middle = sorted(rings)[len(rings) // 2] if rings else None
    lines.append(goal("twisted cloth, 65,536 triangles, 1 edge, 4 rings left out by masks, middle frame: ms", 6,
                      [(rings[middle], "frame %d" % middle)] if rings else [], True))
    for edges, wanted in ((0.05, 8), (0.2, 15), (0.5, 20), (1, 30)):
        found = [(quotient(run["NormalCollisions"], run["near"]), "%s, %s" % (key[0], whole(key[1])))
                 for key, run in beside.items()
                 if key[0] == "crushed-cloth" and key[2] == edges and "NormalCollisions" in run]
        lines.append(goal("crushed cloth, %s edges: × NormalCollisions" % figure(edges, 2), wanted, found, False))
    empty = []
    for key, run in beside.items():
        for ours, theirs in zip(run.get("near", []), run.get("NormalCollisions", [])):
            if ours["pairs"] < key[1] / 1000:
                empty.append((theirs["ms"] / ours["ms"], "%s, %s, %s edges, frame %d" %
                              (key[0], whole(key[1]), figure(key[2], 2), ours["frame"])))
    lines.append(goal("next to nothing near: × NormalCollisions", 100, empty, False))
    for name, wanted, is_cloth in (("cloth", 8, True), ("closed meshes", 4, False)):
        lines.append(goal("%s at rest, 0.2 edges: × boxes" % name, wanted,
                          over(lambda key, _, c=is_cloth: key[2] == 0.2 and (key[0] in CLOTHS) == c,
                               lambda run: run["near-boxes"][0]["ms"] / run["near"][0]["ms"]), False))
    lines.append(goal("any frame: × boxes, least times", 0.95,
                      over(lambda key, run: True,
                           lambda run: min(b["ms_min"] / o["ms_min"]
                                           for b, o in zip(run["near-boxes"], run["near"]))), False))
    lines.append(goal("AVX2 ÷ AVX-512", 2.2, compared(rows, "near@avx2", "near@avx512"), True))
    lines.append(goal("two workers: speed-up", 1.8, compared(
        [row for row in rows if row["workers"] == 2], "near@serial", "near"), False))
    return table(["what", "wanted", "worst", "where", ""], lines, left=1) if runs or beside else ""


def compared(rows, above, below):
    """Quotients of two methods of one run."""
    runs = collections.OrderedDict()
    for row in rows:
        key = row["scene"], row["edges"], row["ignore_rings"], row["workers"]
        runs.setdefault(key, {}).setdefault(row["method"], []).append(row)
    return [(quotient(run[above], run[below]), "%s, %s edges" % (key[0], figure(key[1], 2)))
            for key, run in runs.items() if above in run and below in run]


# ---------------------------------------------------------------------------------------------------
# The plot


def bounds(rows, divisor=None):
    """Least and greatest nanoseconds a pair by the spread of the repeats, or, of two methods, quotients: the least
    times of one over the greatest of the other, and the other way round. (None, None) where they are not known."""
    if any(row.get("ms_max") is None for row in rows + (divisor or [])):
        return None, None
    if divisor:
        return (total(rows, "ms_min") / total(divisor, "ms_max"), total(rows, "ms_max") / total(divisor, "ms_min"))
    pairs = total(rows, "pairs")
    return tuple(1e6 * total(rows, key) / pairs if pairs else None for key in ("ms_min", "ms_max"))


def draw(pyplot, rows, peers, pictures):
    """Of each scene above what a pair costs by each method, below how many times as fast near is; or None. On top
    the scene's picture, if pictures has it: at some size, in the frame where most meets."""
    scenes = collections.OrderedDict()
    for (scene, triangles, edges), run in main_runs(rows).items():
        scenes.setdefault((scene, triangles), {})[edges] = run
    beside = peer_runs(peers)
    scenes = {key: found for key, found in scenes.items() if len(found) >= 2}
    if not scenes:
        return None
    has_pictures = any(pictures.get(scene) is not None for scene, _ in scenes)
    top = 1.3 if has_pictures else 0
    width = max(3.6 * len(scenes) + 0.4, 8)
    plot = pyplot.figure(figsize=(width, 7 + top))
    cells = plot.add_gridspec(3 if has_pictures else 2, len(scenes),
                              height_ratios=[top, 2.8, 2.8] if has_pictures else None)
    has_bands, named = False, {}
    for column, ((scene, triangles), found) in enumerate(scenes.items()):
        pairs_axis, ratio_axis = (plot.add_subplot(cells[line - 2, column]) for line in (0, 1))
        if has_pictures:
            show_picture(plot.add_subplot(cells[0, column]), pictures.get(scene))
        runs = sorted(found.items())
        for method in METHODS:
            has_bands |= line(pairs_axis, method, [(edges, per_pair(run[method])) + bounds(run[method])
                                                   for edges, run in runs])
            if method != "near":
                has_bands |= line(ratio_axis, method, [
                    (edges, quotient(run[method], run["near"])) + bounds(run[method], run["near"])
                    for edges, run in runs])
        for what in ("Candidates", "NormalCollisions"):
            line(ratio_axis, what, [(key[2], quotient(run[what], run["near"]), None, None)
                                    for key, run in sorted(beside.items(), key=lambda item: item[0][2])
                                    if key[:2] == (scene, triangles) and what in run])
        pairs_axis.set_title("%s, %s" % (scene, whole(triangles)), fontsize=9)
        pairs_axis.set_ylabel("ns a pair", fontsize=8)
        ratio_axis.set_ylabel("time ÷ that of near", fontsize=8)
        ratio_axis.set_xlabel("distance, median edges", fontsize=8)
        ratio_axis.axhline(1, color="#0072B2", linewidth=0.8)
        for axis in (pairs_axis, ratio_axis):
            axis.set_xscale("log")
            axis.set_yscale("log")
            format_axis(axis)
            named.update(zip(*reversed(axis.get_legend_handles_labels())))
    said = "What a pair costs, and how many times as long as near others take."
    if has_bands:
        said += (" Lines: medians of the passes.\nBands: from the least to the greatest; of quotients, from the least"
                 " over the greatest to the greatest over the least.")
    if has_pictures:
        said += "\nPictures: the frame of the animation with the most pairs, faces that collide red, contacts dark."
    else:
        said += "\n" + NO_PICTURES
    legend_above(plot, named, said)
    return plot


def line(axis, name, points):
    """points: x, y and the least and the greatest y, or None; whether there is a band."""
    points = [point for point in points if point[1] is not None]
    if not points:
        return False
    color, marker, style = STYLES[name]
    x, y, low, high = zip(*points)
    axis.plot(x, y, color=color, marker=marker, linestyle=style, markersize=4, linewidth=1.3, label=name)
    return band(axis, x, low, high, color)

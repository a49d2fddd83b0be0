"""Tables of what the library is to reach: contour test, threads, instructions, heavy contact, builds, other libraries.

draw_report.py reads the files and puts the tables into the report; REPORT.md says what the columns mean. Rows are
dictionaries, by the columns of the CSV files below. A table without rows is "".

SPDX-License-Identifier: MIT
"""

import collections

from report_text import figure, mean, ratio, table, times, whole

# A line a frame and method of runs that compare instructions, threads of one query, or count near
# pairs.
TURNS = ["what", "scene", "triangles", "partition", "workers", "frame", "method", "ms", "ms_min",
         "pairs", "near_pairs"]

# A line a method of one query from nothing.
SHOTS = ["scene", "triangles", "partition", "method", "repeats", "build_ms", "workspace_ms",
         "query_ms", "total_ms", "pairs", "model_bytes", "workspace_bytes", "peak_bytes"]

# A line a frame and method of the library as it was compiled by: the least of all rounds.
BUILT = ["by", "compiler", "scene", "triangles", "partition", "frame", "method", "ms_min"]

# From so many near pairs on, contact is heavy.
HEAVY = 500000


def grouped(rows, *keys):
    """Lists of rows with the same values of these keys, in order."""
    groups = collections.OrderedDict()
    for row in rows:
        groups.setdefault(tuple(row[key] for key in keys), []).append(row)
    return groups


def by_method(rows, key):
    """Values of each method, frame by frame."""
    methods = collections.OrderedDict()
    for row in rows:
        methods.setdefault(row["method"], {})[row["frame"]] = row[key]
    return methods


# ---------------------------------------------------------------------------------------------------
# From sc-bench's records

def kind_of_turns(description, records):
    """What a run compares that is no main run, or None."""
    methods = {r["method"] for r in records}
    if description["workers"] > 1:
        return "threads"
    if records[0]["near_pairs"] is not None:
        return "contact"
    if description["mode"] == "once" and methods in ({"exact", "none"}, {"exact", "aabb"}):
        return "boxes" if "aabb" in methods else "contour"
    return "instructions" if any("@" in method for method in methods) else None


def collect_turns(description, records):
    what = kind_of_turns(description, records)
    return [dict({key: r.get(key) for key in TURNS}, what=what, workers=description["workers"],
                 partition=description["partition"]) for r in records]


def collect_built(runs):
    """runs: name, description and records of each round. The least time of each frame and method."""
    least = collections.OrderedDict()
    for by, d, records in runs:
        for r in records:
            key = (by, d["scene"], d["triangles"], r["frame"], r["method"])
            row = least.setdefault(key, {
                "by": by, "compiler": d["compiler"], "scene": d["scene"],
                "triangles": d["triangles"], "partition": d["partition"], "frame": r["frame"],
                "method": r["method"], "ms_min": r["ms_min"]})
            row["ms_min"] = min(row["ms_min"], r["ms_min"])
    return list(least.values())


# ---------------------------------------------------------------------------------------------------
# Tables

def alone_by_two(turns, what):
    """Milliseconds of both methods of runs that have two, frame by frame, by (scene, triangles)."""
    return {key: (by_method(run, "ms"), by_method(run, "ms_min"))
            for key, run in grouped((r for r in turns if r["what"] == what), "scene",
                                    "triangles").items()}


def contour_test(runs, turns):
    """runs: rows of summary.csv by method, by (scene, triangles)."""
    rows, two = [], alone_by_two(turns, "contour")
    for (scene, triangles), run in runs.items():
        exact = run["exact"]
        edges, clocked = exact.get("rest_contour_edges"), exact.get("rest_contour_ms")
        row = [scene, whole(triangles)]
        by_two = two.get((scene, triangles))
        if by_two:
            of_exact, of_none = by_two[0]["exact"], by_two[0]["none"]
            row += [ratio(of_exact[0], of_none[0]),
                    ratio(mean(of_exact.values()), mean(of_none.values()))]
        else:
            row += ["–", "–"]
        row += [figure(edges / triangles if edges is not None else None),
                figure(1e6 * clocked / edges if edges else None),
                figure(1e6 * clocked / triangles if clocked is not None else None),
                "%.2f" % (1e6 * (of_exact[0] - of_none[0]) / triangles) if by_two else "–"]
        rows.append(row)
    return table(["scene", "triangles", "rest: exact ÷ none", "mean: exact ÷ none",
                  "edges a triangle", "ns an edge", "ns a triangle", "exact − none, ns a triangle"],
                 rows)


def worst_frame(turns, scene, triangles):
    """The least of all frames: how many times as fast exact is as aabb there, by the least times of both."""
    by_two = alone_by_two(turns, "boxes").get((scene, triangles))
    if not by_two:
        return None
    exact, aabb = by_two[1]["exact"], by_two[1]["aabb"]
    return min(aabb[frame] / exact[frame] for frame in exact)


def threads_of_query(turns):
    """Frames in which one thread takes more than a millisecond."""
    rows = []
    runs = grouped((r for r in turns if r["what"] == "threads"), "scene", "triangles", "workers")
    for (scene, triangles, workers), run in runs.items():
        methods = by_method(run, "ms")
        for method in ("exact", "aabb"):
            alone, several = methods.get(method + "@serial"), methods.get(method)
            if not alone or not several:
                continue
            long = [f for f in alone if alone[f] > 1.0]
            speed = [alone[f] / several[f] for f in long]
            row = [scene, whole(triangles), method, whole(workers),
                   "%d of %d" % (len(long), len(alone))]
            if long:
                one, all_of_them = (mean(ms[f] for f in long) for ms in (alone, several))
                row += [figure(one), figure(all_of_them), times(one / all_of_them),
                        times(min(speed)), times(max(speed))]
            rows.append(row + ["–"] * (10 - len(row)))
    return table(["scene", "triangles", "method", "threads", "frames over 1 ms", "1 thread, ms",
                  "all, ms", "speed-up", "least", "most"], rows) if rows else ""


def instructions(turns):
    rows, sets = [], ["avx512", "avx2", "base"]
    runs = grouped((r for r in turns if r["what"] == "instructions"), "scene", "triangles")
    for (scene, triangles), run in runs.items():
        methods = by_method(run, "ms")
        for method in ("exact", "aabb"):
            found = [methods.get("%s@%s" % (method, name)) for name in sets]
            best = next((ms for ms in found if ms), None)
            if not best:
                continue
            row = [scene, whole(triangles), method]
            for part in (lambda ms: ms[min(ms)], lambda ms: mean(ms.values())):
                row += [figure(part(ms)) if ms else "–" for ms in found]
                row += [ratio(part(best), part(ms)) if ms else "–" for ms in found[1:]]
            rows.append(row)
    header = ["AVX-512, ms", "AVX2, ms", "base, ms", "AVX2: speed", "base: speed"]
    return table(["scene", "triangles", "method"] + ["rest: " + h for h in header] +
                 ["mean: " + h for h in header], rows) if rows else ""


def built_by(built):
    """The library by other compilers: speed as a part of the one that all else is measured with."""
    rows = []
    for (scene, triangles, method), run in grouped(built, "scene", "triangles", "method").items():
        times_of = collections.OrderedDict()
        for r in run:
            times_of.setdefault(r["by"], {})[r["frame"]] = r["ms_min"]
        own = times_of.get("this")
        for by, ms in times_of.items():
            if by == "this" or not own:
                continue
            average = mean(own.values()), mean(ms.values())
            rows.append([scene, whole(triangles), method, by, figure(own[0]), figure(ms[0]),
                         ratio(own[0], ms[0]), figure(average[0]), figure(average[1]),
                         ratio(average[0], average[1])])
    return table(["scene", "triangles", "method", "other", "rest: ours, ms", "other, ms",
                  "other: speed", "mean: ours, ms", "other, ms", "other: speed"],
                 rows) if rows else ""


def heavy_contact(turns, peers):
    """Frames with many near pairs: ours of pairs of an edge and a triangle, and other libraries on the same frames."""
    rows, beside = [], []
    frames = grouped((r for r in turns if r["what"] == "contact" and r["near_pairs"] >= HEAVY),
                     "scene", "triangles", "frame")
    for (scene, triangles, frame), run in frames.items():
        ms = {r["method"]: r["ms"] for r in run}
        near = run[0]["near_pairs"]
        rows.append([scene, whole(triangles), whole(frame), whole(near), whole(run[0]["pairs"]),
                     figure(ms["exact"]), figure(ms["aabb"]), figure(1e6 * ms["exact"] / near),
                     figure(1e6 * ms["aabb"] / near), times(ms["aabb"] / ms["exact"])])
        same = [r for r in peers if (r["scene"], r["triangles"], r["frame"], r["processors"]) ==
                (scene, triangles, frame, 1)]
        for (process,), rows_of in grouped(same, "beside").items():
            ours = next((r for r in rows_of if r["what"] == "exact"), None)
            for r in rows_of:
                # who only says yes or no stops at the first pair
                if r["peer"] == "starcontour" or not ours or "yes or no" in r["what"]:
                    continue
                beside.append([scene, whole(frame), "%s %s" % (r["peer"], r["version"]),
                               r["what"].split(":")[0] + ": " + r["what"].split(":")[1].split(";")[0].strip()
                               if ":" in r["what"] else r["what"], whole(ours["pairs"]), figure(r["ms"]),
                               figure(ours["ms"]), times(r["ms"] / ours["ms"])])
    ours = table(["scene", "triangles", "frame", "near pairs", "pairs", "exact, ms", "aabb, ms",
                  "exact, ns a near pair", "aabb, ns a near pair", "× aabb"], rows) if rows else ""
    theirs = table(["scene", "frame", "peer", "what it does", "pairs", "ms", "exact, ms",
                    "× exact"], beside, left=4) if beside else ""
    return ours, theirs


def builds(shots):
    """Of each scene: built-in partition and METIS; memory is that of the built-in one."""
    rows = []
    for (scene, triangles), run in grouped(shots, "scene", "triangles").items():
        exact = {r["partition"]: r for r in run if r["method"] == "exact"}
        boxes = next((r for r in run if r["method"] == "aabb" and r["partition"] == "fast"), None)
        fast, metis = exact.get("fast"), exact.get("metis")
        if not fast:
            continue
        rows.append([scene, whole(triangles), figure(1e3 * fast["build_ms"] / triangles),
                     figure(1e3 * metis["build_ms"] / triangles if metis else None),
                     "%.0f" % (fast["model_bytes"] / triangles),
                     "%.0f" % (fast["workspace_bytes"] / triangles),
                     "%.0f" % ((fast["model_bytes"] + fast["workspace_bytes"]) / triangles),
                     "%.0f" % (fast["peak_bytes"] / triangles),
                     figure(1e3 * boxes["build_ms"] / triangles if boxes else None),
                     "%.0f" % ((boxes["model_bytes"] + boxes["workspace_bytes"]) / triangles)
                     if boxes else "–",
                     figure(boxes["total_ms"] if boxes else None), figure(fast["total_ms"])])
    return table(["scene", "triangles", "built-in, µs a triangle", "METIS, µs a triangle",
                  "model, bytes a triangle", "workspace", "both", "while building",
                  "boxes alone: µs a triangle", "bytes", "one shot, ms", "one shot by exact, ms"], rows) if rows else ""


def one_shot_of_peers(peers):
    """One query from nothing beside the first frame of other libraries that make everything anew."""
    rows = []
    for (beside, scene, triangles), run in grouped(
            (r for r in peers if r["processors"] == 1 and r["frame"] == 0), "beside", "scene",
            "triangles").items():
        ours = next((r for r in run if r["what"] == "one shot"), None)
        for r in run:
            if r["peer"] == "starcontour" or not ours or "rebuilt" not in r["what"]:
                continue
            rows.append([scene, whole(triangles), "%s %s" % (r["peer"], r["version"]), figure(r["ms"]),
                         figure(ours["ms"]), ratio(ours["ms"], r["ms"])])
    return table(["scene", "triangles", "peer", "its first frame, ms", "ours from nothing, ms",
                  "ours ÷ peer"], rows) if rows else ""


def peers_compact(peers):
    """How many times as fast exact is as CGAL and as Embree, at rest and on the mean, one thread."""
    columns = [("cgal", "", "CGAL"), ("embree", "refitted", "Embree, refitted"),
               ("embree", "rebuilt", "Embree, rebuilt"), ("fcl", "", "FCL"),
               ("libigl", "", "libigl"), ("meshlib", "", "MeshLib")]
    rows = []
    single = [r for r in peers if r["processors"] == 1]
    for (scene, triangles), run in grouped(single, "scene", "triangles").items():
        row = [scene, whole(triangles)]
        for peer, word, _ in columns:
            theirs = [r for r in run if r["peer"] == peer and word in r["what"]]
            ours = {r["frame"]: r["ms"] for r in run
                    if r["what"] == "exact" and r["beside"] == peer}
            same = [r for r in theirs if r["frame"] in ours]
            rest = [r["ms"] / ours[0] for r in same if r["frame"] == 0]
            row += [times(rest[0]) if rest else "–",
                    ratio(sum(r["ms"] for r in same), sum(ours[r["frame"]] for r in same))
                    if same else "–"]
        if any(cell != "–" for cell in row[2:]):
            rows.append(row)
    return table(["scene", "triangles"] + [title for _, _, name in columns
                                           for title in (name + ": rest", "mean")],
                 rows) if rows else ""

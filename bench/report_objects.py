"""Several objects in one query, for the reports that draw_report.py makes: two tables.

objects.csv has a line a scene, question, number of workers and way, as sc-objects --csv writes it;
objects_peers.csv is what `make objects-peers` wrote, with the columns of peers.csv.

SPDX-License-Identifier: MIT
"""

import csv
import glob
import os

from report_near import goal
from report_text import figure, mean, ratio, table, whole

OBJECTS = ["scene", "question", "objects", "workers", "way", "pairs", "ms"]

SCENES = {"body": "a cloth of 20,000 triangles on a body of a million that does not move",
          "crowd": "a hundred characters of 10,000 triangles that share a model",
          "layers": "two layers of cloth of 65,522 triangles, half an edge apart"}

QUESTIONS = {"query": "intersections", "near": "within half an edge", "step": "a step"}


def collect(folder):
    """Rows of all files *.objects in a folder."""
    rows = []
    for path in sorted(glob.glob(os.path.join(folder, "*.objects"))):
        with open(path, encoding="utf-8", newline="") as file:
            rows += [dict(row, objects=int(row["objects"]), workers=int(row["workers"]),
                          pairs=float(row["pairs"]), ms=float(row["ms"])) for row in csv.DictReader(file)]
    return rows


def own_table(rows):
    """"" without rows."""
    by = {}
    for row in rows:
        by.setdefault((row["scene"], row["question"], row["workers"]), {})[row["way"]] = row
    lines = []
    for (scene, question, workers), ways in by.items():
        if set(ways) < {"objects", "merged", "alone"}:
            continue
        ms = {way: row["ms"] for way, row in ways.items()}
        cut = [figure(ms["cut"]), ratio(ms["objects"], ms["cut"])] if "cut" in ms else ["–", "–"]
        lines.append([scene, QUESTIONS.get(question, question), whole(workers), whole(ways["objects"]["pairs"]),
                      figure(ms["objects"]), *cut, figure(ms["merged"]), ratio(ms["merged"], ms["objects"]),
                      figure(ms["alone"])])
    return table(["Scene", "Question", "Threads", "Pairs", "Objects, ms", "Cut, ms", "Objects ÷ cut", "One mesh, ms",
                  "One mesh ÷ objects", "Each alone, ms"], lines, 2) if lines else ""


def target_table(rows):
    """What a body that stays may cost, beside what of it is near. "" without such a body."""
    by = {}
    for row in rows:
        by.setdefault((row["scene"], row["question"], row["workers"]), {})[row["way"]] = row["ms"]
    ratios = [(ms["objects"] / ms["cut"],
               "%s, %s, %d thread%s" % (scene, QUESTIONS.get(question, question), workers, "s" * (workers > 1)))
              for (scene, question, workers), ms in by.items() if ms.get("cut")]
    return table(["what", "wanted", "worst", "where", ""],
                 [goal("objects ÷ cut", 1.2, ratios, True)]) if ratios else ""


def peer_table(rows):
    """Peers beside sc_query_objects, which ran in the same process. "" without rows."""
    by = {}
    for row in rows:
        by.setdefault((row["scene"], int(row["processors"]), row["beside"]), {}).setdefault(
            (row["peer"], str(row["version"]), row["what"]), []).append(row)
    lines = []
    for (scene, threads, _), ways in sorted(by.items()):
        ours = [frames for (peer, _, what), frames in ways.items() if (peer, what) == ("starcontour", "objects")]
        if not ours:
            continue
        own = mean(row["ms"] for row in ours[0])
        for (peer, version, what), frames in ways.items():
            if peer == "starcontour":
                continue
            ms = mean(row["ms"] for row in frames)
            wrong = sum(row["missing"] + row["extra"] for row in frames)
            lines.append([scene, "%s %s" % (peer, version), what, str(threads),
                          whole(mean(row["pairs"] for row in frames)), figure(ms), figure(own), ratio(ms, own),
                          "–" if any(row["matches"] == "unknown" for row in frames) else
                          "%s wrong" % whole(wrong) if wrong else "match"])
    return table(["Scene", "Peer", "What it does a frame", "Threads", "Pairs", "ms", "Objects, ms", "× objects",
                  "Answers"], lines, 3) if lines else ""


def peer_section(peers):
    """Lines of the report; peers: rows, what was left out, and the commit, as read_peers gives them."""
    rows, skipped, commit = peers
    shown = peer_table(rows)
    out = []
    if shown:
        out += ["Other libraries on the same objects, in one process with `sc_query_objects` (*objects*), in turns, both\n"
                "with so many threads; made by `make objects-peers` at commit %s and explained in\n"
                "bench/peers/README.md; means over the frames of medians. Embree and FCL: what intersects; a tree for\n"
                "each object, of which those that do not move are built once. *Pairs*: of triangles that share no\n"
                "vertex. ipc-toolkit: boxes of one mesh of all objects, within half an edge or along a step; *match*:\n"
                "no pair of `sc_query_objects_near` or `sc_query_objects_step` is missing there.\n" % commit,
                shown]
    if skipped:
        out.append("Left out:\n\n" + "".join("- %s\n" % line for line in skipped))
    return out

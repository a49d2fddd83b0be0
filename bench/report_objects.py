"""Several objects in one query, for the reports that draw_report.py makes: a table.

objects.csv has a line a scene, question, number of workers and way, as sc-objects --csv writes it.

SPDX-License-Identifier: MIT
"""

import csv
import glob
import os

from report_text import figure, ratio, table, whole

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
        lines.append([scene, QUESTIONS.get(question, question), str(workers), whole(ways["objects"]["pairs"]),
                      figure(ms["objects"]), figure(ms["merged"]), ratio(ms["merged"], ms["objects"]),
                      figure(ms["alone"])])
    return table(["Scene", "Question", "Threads", "Pairs", "Objects, ms", "One mesh, ms", "Gain", "Each alone, ms"],
                 lines, 2) if lines else ""

"""Many poses of one character, for the reports that draw_report.py makes: tables, and what is to be reached.

dataset.csv has a line a number of workers, as sc-dataset --csv writes it; dataset_peers.csv is what
bench/peers/dataset.py wrote. A table without rows is "".

SPDX-License-Identifier: MIT
"""

import csv
import glob
import os

from report_near import goal
from report_text import figure, ratio, table, times, whole

DATASET = ["triangles", "poses", "chunk", "workers", "ms", "ms_median", "cpu_share", "colliding", "pairs", "checked",
           "differs"]

# With less than that of their processors, runs say little about several workers.
UNDISTURBED = 0.95

# The peer's mean is so many times its median, or ours, where other programs were running.
SPREAD = 1.2


def collect(folder):
    """Rows of all files *.dataset in a folder; one worker, which all files have, comes once for each."""
    rows = []
    for path in sorted(glob.glob(os.path.join(folder, "*.dataset"))):
        with open(path, encoding="utf-8", newline="") as file:
            rows += [{key: float(row[key]) if "." in row[key] else int(row[key]) for key in DATASET}
                     for row in csv.DictReader(file)]
    return rows


def runs(rows):
    """Rows of one worker, each with that of several which took turns with it, or None."""
    found = []
    for row in rows:
        if row["workers"] == 1:
            found.append([row, None])
        elif found:
            found[-1][1] = row
    return found


def a_core(row):
    return row["ms"] * row["workers"]


def own_table(rows):
    lines = []
    for one, several in runs(rows):
        for row in filter(None, (one, several)):
            lines.append([whole(row["triangles"]), whole(row["poses"]), whole(row["workers"]), figure(row["ms"]),
                          figure(a_core(row)), figure(a_core(row) * row["cpu_share"]),
                          "%.0f" % (100 * row["cpu_share"]), ratio(one["ms"], row["ms"]),
                          "%.0f" % (100 * row["colliding"] / row["poses"]), figure(row["pairs"] / row["poses"]),
                          "differ" if row["differs"] else "same"])
    return table(["triangles", "poses", "workers", "ms a pose", "a core, ms", "on processors, ms", "share, %",
                  "throughput", "colliding, %", "pairs a pose", "answers"], lines, left=0) if lines else ""


def disturbed(rows):
    return any(row["cpu_share"] < UNDISTURBED for row in rows)


def goals(rows):
    """What is to be reached: as report_near.goals."""
    lines = [goal("25,000 triangles: ms a pose and core", 0.6,
                  [(a_core(row), "one worker" if row["workers"] == 1 else "two workers") for row in rows
                   if 24000 <= row["triangles"] <= 26000 and row["poses"] >= 100000 and row["workers"] <= 2], True),
             goal("two workers: throughput", 1.9,
                  [(one["ms"] / several["ms"], "%s poses" % whole(one["poses"])) for one, several in runs(rows)
                   if several and several["workers"] == 2], False)]
    return table(["what", "wanted", "worst", "where", ""], lines)


def answers(row):
    """What is wrong with a peer's answers."""
    parts = ["%s %s" % (whole(row[key]), key) for key in ("missing", "extra") if row[key]]
    return "%s in %s" % (", ".join(parts), whole(row["unequal"])) if parts else "–"


def peer_table(rows):
    by = {}
    for row in rows:
        by.setdefault((row["scene"], row["peer"], str(row["version"]), row["what"], row["poses"]),
                      {})[int(row["threads"])] = row
    lines = []
    for (scene, peer, version, what, poses), threads in sorted(by.items()):
        one = threads.get(1) or threads[min(threads)]
        most = threads[max(threads)] if max(threads) > 1 else None
        lines.append([scene, "%s %s" % (peer, version), what, whole(poses), figure(one["ms"]), figure(one["ours_ms"]),
                      times(one["ms"] / one["ours_ms"]), figure(most["ms"]) if most else "–",
                      times(most["ms"] / most["ours_ms"]) if most else "–",
                      "%s of %s" % (whole(one["wrong"]), whole(poses)), answers(one)])
    return table(["scene", "peer", "what it does a pose", "poses", "ms", "exact, ms", "× exact", "all threads: ms", "× exact",
                  "wrong verdicts", "wrong pairs"], lines, left=3) if lines else ""


def peers_disturbed(rows):
    return any(row["mean"] > SPREAD * row["ms"] or row["ours_mean"] > SPREAD * row["ours_ms"] for row in rows)


def section(rows, peers, commit, skipped):
    """The report's lines about this, or none if nothing was measured."""
    out = []
    if not rows and not peers:
        return out
    out.append("## Many poses of one model\n")
    if rows:
        out.append("`sc_query_batch` on poses of a character that are drawn by number (`sc-dataset`): all pairs of\n"
                   "triangles, touching; by one worker and by several, in turns, with a query for each worker. *A core*:\n"
                   "milliseconds a pose times workers. *On processors*: the part of it for which threads really ran,\n"
                   "also in percent. *Answers*: those of several workers beside those of one, and of every so many\n"
                   "poses beside `sc_query` alone, by the default method and by boxes.\n")
        if disturbed(rows):
            out.append("**Disturbed**: some of these runs had less than %.0f %% of their processors.\n"
                       % (100 * UNDISTURBED))
        out.append(own_table(rows))
        out.append("What is to be reached:\n")
        out.append(goals(rows))
    if peers:
        out.append("Other libraries on such poses, each once, beside `sc_query` (`exact`) in one process, in turns; made\n"
                   "by `make dataset-peers` at commit %s and explained in bench/peers/README.md. Medians over the\n"
                   "poses; `exact` runs on one thread in any case. *Wrong verdicts*: how often the answer to \"does it\n"
                   "collide?\" is wrong; *wrong pairs*, or triangles where the peer names these: how many are missing\n"
                   "or none, and in how many poses. *Rounded*: coordinates are multiples of 1/512, as packed datasets\n"
                   "have them, so that triangles touch, and some have no area.\n" % commit)
        if peers_disturbed(peers):
            out.append("**Disturbed**: other programs ran at the same time, so that single figures can be far off.\n")
        out.append(peer_table(peers))
        if skipped:
            out.append("Left out:\n\n" + "".join("- %s\n" % line for line in skipped))
    return out

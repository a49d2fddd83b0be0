"""Contours beside other libraries, for the reports that draw_report.py makes: a table, and what is to be reached.

trace_peers.csv is what `make trace-peers` wrote, with the columns that bench/peers/trace_curves.py explains.

SPDX-License-Identifier: MIT
"""

import collections

from report_near import goal
from report_text import figure, mean, ratio, table, whole

# The scenes that targets are about. Frames with fewer pairs say nothing about them.
TARGETS = ("bunny", "crushed-cloth", "wrinkled-cloth")
FEW = 100

# Medians are so many times the minima where other programs were running.
SPREAD = 1.2

# What is measured, what is wanted, beside which peer, and whether it is wanted at most.
WANTED = [("sc_trace: × the query that finds its pairs", 1.3, None, True),
          ("query and sc_trace: × MeshLib", 10, "meshlib", False), ("query and sc_trace: × libigl", 20, "libigl", False)]


def runs(rows):
    """(scene, triangles, peer beside): rows by who was asked for what."""
    found = collections.OrderedDict()
    for row in rows:
        found.setdefault((row["scene"], row["triangles"], row["beside"]), collections.OrderedDict()).setdefault(
            (row["peer"], row["what"]), []).append(row)
    return found


def own(ways, what):
    return ways.get(("starcontour", what), [])


def total(rows):
    return sum(row["ms"] for row in rows)


def peer_table(rows):
    """Each scene and way of a peer: means over the frames. "" without rows."""
    lines = []
    for (scene, triangles, beside), ways in runs(rows).items():
        pairs, traced = own(ways, "pairs"), own(ways, "sc_trace")
        both = total(pairs) + total(traced)
        for (peer, what), frames in ways.items():
            if peer != beside:
                continue
            verdicts = collections.Counter(row["verdict"] for row in frames if row["verdict"])
            offs = [row["off"] for row in frames if row["off"] is not None and row["verdict"] == "match"]
            lines.append([scene, whole(triangles), "%s %s" % (peer, frames[0]["version"]), what,
                          whole(mean(row["pairs"] for row in frames)),
                          figure(total(pairs) / len(pairs)), figure(total(traced) / len(traced)),
                          ratio(total(traced), total(pairs)), figure(total(frames) / len(frames)),
                          ratio(total(frames), both),
                          ", ".join("%s %s" % (whole(n), verdict) for verdict, n in sorted(verdicts.items())) or "–",
                          "%.1e" % max(offs) if offs else "–"])
    return table(["scene", "triangles", "peer", "what it does a frame", "pairs", "query, ms", "sc_trace, ms",
                  "sc_trace ÷ query", "peer, ms", "× both of ours", "curves, frames", "lengths off"], lines,
                 4) if lines else ""


def goals(rows):
    """As report_near.goals: a line for each target, the worst frame of all scenes that it is about."""
    lines = []
    for name, wanted, beside, most in WANTED:
        values = []
        for (scene, triangles, peer), ways in runs(rows).items():
            if scene not in TARGETS or beside not in (None, peer):
                continue
            pairs, traced = own(ways, "pairs"), own(ways, "sc_trace")
            # What a peer needs for contours; its pairs alone are a line of their own.
            theirs = [frames for (p, _), frames in ways.items() if p == peer][-1]
            for query, trace, other in zip(pairs, traced, theirs):
                if query["pairs"] < FEW:
                    continue
                value = trace["ms"] / query["ms"] if beside is None else other["ms"] / (query["ms"] + trace["ms"])
                values.append((value, "%s, %s, frame %d" % (scene, whole(triangles), query["frame"])))
        lines.append(goal(name, wanted, values, most))
    return table(["what", "wanted", "worst", "where", ""], lines)


def section(peers):
    """Lines of the report; peers: rows, what was left out, and the commit, as read_peers gives them."""
    rows, skipped, commit = peers
    shown = peer_table(rows)
    out = []
    if shown or skipped:
        out.append("## Contours beside other libraries\n")
    if shown:
        out += ["`sc_trace` and the query that finds its pairs, and what others need for curves of self-intersection,\n"
                "in one process, on one processor, in turns; made by `make trace-peers` at commit %s and explained\n"
                "in bench/peers/README.md. Means over the frames of medians. *Curves*: in how many frames theirs are\n"
                "as many and, but for MeshLib's, as long as ours; degenerate: something touches, and how ties are\n"
                "decided decides about curves. *Off*: the largest difference of total lengths, relative.\n" % commit]
        if total(rows) > SPREAD * sum(row["ms_min"] for row in rows):
            out.append("**Disturbed**: other programs ran at the same time, so that single figures can be far off.\n")
        out += [shown, "What is to be reached, in the worst of the frames with at least %d pairs:\n" % FEW, goals(rows)]
    if skipped:
        out.append("Left out:\n\n" + "".join("- %s\n" % line for line in skipped))
    return out

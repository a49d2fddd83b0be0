"""WebAssembly beside native code, for the reports that draw_report.py makes: wasm.csv is what
bench/wasm_times.sh wrote.

SPDX-License-Identifier: MIT
"""

from report_near import goal
from report_text import figure, ratio, table, whole


def section(rows, commit):
    """The report's lines about this, or none if nothing was measured."""
    if not rows:
        return []
    lines = [[row["scene"], whole(row["triangles"]), whole(row["pairs"]), figure(row["best_ms"]), figure(row["base_ms"]),
              figure(row["wasm_ms"]), ratio(row["base_ms"], row["wasm_ms"]), "match" if row["same"] else "differ"]
             for row in rows]
    slowest = [(row["base_ms"] / row["wasm_ms"], "%s, %s" % (row["scene"], whole(row["triangles"]))) for row in rows]
    return ["## WebAssembly\n",
            "The package for npm in Node, with 128-bit vectors, beside the library itself, `exact`: milliseconds a\n"
            "frame, means over the animation of medians over walks, the least of several runs in turns. Times of\n"
            "WebAssembly include copying positions in and pairs out. *SSE2* has vectors of the same width, *best* the\n"
            "widest of this machine. Made by `make bench-wasm` at commit %s.\n" % commit,
            table(["scene", "triangles", "pairs", "best", "SSE2", "WebAssembly", "of SSE2's speed", "pairs found"], lines),
            "What is to be reached:\n",
            table(["what", "wanted", "worst", "where", ""], [goal("part of SSE2's speed", 0.25, slowest, False)])]

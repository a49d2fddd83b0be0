"""Figures and tables as text, for the reports that draw_report.py makes.

SPDX-License-Identifier: MIT
"""

import math


def mean(values):
    values = list(values)
    return sum(values) / len(values) if values else 0.0


def figure(value, digits=3):
    """A number with so many significant digits, never in exponential form."""
    if value is None:
        return "–"
    if value == 0:
        return "0"
    places = max(0, digits - 1 - int(math.floor(math.log10(abs(value)))))
    return "{:,.{}f}".format(value, places)


def times(value):
    return "–" if value is None else "%.2f" % value if value < 9.995 else "%.1f" % value


def ratio(value, divisor):
    """As times; nothing where there is nothing to divide by."""
    return times(value / divisor) if value and divisor else "–"


def whole(value):
    return "{:,d}".format(int(value))


def table(header, rows, left=1):
    """A table in Markdown; the first columns are aligned left, numbers right."""
    lines = ["| " + " | ".join(header) + " |",
             "|" + "|".join("---" if i < left else "--:" for i in range(len(header))) + "|"]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines) + "\n"

"""Plots of times over frames and over resolution, for the reports that draw_report.py makes.

Legends stand outside of the axes, so that they cover no line; scenes are shown beside their curves; where there
are repeats that differ, a band says how much.

SPDX-License-Identifier: MIT
"""

import collections
import os

from report_text import whole

# Okabe and Ito's colours, which the colour-blind can tell apart, and markers for prints without
# colour.
STYLES = {
    "exact": ("#0072B2", "o", "-"),
    "star": ("#009E73", "s", "-"),
    "none": ("#999999", "", ":"),
    "aabb-sctt": ("#E69F00", "^", "--"),
    "aabb": ("#D55E00", "v", "--"),
    "hash": ("#CC79A7", "x", "-."),
}

GRID = "#dddddd"

NO_PICTURES = "No pictures of the scenes: they take a browser (Chromium) where it is measured."


# ---------------------------------------------------------------------------------------------------
# What all plots have

def import_pyplot():
    """matplotlib's, set up to draw into files; None without it."""
    try:
        import matplotlib
    except ImportError:
        return None
    matplotlib.use("Agg")
    matplotlib.rcParams["svg.fonttype"] = "none"
    matplotlib.rcParams["svg.hashsalt"] = "starcontour"
    from matplotlib import pyplot
    return pyplot


def save(plot, folder, name):
    """As SVG and as PNG. dpi of SVG is about pictures in it alone."""
    plot.savefig(os.path.join(folder, name + ".svg"), dpi=150, metadata={"Date": None})
    plot.savefig(os.path.join(folder, name + ".png"), dpi=110, metadata={"Software": None})


def band(axis, x, low, high, color):
    """Fills from low to high, where both are known and anywhere differ; whether it does."""
    points = [(a, b, c) for a, b, c in zip(x, low, high) if b is not None and c is not None]
    if not any(c > b for _, b, c in points):
        return False
    axis.fill_between([p[0] for p in points], [p[1] for p in points], [p[2] for p in points],
                      color=color, alpha=0.22, linewidth=0)
    return True


def show_picture(axis, picture, below=""):
    """A scene, and a line that says what it shows; axis has nothing else."""
    axis.set_axis_off()
    if picture is None:
        axis.text(0.5, 0.5, "no picture", transform=axis.transAxes, ha="center", va="center", fontsize=7,
                  color="#777777")
        return
    axis.imshow(picture)
    axis.set_title(below, fontsize=7, y=0, va="top", pad=-3)


def format_axis(axis):
    axis.tick_params(labelsize=7)
    axis.grid(True, which="major", color=GRID, linewidth=0.6)


def legend_above(plot, named, caption):
    """One legend of all axes and lines of text, above them. named: a line by each name."""
    inch = 1 / plot.get_figheight()
    plot.legend(list(named.values()), list(named), loc="upper center", ncol=len(named), frameon=False, fontsize=9)
    lines = caption.count("\n") + 1
    plot.text(0.5, 1 - 0.36 * inch, caption, ha="center", va="top", fontsize=8, color="#444444")
    plot.tight_layout(rect=(0, 0, 1, 1 - (0.42 + 0.15 * lines) * inch))


def panels(pyplot, count, columns, width, height, side):
    """A figure and count pairs: axes for a curve, and a cell beside it that is side times as wide (None if 0)."""
    columns = min(columns, count)
    lines = (count + columns - 1) // columns
    plot = pyplot.figure(figsize=(max(width * columns, 8), height * lines + 0.7))
    cells = plot.add_gridspec(lines, columns)
    pairs = []
    for i in range(count):
        cell = cells[divmod(i, columns)]
        two = cell.subgridspec(1, 2, width_ratios=(1, side), wspace=0.06) if side else None
        pairs.append((plot.add_subplot(two[0] if side else cell), two[1] if side else None))
    return plot, pairs


# ---------------------------------------------------------------------------------------------------
# Figure 8

def animations(frames):
    """Rows of frames.csv by scene, of the largest size with the most frames: scene: ((frames, triangles), rows)."""
    series = collections.OrderedDict()
    for row in frames:
        series.setdefault((row["scene"], row["triangles"], row["partition"]), []).append(row)
    chosen = collections.OrderedDict()
    for (scene, triangles, _), rows in series.items():
        size = len(rows), int(triangles)
        if scene not in chosen or size >= chosen[scene][0]:
            chosen[scene] = size, rows
    return chosen


def shown_frame(rows):
    """The first of those with the most pairs, or the middle one where nothing meets."""
    most = max(row["pairs"] for row in rows)
    return int(next(row["frame"] for row in rows if row["pairs"] == most)) if most else len(rows) // 2


def wanted_pictures(frames):
    """(scene, triangles, frames, frame) of each animation."""
    return [(scene, triangles, length, shown_frame(rows))
            for scene, ((length, triangles), rows) in animations(frames).items()]


def passes(results, scenes):
    """How many passes there were over those (scene, triangles), as text."""
    runs = results.main_runs()
    counts = sorted({int(runs[key]["exact"]["repeats"]) for key in scenes if key in runs})
    if not counts or counts[-1] == 1:
        return "one pass"
    return "%d passes" % counts[0] if len(counts) == 1 else "%d to %d passes" % (counts[0], counts[-1])


def draw_frames(pyplot, results, pictures):
    """Figure 8: milliseconds over frames. pictures: by scene."""
    chosen = animations(results.frames)
    has_pictures = any(picture is not None for picture in pictures.values())
    plot, pairs = panels(pyplot, len(chosen), 2 if has_pictures else 3, 5.5 if has_pictures else 3.67,
                         2.1 if has_pictures else 2.7, 0.42 if has_pictures else 0)
    has_bands = False
    for i, ((axis, cell), (scene, ((length, triangles), rows))) in enumerate(zip(pairs, chosen.items())):
        for method, (color, _, line) in STYLES.items():
            axis.plot(range(length), [row[method] for row in rows], color=color, linestyle=line, linewidth=1.4,
                      label=method)
            has_bands |= band(axis, range(length), [row.get(method + "_min") for row in rows],
                              [row.get(method + "_max") for row in rows], color)
        axis.set_yscale("log")
        axis.minorticks_off()
        axis.xaxis.set_major_locator(pyplot.MaxNLocator(6, integer=True))
        axis.set_title("%s, %s triangles" % (scene, whole(triangles)), fontsize=9)
        format_axis(axis)
        axis.set_ylabel("ms", fontsize=8)
        if i >= len(chosen) - (2 if has_pictures else 3):
            axis.set_xlabel("frame", fontsize=8)
        if cell is None:
            continue
        frame = shown_frame(rows)
        if pictures.get(scene) is not None:
            axis.axvline(frame, color="#666666", linestyle=(0, (1, 2)), linewidth=0.8, zorder=1.6)
        show_picture(plot.add_subplot(cell), pictures.get(scene),
                     "frame %d: %s pairs" % (frame, whole(rows[frame]["pairs"])))
    said = ["Milliseconds over frames."]
    if has_bands:
        said.append("Lines: medians of %s; bands: from the least to the greatest of them; hash: one pass." %
                    passes(results, [(scene, size[1]) for scene, (size, _) in chosen.items()]))
    if has_pictures:
        said.append("Pictures: the frame with the most pairs (dotted line), faces that collide red, contacts dark.")
    else:
        said.append(NO_PICTURES)
    handles, labels = pairs[0][0].get_legend_handles_labels()
    legend_above(plot, dict(zip(labels, handles)), "\n".join(said) if has_bands else " ".join(said))
    return plot


# ---------------------------------------------------------------------------------------------------
# Resolution

def draw_scaling(pyplot, results, found, sizes, pictures):
    """Milliseconds over triangles, of scenes with three sizes; or None. found: the slopes by scene and method."""
    scenes = [scene for scene, runs in sizes.items() if len(runs) >= 3]
    if not scenes:
        return None
    plot, pairs = panels(pyplot, len(scenes), 2, 5.5, 2.9, 0.42)
    has_bands, has_pictures = False, any(pictures.get(scene) is not None for scene in scenes)
    for (axis, cell), scene in zip(pairs, scenes):
        x = [t for t, _ in sizes[scene]]
        for method, (color, marker, line) in STYLES.items():
            rows = [run[method] for _, run in sizes[scene]]
            axis.loglog(x, [row["mean_ms"] for row in rows], color=color, marker=marker, linestyle=line,
                        markersize=4, linewidth=1.4, label="%s %.2f" % (method, found[scene, method]))
            has_bands |= band(axis, x, [row["mean_of_minima_ms"] for row in rows],
                              [row.get("mean_of_maxima_ms") for row in rows], color)
        axis.set_title(scene, fontsize=9)
        axis.set_xlabel("triangles", fontsize=8)
        axis.minorticks_off()
        axis.set_xticks(x)
        axis.set_xticklabels([whole(t) for t in x])
        axis.set_ylabel("ms a frame, mean", fontsize=8)
        format_axis(axis)
        inner = cell.subgridspec(2, 1, height_ratios=(1, 1.1))
        if has_pictures:
            show_picture(plot.add_subplot(inner[0]), pictures.get(scene))
        side = plot.add_subplot(inner[1])
        side.set_axis_off()
        handles, labels = axis.get_legend_handles_labels()
        side.legend(handles, labels, title="slope", loc="center left", borderaxespad=0, fontsize=7,
                    title_fontsize=7, frameon=False)
    said = "Milliseconds a frame over resolution, means over the animation."
    if has_bands:
        said += ("\nLines: of medians of %s; bands: from the mean of the least to that of the greatest times." %
                 passes(results, [(scene, t) for scene in scenes for t, _ in sizes[scene]]))
    if has_pictures:
        said += "\nPictures: those beside the animations."
    else:
        said += "\n" + NO_PICTURES
    inch = 1 / plot.get_figheight()
    plot.text(0.5, 1 - 0.08 * inch, said, ha="center", va="top", fontsize=8, color="#444444")
    plot.tight_layout(rect=(0, 0, 1, 1 - (0.15 + 0.15 * (said.count("\n") + 1)) * inch))
    return plot

"""Looks at the plots of bench/draw_report.py: that legends cover no line, that repeats have bands, and pictures.

    look_at_plots.py RESULTS [RESULTS...]

RESULTS is a folder of a report with two sizes of near, three of one scene, and two passes over everything; others
are as they are committed, and have pictures. Exit status 77 without matplotlib.

SPDX-License-Identifier: MIT
"""

import csv
import os
import shutil
import stat
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.insert(0, "bench")

import draw_report
import report_pictures
import report_plots

pyplot = report_plots.import_pyplot()
if not pyplot:
    sys.exit(77)

import numpy
from matplotlib.collections import PolyCollection

failures = []


def expect(fine, what):
    if not fine:
        failures.append(what)
        print("not so: " + what)


# ---- what is looked at in a figure ----

def legends_of(plot):
    return plot.legends + [axis.get_legend() for axis in plot.axes if axis.get_legend()]


def curves_of(axis):
    """Lines, but for those that mark a place."""
    return [line for line in axis.lines if not line.get_label().startswith("_")]


def bands_of(axis):
    return [item for item in axis.collections if isinstance(item, PolyCollection)]


def pictures_of(plot):
    return [image for axis in plot.axes for image in axis.images]


def text_of(plot):
    return " ".join(text.get_text() for text in plot.texts)


def covered(plot):
    """What legends cover: lines, bands, pictures, axes with curves, other legends; or the edge of the figure."""
    plot.canvas.draw()
    renderer = plot.canvas.get_renderer()
    legends = [(legend, legend.get_window_extent(renderer)) for legend in legends_of(plot)]
    found = []
    for number, (_, box) in enumerate(legends):
        for axis in plot.axes:
            name = axis.get_title()
            for line in axis.lines:
                path = line.get_path().transformed(line.get_transform())
                if path.intersects_bbox(box, filled=False):
                    found.append("a line %s of %s" % (line.get_label(), name))
            for item in bands_of(axis):
                if any(path.transformed(item.get_transform()).intersects_bbox(box) for path in item.get_paths()):
                    found.append("a band of %s" % name)
            if axis.lines and box.overlaps(axis.get_window_extent(renderer)):
                found.append("the axes of %s" % name)
            if any(box.overlaps(image.get_window_extent(renderer)) for image in axis.images):
                found.append("a picture")
        found += ["another legend" for _, other in legends[:number] if box.overlaps(other)]
        found += ["words: " + text.get_text() for text in plot.texts
                  if box.overlaps(text.get_window_extent(renderer))]
        if not (plot.bbox.x0 <= box.x0 and box.x1 <= plot.bbox.x1 and plot.bbox.y0 <= box.y0 and
                box.y1 <= plot.bbox.y1):
            found.append("the edge of the figure")
    return found


def crowded(plot):
    """Titles of axes whose labels of ticks overlap, and pictures over axes."""
    renderer = plot.canvas.get_renderer()
    found = []
    for axis in plot.axes:
        for labels in (axis.get_xticklabels(which="both"), axis.get_yticklabels(which="both")):
            boxes = [label.get_window_extent(renderer) for label in labels if label.get_text() and axis.axison]
            boxes = [box for box in boxes if box.width > 0]
            if any(a.overlaps(b) for i, a in enumerate(boxes) for b in boxes[:i]):
                found.append(axis.get_title())
    curves = [axis.get_tightbbox(renderer) for axis in plot.axes if axis.lines]
    found += ["a picture" for image in pictures_of(plot)
              if any(image.get_window_extent(renderer).overlaps(box) for box in curves)]
    return found


def look(name, plot):
    found = covered(plot)
    expect(legends_of(plot), "%s has a legend" % name)
    expect(not found, "%s: legends cover nothing, but they cover %s" % (name, ", ".join(found)))
    found = crowded(plot)
    expect(not found, "%s: nothing overlaps, but in %s" % (name, ", ".join(found)))


def holds(item, line):
    """Whether a band is about the line, and somewhere higher than nothing."""
    vertices = numpy.concatenate([path.vertices for path in item.get_paths()])
    spans = [(vertices[vertices[:, 0] == x][:, 1], y) for x, y in line.get_xydata()]
    return all(len(ys) and ys.min() <= y * (1 + 1e-3) and ys.max() >= y * (1 - 1e-3) for ys, y in spans) and any(
        ys.max() > ys.min() for ys, _ in spans)


# ---- the checks ----

def checker_sees():
    """A legend over a line, one outside, and ticks that overlap."""
    for place, wanted in (("upper left", True), ("lower right", False)):
        plot, axis = pyplot.subplots()
        axis.plot([0, 1], [1.05, 1], label="line")
        axis.set(xlim=(0, 1.1), ylim=(0, 1.1), title="name")
        axis.legend(loc=place)
        lines = [what for what in covered(plot) if what.startswith("a line")]
        expect(bool(lines) == wanted, "a legend at the %s is %sseen over a line" % (place, "" if wanted else "not "))
        axis.set_xticks([0.5, 0.501])
        axis.set_xticklabels(["one half", "and more"])
        plot.canvas.draw()
        expect(crowded(plot), "ticks that overlap are seen")
        pyplot.close(plot)


def fake_programs(folder, picture):
    """sc-bench that writes a file, and sc-query that writes that picture; without it, one that fails as without
    a browser."""
    os.makedirs(folder, exist_ok=True)
    query = "cp '%s' \"$2\"; exit 1" % picture if picture else "echo \"$2: no browser to draw it\" >&2; exit 2"
    for name, does in (("sc-bench", "mkdir \"$6\""), ("sc-query", query)):
        path = os.path.join(folder, name)
        with open(path, "w", encoding="ascii") as file:
            file.write("#!/bin/sh\n%s\n" % does)
        os.chmod(path, os.stat(path).st_mode | stat.S_IXUSR)
    return folder


def three_views(path, empty=False):
    """Grey squares, in the second view with red in it."""
    views = numpy.ones((500, 1500, 3))
    if not empty:
        for view in range(3):
            views[100:400, 500 * view + 100:500 * view + 350] = 0.5
        views[200:300, 700:750] = 0.9, 0.1, 0.1
    pyplot.imsave(path, views)
    return path


def pictures_are_made(scratch):
    """From three views the one with red; what is there is made anew; what cannot be had is told."""
    scenes, folder = os.path.join(scratch, "scenes"), os.path.join(scratch, "made")
    os.makedirs(os.path.join(scenes, "rod-500-60"))
    with open(os.path.join(scenes, "rod-500-60", "meta.txt"), "w", encoding="ascii") as file:
        file.write("498 260 60\n")
    views = three_views(os.path.join(scratch, "views.png"))
    good = fake_programs(os.path.join(scratch, "good"), views)
    none = fake_programs(os.path.join(scratch, "none"), None)
    empty = fake_programs(os.path.join(scratch, "empty"), three_views(os.path.join(scratch, "white.png"), True))

    def make(programs, triangles=498, frames=60):
        return report_pictures.make(pyplot, programs, scenes, folder, "rod", triangles, frames, 7)

    expect(make(good) == "", "a picture is made")
    picture = report_pictures.load(pyplot, folder, "rod", 498, 7)
    expect(picture is not None, "and there")
    if picture is not None:
        height, width = picture.shape[:2]
        expect(max(height, width) <= report_pictures.SIZE and abs(width / height - 258 / 308) < 0.02,
               "without its border, and small: %d × %d" % (width, height))
        expect((picture[..., 0] - picture[..., 1]).max() > 0.5, "with what is red")
    expect("no browser" in make(none), "no browser is told")
    expect(report_pictures.load(pyplot, folder, "rod", 498, 7) is None, "and an older picture is not taken for it")
    expect("empty" in make(empty), "an empty picture is told")
    expect("no such scene" in make(good, triangles=499), "so is a scene of another size")
    expect("no such scene" in make(good, frames=6), "or of other frames")
    expect(make(os.path.join(scratch, "absent")) != "", "or programs that are not there")


def without(path, endings):
    """The CSV file as older versions wrote it: without columns of those endings."""
    with open(path, encoding="utf-8", newline="") as file:
        lines = file.read().splitlines()
    head = [line for line in lines if line.startswith("#")]
    rows = list(csv.reader(line for line in lines if not line.startswith("#")))
    kept = [i for i, name in enumerate(rows[0]) if not name.endswith(endings)]
    assert len(kept) < len(rows[0]), path
    with open(path, "w", encoding="utf-8", newline="") as file:
        file.write("".join(line + "\n" for line in head))
        csv.writer(file, lineterminator="\n").writerows([row[i] for i in kept] for row in rows)


def new_results(folder, scratch):
    """Bands and pictures, then neither."""
    here = os.path.join(scratch, "results")
    shutil.copytree(folder, here)
    results = draw_report.Results(here)
    wanted = report_plots.wanted_pictures(results.frames)
    os.makedirs(os.path.join(here, "pictures"), exist_ok=True)
    for scene, triangles, _, frame in wanted:
        pyplot.imsave(report_pictures.path_of(here, scene, triangles, frame), numpy.full((30, 20, 3), 0.5))
    plots = draw_report.draw_figures(pyplot, results, here)
    expect(sorted(plots) == ["frames", "near", "scaling"], "three plots are drawn, not " + ", ".join(plots))
    for name, plot in plots.items():
        look(name, plot)
        expect("ands: " in text_of(plot), "%s says what its bands are: %s" % (name, text_of(plot)))
        expect("Pictures: " in text_of(plot), "%s says what its pictures are" % name)
        expect(len(pictures_of(plot)) == len(wanted), "%s has a picture of each scene" % name)
        for axis in plot.axes:
            lines = [line for line in curves_of(axis) if line.get_label().split()[0] not in
                     ("hash", "Candidates", "NormalCollisions")]
            items = bands_of(axis)
            expect(len(items) == len(lines), "%s: %d bands of %d lines" % (name, len(items), len(lines)))
            expect(all(holds(item, line) for item, line in zip(items, lines)), "%s: lines are in bands" % name)
        pyplot.close(plot)

    for name in ("frames.csv", "summary.csv", "near.csv"):
        without(os.path.join(here, name), ("_max", "of_maxima_ms"))
    shutil.rmtree(os.path.join(here, "pictures"))
    plots = draw_report.draw_figures(pyplot, draw_report.Results(here), here)
    expect(sorted(plots) == ["frames", "near", "scaling"], "three plots are drawn of older files")
    for name, plot in plots.items():
        look(name + " of older files", plot)
        expect("ands" not in text_of(plot) and not any(bands_of(axis) for axis in plot.axes),
               "%s of older files has no bands, and says nothing of them" % name)
        expect("No pictures" in text_of(plot) and not pictures_of(plot), "%s without pictures says so" % name)
        pyplot.close(plot)


def committed(folder):
    results = draw_report.Results(folder)
    for scene, triangles, _, frame in report_plots.wanted_pictures(results.frames):
        expect(report_pictures.load(pyplot, folder, scene, triangles, frame) is not None,
               "%s has a picture of %s, %d triangles, frame %d" % (folder, scene, triangles, frame))
    for name, plot in draw_report.draw_figures(pyplot, results, folder).items():
        look("%s/%s" % (folder, name), plot)
        expect(len(pictures_of(plot)) >= 1, "%s/%s shows pictures" % (folder, name))
        pyplot.close(plot)


def main():
    checker_sees()
    with tempfile.TemporaryDirectory() as scratch:
        pictures_are_made(scratch)
        new_results(sys.argv[1], scratch)
    for folder in sys.argv[2:]:
        committed(folder)
    sys.exit(1 if failures else 0)


main()

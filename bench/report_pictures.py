"""Pictures of scenes, for the plots that draw_report.py makes: one frame each, colliding faces red.

sc-query --png draws three views of a frame, by a Chromium that is installed; the one that shows most red is
kept, as pictures/SCENE-TRIANGLES-FRAME.png beside the CSV files. So who draws the plots anew needs no browser.

SPDX-License-Identifier: MIT
"""

import glob
import os
import subprocess
import sys
import tempfile

SIZE = 240  # pixels at most, of width and height


def path_of(folder, scene, triangles, frame):
    return os.path.join(folder, "pictures", "%s-%d-%d.png" % (scene, triangles, frame))


def cached(scenes, scene, triangles, frames):
    """The folder of a scene that sc-bench keeps, or None. Its name has the triangles that were asked for, and
    meta.txt those that there are."""
    for folder in sorted(glob.glob(os.path.join(scenes, "%s-[0-9]*-%d" % (scene, frames)))):
        try:
            with open(os.path.join(folder, "meta.txt"), encoding="ascii") as file:
                if int(file.read().split()[0]) == triangles:
                    return folder
        except (OSError, ValueError, IndexError):
            pass
    return None


def best_view(three):
    """Of three square views side by side the one with most red, or most of the mesh; without its white border."""
    height, width = three.shape[0], three.shape[1] // 3
    views = [three[:, i * width:(i + 1) * width, :3] for i in range(3)]

    def rank(view):
        red = (view[..., 0] > 0.7) & (view[..., 1] < 0.35) & (view[..., 2] < 0.35)
        return red.sum(), (view.min(axis=2) < 1).sum()

    view = max(views, key=rank)
    inked = view.min(axis=2) < 1
    rows, columns = inked.any(axis=1).nonzero()[0], inked.any(axis=0).nonzero()[0]
    if not len(rows):
        return None
    return view[max(rows[0] - 4, 0):min(rows[-1] + 5, height), max(columns[0] - 4, 0):min(columns[-1] + 5, width)]


def run(command):
    """"" or the last line of what the program said."""
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    except OSError as error:
        return str(error)
    lines = done.stdout.decode("utf-8", "replace").strip().splitlines()
    # sc-query's status is 1 where faces collide
    return "" if done.returncode in (0, 1) else lines[-1] if lines else "%s failed" % command[0]


def make(pyplot, programs, scenes, folder, scene, triangles, frames, frame):
    """Makes a picture anew with the programs in that folder; "" or why it is not there. scenes: sc-bench's cache."""
    from PIL import Image  # matplotlib needs it, too
    path = path_of(folder, scene, triangles, frame)
    if os.path.exists(path):
        os.remove(path)
    source = cached(scenes, scene, triangles, frames)
    if not source:
        return "no such scene in %s" % scenes
    with tempfile.TemporaryDirectory() as scratch:
        drawn = os.path.join(scratch, "drawn.png")
        mesh = os.path.join(scratch, "obj", "frame_%04d.obj" % frame)
        said = run([os.path.join(programs, "sc-bench"), "--scene-dir", source, "--frame", str(frame),
                    "--export-obj", os.path.dirname(mesh)])
        said = said or run([os.path.join(programs, "sc-query"), "--png", drawn, mesh])
        if said or not os.path.exists(drawn):
            return (said or "no picture was written").replace(drawn + ": ", "")
        view = best_view(pyplot.imread(drawn))
    if view is None:
        return "the picture is empty"
    picture = Image.fromarray((255 * view).round().astype("uint8"))
    picture.thumbnail((SIZE, SIZE), Image.LANCZOS)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    picture.save(path, optimize=True)
    return ""


def make_all(pyplot, programs, scenes, folder, wanted):
    """wanted: (scene, triangles, frames, frame). Says on standard error what cannot be had, and why."""
    for scene, triangles, frames, frame in wanted:
        said = make(pyplot, programs, scenes, folder, scene, triangles, frames, frame)
        if said:
            print("draw_report.py: no picture of %s: %s" % (scene, said), file=sys.stderr)


def load(pyplot, folder, scene, triangles, frame):
    """The picture as an array, or None."""
    path = path_of(folder, scene, triangles, frame)
    return pyplot.imread(path) if os.path.exists(path) else None

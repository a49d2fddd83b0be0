#!/bin/sh
# The drivers of bench/peers, without any peer: scenes are read and refused as they say, lines have
# their columns, and a peer that is absent is skipped with a message. The compiled one is linked
# with the triangle test of peers that bring none, which must find the pairs that the library finds.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

columns=scene,triangles,frame,peer,version,what,threads,ms,pairs,matches,ms_min,missing,extra,beside,processors
scene=$scratch/touching

# Four triangles in a plane, two that stand on it, one that crosses it; then the last three go away.
# Of the eight bytes of these doubles only the last two are not zero.
doubles() {
    for number in "$@"; do
        case $number in
        -1) printf '\0\0\0\0\0\0\360\277' ;;
        0) printf '\0\0\0\0\0\0\0\0' ;;
        1) printf '\0\0\0\0\0\0\360\077' ;;
        2) printf '\0\0\0\0\0\0\0\100' ;;
        3) printf '\0\0\0\0\0\0\010\100' ;;
        4) printf '\0\0\0\0\0\0\020\100' ;;
        9) printf '\0\0\0\0\0\0\042\100' ;;
        nan) printf '\0\0\0\0\0\0\370\177' ;;
        esac
    done
}
indices() {
    # shellcheck disable=SC2059
    for number in "$@"; do printf "\\$(printf %03o "$number")\\0\\0\\0"; done
}
still="0 0 0 4 0 0 0 4 0  1 1 0 2 1 0 1 2 0  4 0 0 4 4 0 0 4 0  4 0 0 9 0 0 9 -1 0"
mkdir "$scene"
echo "7 21 2" >"$scene/meta.txt"
indices 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 >"$scene/tris.u32"
# shellcheck disable=SC2086
{
    doubles $still  1 1 0 1 1 2 2 1 2  0 2 0 3 2 0 1 2 3  3 3 -1 3 3 1 4 3 1
    doubles $still  1 1 1 1 1 2 2 1 2  0 2 1 3 2 1 1 2 3  9 9 -1 9 9 1 9 4 1
} >"$scene/frames.f64"

# Pairs in frame 0: in the plane 0-1 (inside), 0-2 (along an edge), 0-3, 2-3 (at a corner); a corner
# of 4 in 0 and on 1; an edge of 5 in 0 and 2 and at 1; 2-6 cross. In frame 1 the first four.
pairs_0=10
pairs_1=4

# found FILE PEER WHAT FRAME: pairs and whether they match, in a line of a CSV file.
found() {
    awk -F, -v peer="$2" -v what="$3" -v frame="$4" \
        '$4 == peer && index($6, what) == 1 && $3 == frame { print $9, $10 }' "$1"
}

# rows FILE: it has the columns, and fifteen fields in each line.
rows() {
    test "$(head -n 1 "$1")" = "$columns" && awk -F, 'NF != 15 { exit 1 }' "$1" &&
        awk -F, 'NR > 1 && !($8 > 0 && $11 > 0 && $11 <= $8) { exit 1 }' "$1"
}

status() {
    wanted=$1
    shift
    "$@"
    test $? -eq "$wanted"
}

# lacks "words" FILE
lacks() {
    ! grep -q "$1" "$2"
}

# says "words" command...
says() {
    words=$1
    shift
    "$@" 2>&1 | tee "$scratch/said"
    grep -qF -e "$words" "$scratch/said"
}

# refused DRIVER...: what is wrong with a scene or an option is said, and the exit status is 2.
refused() {
    mkdir -p "$scratch/wrong"
    cp "$scene"/* "$scratch/wrong"
    check "$1: no scene" status 2 "$@"
    check "$1: an unknown option" status 2 "$@" --speed 3 "$scene"
    check "$1: no repeats" status 2 "$@" --repeats 0 "$scene"
    check "$1: no folder" status 2 "$@" "$scratch/absent"
    echo "7 21" >"$scratch/wrong/meta.txt"
    check "$1: two numbers in meta.txt" says "meta.txt: " "$@" "$scratch/wrong"
    echo "7 21 3" >"$scratch/wrong/meta.txt"
    check "$1: fewer frames than said" says "not as long as" "$@" "$scratch/wrong"
    echo "7 20 2" >"$scratch/wrong/meta.txt"
    check "$1: a vertex that does not exist" says "no such vertex" "$@" "$scratch/wrong"
    cp "$scene/meta.txt" "$scratch/wrong"
    # shellcheck disable=SC2046
    doubles $(yes nan | head -n 126) >"$scratch/wrong/frames.f64"
    check "$1: positions that are no numbers" says "not finite" "$@" "$scratch/wrong"
    rm "$scratch/wrong/frames.f64"
    check "$1: no positions" says "frames.f32: " "$@" "$scratch/wrong"
}

# ------------------------------------------------------------------------------------------------
# The compiled driver. The folder of the build is two above, or one with another config.

build=$(dirname "$SC_LIB")
[ "$SC_CONFIG" != release ] || build=$build/release
brute=$build/peers/brute
csv=$scratch/brute.csv
check "the driver builds" "$MAKE" --no-print-directory config="$SC_CONFIG" "$brute"
check "it measures" "$brute" --repeats 3 --csv "$csv" "$scene/"
check "its lines have their columns" rows "$csv"
check "a line for each frame and method" test "$(wc -l <"$csv")" -eq 10
for frame in 0 1; do
    eval "pairs=\$pairs_$frame"
    check "starcontour finds $pairs pairs in frame $frame" \
        test "$(found "$csv" starcontour exact $frame)" = "$pairs yes"
    check "and with star contours" \
        test "$(found "$csv" starcontour star $frame)" = "$pairs yes"
    check "and with boxes" test "$(found "$csv" starcontour aabb $frame)" = "$pairs yes"
    check "and so does the triangle test" \
        test "$(found "$csv" brute "all pairs" $frame)" = "$pairs yes"
done
check "it adds to a file" "$brute" --frames 1 --repeats 1 --csv "$csv" "$scene"
check "with one heading" test "$(grep -c '^scene,' "$csv")/$(wc -l <"$csv")" = 1/15
echo "# commit: unknown" >"$scratch/begun.csv"
check "and to one that has none but remarks" \
    "$brute" --frames 1 --repeats 1 --csv "$scratch/begun.csv" "$scene"
check "which gets a heading" test "$(sed -n 2p "$scratch/begun.csv")" = "$columns"
check "it prints lines where no file is named" says "touching,7,0,brute," "$brute" "$scene"
check "one thread is all this one uses" says "skipped: brute" "$brute" --threads 2 "$scene"
refused "$brute"

# Triangles of random points of a coarse grid, in one plane in some frames: they touch in all ways.
soup() {
    python3 -S - "$1" <<'END'
import os, random, struct, sys
random.seed(7)
folder, vertices, triangles, frames = sys.argv[1], 60, 150, 6
poses = []
for frame in range(frames):
    step = 1.0 if frame < 3 else 0.1
    pose = [[random.randint(0, 6) * step for _ in range(3)] for _ in range(vertices)]
    for point in pose:
        if frame % 3 == 0:
            point[frame % 2] = 3.0
        elif frame % 3 == 1:
            point[2] = point[0] + point[1]
    poses.append(pose)

def flat(a, b, c):
    u, v = ([q[k] - a[k] for k in range(3)] for q in (b, c))
    return max(abs(u[k] * v[k - 1] - u[k - 1] * v[k]) for k in range(3)) < 1e-6

chosen = []
while len(chosen) < triangles:
    corners = random.sample(range(vertices), 3)
    if not any(flat(*(pose[v] for v in corners)) for pose in poses):
        chosen.append(corners)
os.mkdir(folder)
with open(folder + "/meta.txt", "w") as file:
    print(triangles, vertices, frames, file=file)
with open(folder + "/tris.u32", "wb") as file:
    file.writelines(struct.pack("<3I", *corners) for corners in chosen)
with open(folder + "/frames.f64", "wb") as file:
    file.writelines(struct.pack("<3d", *point) for pose in poses for point in pose)
END
}
if command -v python3 >/dev/null 2>&1; then
    check "a soup that touches in all ways is made" soup "$scratch/soup"
    check "the triangle test finds our pairs in it" \
        "$brute" --repeats 1 --csv "$scratch/soup.csv" "$scratch/soup"
    check "and there are some in all frames" awk -F, '$9 == 0 { exit 1 }' "$scratch/soup.csv"
else
    skip "the triangle test on a soup: there is no python3"
fi

# Several objects: one that moves and is asked about itself, its first frame standing still, and it
# again. Two of the same pose have each pair in both orders, and each triangle with itself.
many=$scratch/many
mkdir -p "$many/still"
cp -r "$scene" "$many/moving"
cp -r "$scene" "$many/again"
cp "$scene/tris.u32" "$many/still"
echo "7 21 1" >"$many/still/meta.txt"
head -c $((21 * 24)) "$scene/frames.f64" >"$many/still/frames.f64"
printf 'moving 1\nstill 0\nagain 0\n' >"$many/objects.txt"
check "the driver takes several objects" "$brute" --repeats 3 --csv "$scratch/many.csv" "$many/"
check "their lines have their columns" rows "$scratch/many.csv"
check "a line for each frame of both" test "$(wc -l <"$scratch/many.csv")" -eq 5
between=$((2 * pairs_0 + 7))
check "all pairs of two objects, and of the first with itself" test \
    "$(found "$scratch/many.csv" starcontour objects 0)" = "$((pairs_0 + 3 * between)) yes"
for frame in 0 1; do
    check "the triangle test finds them in frame $frame" test \
        "$(found "$scratch/many.csv" brute "all pairs" $frame)" = \
        "$(found "$scratch/many.csv" starcontour objects $frame)"
done
check "in frame 1 there are fewer" test "$(found "$scratch/many.csv" brute "" 1)" != \
    "$(found "$scratch/many.csv" brute "" 0)"
for line in "moving" "moving 2" "moving 1 more" "absent 1"; do
    echo "$line" >"$many/objects.txt"
    check "a list with '$line'" status 2 "$brute" "$many"
done
: >"$many/objects.txt"
check "a list without objects is said" says "no objects" "$brute" "$many"

# ------------------------------------------------------------------------------------------------
# The Python driver. Without site-packages (-S) there are no peers.

script=bench/peers/peers.py
if ! command -v python3 >/dev/null 2>&1; then
    skip "peers.py: there is no python3"
else
    python3 -B -S "$script" --list | sed 's/ .*//' >"$scratch/listed"
    sed -n 's/^peer-\([a-z0-9-]*\):.*PyPI.*/\1/p' Makefile | sort >"$scratch/targets"
    check "peers.py lists what make has targets for" diff "$scratch/listed" "$scratch/targets"
    check "and there are some" test -s "$scratch/listed"
    for peer in $(cat "$scratch/listed"); do
        check "$peer has a version" grep -q "^$peer==[0-9]" bench/peers/requirements.txt
        check "$peer is skipped where it is absent" says "skipped: $peer on touching: " \
            python3 -B -S "$script" --peer "$peer" --lib unused --csv "$scratch/skipped.csv" "$scene"
        check "and the file says so" grep -q "^# skipped: $peer on touching: " "$scratch/skipped.csv"
    done
    cat >"$scratch/members.py" <<'END'
import re, sys
sys.path.insert(0, "bench/peers")
import peers
header = open("include/starcontour.h").read()
header = re.sub(r"/\*.*?\*/", "", header, flags=re.S)
for name in ("sc_mesh", "sc_pose", "sc_build_options", "sc_query_options", "sc_result",
             "sc_workspace_options", "sc_step_options", "sc_step_result"):
    body = re.search(r"typedef struct %s {(.*?)} %s;" % (name, name), header, re.S).group(1)
    wanted = [re.search(r"(\w+)\s*$", member).group(1)
              for line in body.split(";") for member in line.split(",") if member.strip()]
    members = [field[0] for field in getattr(peers, name)._fields_]
    assert members == wanted[:len(members)], (name, wanted)  # new ones come last and may lack
for name, value in vars(peers).items():
    if name.startswith("SC_"):
        assert re.search(r"\b%s =\s+%d\b" % (name, value), header), name
END
    check "its structures and values are the header's" python3 -B -S "$scratch/members.py"
    library=$(ls "$SC_LIB/libstarcontour.so" "$SC_LIB/libstarcontour.dylib" 2>/dev/null | head -n 1)
    if [ -z "$library" ] || [ "$SC_CONFIG" = sanitize ]; then
        skip "peers.py asking starcontour: no shared library that Python can load"
    else
        ask="python3 -B -S $script --peer starcontour --lib $library"
        csv=$scratch/python.csv
        # shellcheck disable=SC2086
        check "peers.py measures" $ask --repeats 3 --csv "$csv" "$scene/"
        check "its lines have their columns" rows "$csv"
        check "a line for each frame and method" test "$(wc -l <"$csv")" -eq 7
        echo "# commit: unknown" >"$scratch/begun.csv"
        # shellcheck disable=SC2086
        check "peers.py adds to a file" $ask --repeats 1 --csv "$scratch/begun.csv" "$scene"
        check "which gets a heading" test "$(sed -n 2p "$scratch/begun.csv")" = "$columns"
        for frame in 0 1; do
            eval "pairs=\$pairs_$frame"
            check "starcontour finds $pairs pairs in frame $frame, from Python" \
                test "$(found "$csv" starcontour exact $frame)" = "$pairs yes"
            check "and with star contours" \
                test "$(found "$csv" starcontour star $frame)" = "$pairs yes"
            check "and with boxes" test "$(found "$csv" starcontour aabb $frame)" = "$pairs yes"
        done
        # A corner that falls through a triangle, from 1 above to 1 below.
        falling=$scratch/falling
        mkdir "$falling"
        echo "2 6 2" >"$falling/meta.txt"
        indices 0 1 2 3 4 5 >"$falling/tris.u32"
        doubles 0 0 0 4 0 0 0 4 0  1 1 1 2 1 4 1 2 4  0 0 0 4 0 0 0 4 0  1 1 -1 2 1 2 1 2 2 \
            >"$falling/frames.f64"
        # step PART: candidates, the free part of the step, and pairs at its start.
        step() {
            rm -f "$scratch/step.csv"
            # shellcheck disable=SC2086
            $ask --step "$1" --from 0 --repeats 1 --csv "$scratch/step.csv" "$falling" >"$scratch/step.log" &&
                rows "$scratch/step.csv" &&
                awk -F, -v step="step $1: " 'NR > 1 {
                        if (index($6, step) != 1) exit 1
                        found[substr($6, length(step) + 1)] = $9
                    }
                    END { print (found["candidates"] > 0), sprintf("%.4f", found["time of impact"]),
                        found["pairs at the start"] }' "$scratch/step.csv"
        }
        check "a whole step is free until half of it" test "$(step 1 2>/dev/null)" = "1 0.5000 0"
        check "a part of a step until later" test "$(step 5/8 2>/dev/null)" = "1 0.8000 0"
        check "a small step is free" test "$(step 1/50 2>/dev/null)" = "0 1.0000 0"
        cat >"$scratch/judge.py" <<'END'
import fractions, sys
sys.path.insert(0, "bench/peers")
import peers
scene = peers.Scene(sys.argv[1])
ours = peers.Starcontour(sys.argv[2], scene, "d")
for part, free, wanted in ((1, 0.4, (0, 0)), (1, 0.6, (1, 0)), (1, 1, (1, 0)),
                           (fractions.Fraction(1, 50), 1, (0, 0)),
                           (fractions.Fraction(1, 50), 0.9, (0, 1))):
    scene.part = part
    expected = peers.Expected(ours, scene.frame(0, "d"), scene.end(0, "d"))
    assert expected.judge(peers.TIME, free) == wanted, (part, free)
END
        check "a time after the first contact is wrong, and one in a free step too small" \
            python3 -B -S "$scratch/judge.py" "$falling" "$library"
        # Triangles 2 and 6 meet at 2-6 alone, which is taken here for a pair with a common vertex.
        cat >"$scratch/faces.py" <<'END'
import sys
sys.path.insert(0, "bench/peers")
import dataset, peers
scene = peers.Scene(sys.argv[1])
scene.adjacent = lambda a, b: (a, b) == (2, 6)
ours = peers.Starcontour(sys.argv[2], scene, "d")
expected = [peers.Expected(ours, scene.frame(f, "d"), None) for f in (0, 1)]
for frame, faces, wanted in ((0, range(6), (0, 0)), (0, range(7), (0, 0)), (0, (0, 6), (5, 0)),
                             (1, range(4), (0, 0)), (1, (0, 1, 2, 3, 5, 6), (0, 2)), (1, (), (4, 0))):
    assert expected[frame].judge(peers.FACES, list(faces)) == wanted, (frame, faces)
assert not dataset.is_wrong(expected[0], peers.FACES, [0])
assert dataset.is_wrong(expected[0], peers.FACES, [])
assert not dataset.is_wrong(expected[1], peers.APART, [(0, 1)])
assert dataset.is_wrong(expected[1], peers.APART, [])
assert dataset.is_wrong(expected[1], peers.ANY_APART, False)
expected[1].all = [(2, 6)]
for answer in ([], [2, 6]):
    assert not dataset.is_wrong(expected[1], peers.FACES, answer)
assert dataset.is_wrong(expected[1], peers.APART, [(2, 6)])
expected[1].all = []
assert dataset.is_wrong(expected[1], peers.FACES, [2, 6])
assert not dataset.is_wrong(expected[1], peers.ANY_APART, False)
tally = dataset.Tally(peers.Way("some", peers.APART, None))
tally.add(expected[0], expected[0].apart()[1:])
tally.add(expected[0], expected[0].apart() + [(0, 6)])
tally.add(expected[1], [(0, 6)])
assert (tally.colliding, tally.wrong, tally.missing, tally.extra, tally.unequal) == (2, 1, 1, 2, 3)
END
        check "answers that name triangles, and verdicts on poses" \
            python3 -B -S "$scratch/faces.py" "$scene" "$library"
        check "a dataset's peer is skipped where it is absent" says "skipped: libigl: " \
            python3 -B -S bench/peers/dataset.py --peer libigl --lib "$library" --csv "$scratch/poses.csv" "$scene"
        check "and its file says so" grep -q "^# skipped: libigl: " "$scratch/poses.csv"
        cat >"$scratch/curves.py" <<'END'
import math, re, sys
sys.path.insert(0, "bench/peers")
import numpy as np
import peers, trace_curves as tc
header = re.sub(r"/\*.*?\*/", "", open("include/starcontour.h").read(), flags=re.S)
for name, members in (("sc_trace_node", tc.NODE.names), ("sc_trace_contour", tc.CONTOUR.names),
                      ("sc_trace_result", [field[0] for field in tc.sc_trace_result._fields_])):
    body = re.search(r"typedef struct %s {(.*?)} %s;" % (name, name), header, re.S).group(1)
    wanted = [re.search(r"(\w+)\s*(\[\d\])?$", member.strip()).group(1)
              for line in body.split(";") for member in line.split(",") if member.strip()]
    assert list(members) == wanted, (name, members, wanted)
# In frame 1 a corner of one triangle is through the other: a curve from border to border.
scene = peers.Scene(sys.argv[2])
ours, poses = tc.Trace(sys.argv[3], scene, "d"), [scene.frame(f, "d") for f in (0, 1)]
length = math.sqrt(2) / 3
assert ours.pairs(poses[0]) == 0 and ours.pairs(poses[1]) == 2
ours.contours_of(poses[1])
assert not ours.touches(poses[1])
for lengths, closed, same in (([length], [False], True), ([length], [True], False), ([], [], False),
                              ([length * (1 + 1e-9)], [False], False),
                              ([length * (1 + 5e-13)], [False], True),
                              ([length / 2, length / 2], [False, False], False)):
    assert ours.judge(poses[1], tc.Curves(lengths, closed)) == same, (lengths, closed)
touching = peers.Scene(sys.argv[1])
assert tc.Trace(sys.argv[3], touching, "d").touches(touching.frame(0, "d"))
# The same, cut by hand at p and q.
vertices, corners = np.array(poses[1]).reshape(-1, 3), np.array(scene.corners).reshape(-1, 3)
points = np.vstack([vertices, [[4 / 3, 1, 0], [1, 4 / 3, 0]]])
p, q = 6, 7
faces = np.array([(0, 1, p), (0, p, q), (0, q, 2), (1, 2, q), (1, q, p), (3, p, q), (p, 4, 5), (p, 5, q)])
births = np.array([0] * 5 + [1] * 3)
found = tc.by_triangles(points, faces, births, corners, vertices)
assert ours.judge(poses[1], found), (found.closed, found.open)
assert tc.by_triangles(points, faces[[1, 4, 5]], births[[1, 4, 5]], corners, vertices) is None
# A cycle in two parts, and three lines through a point, of which one comes back to it: all but that
# one are open. What ends at a vertex of the mesh is not joined.
def line(*points):
    return np.array(points, float)
o = (0, 0, 0)
lines = [line((5, 0, 0), (6, 0, 0), (6, 1, 0)), line((6, 1, 0), (5, 1, 0), (5, 0, 0)),
         line(o, (1, 0, 0), (1, 0, 9), (-1, 0, 9), (-1, 0, 0), o), line((0, -1, 0), o), line(o, (0, 2, 0)),
         line((1, 1, 1), o), line(o, (-1, -1, -1))]
found = tc.by_directions(lines, vertices[3:])
assert np.allclose(found.closed, [4, 22]) and np.allclose(found.open, [3, 12 ** 0.5]), (found.closed, found.open)
found = tc.by_directions(lines, line(o, (6, 0, 0)))
assert not len(found.closed) and len(found.open) == 6, (found.closed, found.open)
END
        if python3 -c 'import numpy' 2>/dev/null; then
            check "curves put together of parts, and what is the same" \
                python3 -B "$scratch/curves.py" "$scene" "$falling" "$library"
            check "a peer of contours is skipped where it is absent" says "skipped: cgal on falling: " \
                python3 -B bench/peers/trace_curves.py --peer cgal --cgal absent --lib "$library" \
                --csv "$scratch/trace.csv" "$falling"
            check "and its file says so" grep -q "^# skipped: cgal on falling: " "$scratch/trace.csv"
        else
            skip "curves put together of parts: there is no numpy"
        fi
        # shellcheck disable=SC2086
        check "no step from the last frame" says "none follows" $ask --step 1/50 --from 0,1 "$falling"
        for part in 0 2 1/0 much; do
            # shellcheck disable=SC2086
            check "no step by $part" says "--step: a part" $ask --step $part "$falling"
        done
        # shellcheck disable=SC2086
        check "--from needs a step" says "--from goes with" $ask --from 0 "$falling"
        # shellcheck disable=SC2086
        check "--from takes frames" says "--from: numbers" $ask --step 1/50 --from all "$falling"
        # shellcheck disable=SC2086
        refused $ask
    fi
fi

# ------------------------------------------------------------------------------------------------
# What make says where something is absent.

check "make skips a library that is absent" says "skipped: peer-fcl: fcl/config.h not found" \
    "$MAKE" --no-print-directory peer-fcl CPPFLAGS=-nostdinc CSV="$scratch/absent/peers.csv"
check "and so does the file" grep -q "^# skipped: fcl: fcl/config.h" "$scratch/absent/peers.csv"
no_python() {
    PATH=$scratch/empty /bin/sh bench/peers/venv.sh "$scratch/venv" ipctk "$scratch/absent.csv"
}
check "no python3 is said" says "skipped: peer-ipctk: there is no python3" no_python
check "and has a status of its own" status 3 no_python
unmade() {
    ! bench/peers/measure_dataset.sh "$scratch/poses/dataset.csv" absent absent "$scratch/built" 2>/dev/null
}
check "poses that cannot be made are an error" unmade
check "no scene is said" says "SCENES names folders" bench/peers/measure_peer.sh some "$scratch/x.csv" "" absent true
check "and is an error" status 2 bench/peers/measure_peer.sh some "$scratch/x.csv" "" absent true
measured() {
    MEMORY=unlimited bench/peers/measure_peer.sh brute "$scratch/driven.csv" "$scene" absent "$brute" --repeats 1 &&
        test "$(grep -c '^scene,' "$scratch/driven.csv")" -eq 1 &&
        test "$(grep -c '^touching,' "$scratch/driven.csv")" -eq 9
}
check "measure_peer.sh runs a peer on a scene" measured
if command -v timeout >/dev/null 2>&1; then
    ended() {
        LIMIT=0.1 bench/peers/measure_peer.sh slow "$scratch/slow.csv" "$scene" absent sh -c 'sleep 5' &&
            grep -q '^# skipped: slow on touching: took more than 0.1 s' "$scratch/slow.csv"
    }
    check "and ends one that takes too long" ended
else
    skip "ending a peer that takes too long: there is no timeout"
fi
check "an unusable limit of memory is said" says "MEMORY is a number of GB" \
    env MEMORY=much bench/peers/measure_peer.sh some "$scratch/x.csv" "$scene" absent true
check "and is an error" status 2 \
    env MEMORY=much bench/peers/measure_peer.sh some "$scratch/x.csv" "$scene" absent true
# The fake peer leaves a line before it fails, which must not be taken.
fails() {
    MEMORY=$1 bench/peers/measure_peer.sh greedy "$scratch/greedy.csv" "$scene" absent \
        sh -c "while [ \"\$1\" != --csv ]; do shift; done; echo a line >\"\$2\"; $2" greedy
}
check "a peer that fails for another reason is a failure" status 5 fails 4 "echo broken >&2; exit 5"
check "which is not called a lack of memory" lacks memory "$scratch/greedy.csv"
check "and one without memory is, where there is no limit" \
    status 5 fails unlimited "echo MemoryError >&2; exit 5"
if ! command -v python3 >/dev/null 2>&1 || ! (ulimit -v 1000000) 2>/dev/null; then
    skip "ending a peer that takes too much memory: there is no python3, or no limit of memory"
else
    greedy() {
        rm -f "$scratch/greedy.csv"
        fails 1 "exec python3 -S -c 'bytearray(2 * 10**9)'" &&
            grep -q '^# skipped: greedy on touching: needed more than 1 GB of memory' "$scratch/greedy.csv" &&
            lacks "a line" "$scratch/greedy.csv"
    }
    check "and one that takes too much memory is ended" greedy
    modest() {
        rm -f "$scratch/greedy.csv"
        fails 4 "exec python3 -S -c 'bytearray(2 * 10**9)'" && lacks skipped "$scratch/greedy.csv"
    }
    check "but not one that stays below the limit" modest
fi

finish

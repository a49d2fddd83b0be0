#!/bin/sh
# Many meshes by sc-query --jsonl: the same bytes by one process or several, in one piece or in
# shards, in one run or in runs that are killed; meshes that are refused, crash their reader or take
# too long; files that are not gone on with. And the same by GNU parallel, if that is there.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

query=$SC_BIN/sc-query
if [ ! -x "$query" ]; then
    skip "sc-query was not built"
    check "there is something to skip" test ! -x "$query"
    finish
fi
query=$(cd "$SC_BIN" && pwd)/sc-query
top=$(pwd)
out=$scratch/out.jsonl
list=$scratch/list

# 120 meshes: six of them again and again, one not there, one broken. Lines end as on Windows, too.
echo "v 0 0" >"$scratch/broken.obj"
for i in $(seq 15); do
    for mesh in crossing_cloths sphere folded_sheet touching_cubes moebius twisted_strip; do
        echo "$top/meshes/$mesh.obj"
    done
    printf '%s\r\n\n' "$scratch/absent.obj"
    echo "$scratch/broken.obj"
done >"$list"
batch() { # FILE OPTION...
    to=$1
    shift
    "$query" --jsonl "$to" --manifest "$list" "$@"
}
# fresh STATUS OPTION...: a run that finds the same bytes.
fresh() {
    wanted_status=$1
    shift
    rm -f "$out"
    status "$wanted_status" batch "$out" "$@" && cmp "$out" "$scratch/whole.jsonl"
}

# ---- lines ----

check "all meshes" says 2 "^120 files: 30 clean, 60 colliding, 30 refused; first .*cloths.obj; worst" \
    batch "$scratch/whole.jsonl"
check "nothing on standard error" test ! -s "$scratch/err"
check "a line each" test "$(wc -l <"$scratch/whole.jsonl")" -eq 120
sed 's/\r$//; /^$/d' "$list" >"$scratch/plain"
check "in order" sh -c "sed 's/.*\"file\":\"\([^\"]*\)\".*/\1/' '$scratch/whole.jsonl' | cmp - '$scratch/plain'"
check "refused ones say why" grep -q 'absent.obj","status":"error","error":"[^"]*No such file' \
    "$scratch/whole.jsonl"
check "no times" sh -c "! grep _ms '$scratch/whole.jsonl'"
check "again the same bytes" fresh 2
check "by several processes" fresh 2 --jobs 5
check "the list from standard input" sh -c "'$query' --jsonl '$scratch/in.jsonl' --manifest - <'$list' >/dev/null
    cmp '$scratch/in.jsonl' '$scratch/whole.jsonl'"
check "meshes on the command line" says 1 "2 files: 1 clean, 1 colliding" "$query" \
    --jsonl "$scratch/two.jsonl" meshes/sphere.obj meshes/folded_sheet.obj
check "and the status of one" status 0 "$query" --jsonl "$scratch/one.jsonl" meshes/sphere.obj
awk '/^v / && !n++ { $2 = -$2; $3 = -$3; $4 = -$4 } { print }' meshes/sphere.obj >"$scratch/pose.obj"
check "poses of a mesh" says 1 '"files":2,"clean":1,"colliding":1' "$query" --rest meshes/sphere.obj \
    --jsonl "$scratch/poses.jsonl" --json meshes/sphere.obj "$scratch/pose.obj"
check "which the lines name" grep -q '"rest":"meshes/sphere.obj"' "$scratch/poses.jsonl"
check "with times, if asked for" status 0 \
    "$query" --jsonl "$scratch/times.jsonl" --timings --stats meshes/sphere.obj
check "and statistics" grep -q '"build_ms":.*"stats":' "$scratch/times.jsonl"
python=
for one in python3 /usr/bin/python3; do
    "$one" -c 'import jsonschema; jsonschema.Draft202012Validator' >/dev/null 2>&1 && python=$one && break
done
if [ -z "$python" ]; then
    skip "lines against their schema: there is no python3 with jsonschema 4"
else
    check "lines are as the schema says" "$python" -c 'import json, sys, jsonschema
validator = jsonschema.Draft202012Validator(json.load(open("tools/starcontour.schema.json")))
for line in open(sys.argv[1]): validator.validate(json.loads(line))' "$scratch/whole.jsonl"
fi

# ---- shards ----

shards() { # N
    rm -f "$scratch"/shard.*
    for i in $(seq "$1"); do
        batch "$scratch/shard.$i" --shard "$i/$1" >/dev/null 2>&1
        test $? -lt 3 || return 1
    done
    for i in $(seq "$1"); do cat "$scratch/shard.$i"; done | cmp - "$scratch/whole.jsonl"
}
check "one shard" shards 1
check "seven" shards 7
check "more than there are meshes" shards 130
for wrong in 0/3 4/3 3 /3 1/ a/3 1/0; do
    check "shard $wrong" says 2 "--shard i/n: .* is not" batch "$scratch/wrong.jsonl" --shard $wrong
done

# ---- runs that end early ----

# lines FILE N: waits until it has so many.
lines() {
    for wait in $(seq 400); do
        [ -e "$1" ] && [ "$(wc -l <"$1")" -ge "$2" ] && return 0
        sleep 0.05
    done
    echo "waited $wait times for line $2"
    return 1
}
killed() { # JOBS
    rm -f "$out"
    for stop in 1 20 21 70 119; do
        "$query" --jsonl "$out" --manifest "$list" --jobs "$1" --resume \
            >/dev/null 2>&1 &
        lines "$out" $stop || return 1
        kill -KILL $!
        wait $!
        cut=$(wc -c <"$out")
        cmp -n "$cut" "$out" "$scratch/whole.jsonl" || return 1
    done 2>/dev/null
    says 2 "^120 files: 30 clean, 60 colliding, 30 refused" batch "$out" --resume --jobs "$1" &&
        cmp "$out" "$scratch/whole.jsonl"
}
check "killed five times" killed 1
check "killed five times, of three processes" killed 3
check "resumed when all is done" says 2 "^120 files" batch "$out" --resume
check "nothing was added" cmp "$out" "$scratch/whole.jsonl"
torn() { # BYTES [ZEROS]
    head -c "$1" "$scratch/whole.jsonl" >"$out"
    head -c "${2:-0}" /dev/zero >>"$out"
    status 2 batch "$out" --resume && cmp "$out" "$scratch/whole.jsonl"
}
size=$(wc -c <"$scratch/whole.jsonl")
first=$(head -n 1 "$scratch/whole.jsonl" | wc -c)
for bytes in 0 1 50 300 $((first - 1)) $((first)) $((size - 1)) $((size)); do
    check "a file cut after byte $bytes" torn "$bytes"
    check "and zeros behind it" torn "$bytes" 100
done

# ---- files that are not gone on with ----

kept() { # MESSAGE OPTION...
    message=$1
    shift
    cp "$out" "$scratch/before"
    says 2 "$message" "$query" --jsonl "$out" "$@" && cmp "$out" "$scratch/before"
}
head -n 30 "$scratch/whole.jsonl" >"$out"
check "without --resume" kept "is there already" --manifest "$list"
check "with other options" kept "line 1: .*other options" --manifest "$list" --resume --proper
check "with options more" kept "line 1: .*other options" --manifest "$list" --resume --ignore-rings 1
check "with contacts" kept "line 1: .*other options" --manifest "$list" --resume --contacts
check "with times" kept "line 1: .*other options" --manifest "$list" --resume --timings
check "of another shard" kept "line 1: .*that file of the list" --manifest "$list" --resume --shard 5/9
head -n 3 "$scratch/plain" >"$scratch/short"
check "of a shorter list" kept "line 4: the list ends" --manifest "$scratch/short" --resume
cp meshes/sphere.obj "$out"
check "that is a mesh" kept "line 1: .*no line of this version" --manifest "$list" --resume
printf 'v 0 0 0' >"$out"
check "without a line end" kept "does not end as" --manifest "$list" --resume
: >"$out"
check "that is read" kept "is to be read" --manifest "$out"
check "that cannot be written" says 2 "cannot be written" batch "$scratch/none/x.jsonl"
check "that is a device" says 2 "not a file" batch /dev/null --resume
check "no list" says 2 "No such file" "$query" --jsonl "$out" --manifest "$scratch/none"
head -c 99 /dev/zero >"$scratch/zeros"
check "zeros for a list" says 2 "not a list" "$query" --jsonl "$out" --manifest "$scratch/zeros"
check "options without --jsonl" says 2 "are of --jsonl" "$query" --resume meshes/sphere.obj
check "meshes and a list" says 2 "in place of" batch "$out" meshes/sphere.obj
check "threads" says 2 "in place of --threads" batch "$out" --threads 2
check "statistics without times" says 2 "with --timings" batch "$out" --stats

# ---- meshes that end their readers ----

mkfifo "$scratch/never.obj"
sphere=meshes/sphere.obj
# child: the process that reads the pipe, once the mesh before it is done.
child() {
    lines "$out" 1 || return 1
    for wait in $(seq 100); do
        child=$(cat "/proc/$run/task/$run/children" 2>/dev/null | tr -d ' ')
        [ -n "$child" ] && [ "$child" != "${1:-}" ] && return 0
        sleep 0.05
    done
    echo "waited $wait times for a process"
    return 1
}
start() {
    rm -f "$out"
    "$query" --jsonl "$out" --resume $sphere "$scratch/never.obj" $sphere >"$scratch/run.out" 2>&1 &
    run=$!
}
crash() { # SIGNAL
    start
    child && kill "-$1" "$child"
    wait $run
    test $? -eq 2 && test "$(wc -l <"$out")" -eq 3 && test "$(grep -c clean "$out")" -eq 2
}
killed_reader() {
    start
    child && kill -KILL "$child" && old=$child && child "$old" && kill -KILL "$child"
    again=$?
    wait $run
    test $? -eq 2 && test $again -eq 0 && grep -q "never.obj: ended its reader by signal 9 (SIGKILL)" "$out" &&
        test "$(wc -l <"$out")" -eq 3
}
ended_run() {
    start
    child && kill -TERM "$child"
    wait $run
    test $? -eq 2 && grep -q "ended by signal 15; --resume" "$scratch/run.out" &&
        test "$(wc -l <"$out")" -eq 1
}
locked() {
    start
    lines "$out" 1 && says 2 "another run is writing" "$query" --jsonl "$out" --resume $sphere
    answer=$?
    kill -KILL $run
    wait $run
    return $answer
}
if [ -r "/proc/$$/task/$$/children" ]; then
    check "a reader that crashes" crash SEGV
    check "is a line with the reason" grep -q \
        'never.obj: ended its reader \(by signal 11 (SIGSEGV)\|without an answer\)' "$out"
    check "one that is killed twice" killed_reader
    check "one that is told to end ends the run" ended_run
else
    skip "readers that crash: the system does not say which processes a process started" 4
fi
check "two runs do not write one file" locked 2>/dev/null
check "a reader that waits for ever" says 2 "1 clean, 0 colliding, 1 refused" \
    "$query" --jsonl "$scratch/wait.jsonl" --limit-seconds 1 "$scratch/never.obj" $sphere
check "says so" grep -q "took longer than 10 seconds\"" "$scratch/wait.jsonl"
{ printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\n' && yes 'f 1 2 3' | head -n 60000; } >"$scratch/same.obj"
check "a mesh of many pairs" says 2 "1 clean, 0 colliding, 1 refused" \
    "$query" --jsonl "$scratch/long.jsonl" --limit-seconds 1 "$scratch/same.obj" $sphere
check "takes long" grep -q "took longer than 1 seconds of processor time" "$scratch/long.jsonl"
if [ "$SC_CONFIG" != sanitize ] && command -v gzip >/dev/null 2>&1; then
    yes '# much' | head -c 300000000 | gzip -1 >"$scratch/large.obj.gz"
    check "a mesh that needs much memory" says 2 "1 clean, 0 colliding, 1 refused" \
        "$query" --jsonl "$scratch/memory.jsonl" --limit-memory 250 "$scratch/large.obj.gz" $sphere
    check "says so" grep -q "large.obj.gz: .*memory" "$scratch/memory.jsonl"
else
    skip "a limit of memory: sanitizers need more, or there is no gzip" 2
fi

# ---- a terminal ----

if command -v script >/dev/null 2>&1; then
    check "a bar on a terminal" sh -c "script -qec \"'$query' --jsonl '$scratch/bar.jsonl' \
        --manifest '$list' --jobs 2\" /dev/null </dev/null | tr '\r' '\n' >'$scratch/bar'
        grep -q '^\[#*-*\] [0-9]*/120  [0-9.]*/s  0:00:0[0-9] left  [0-9]* colliding, [0-9]* refused' '$scratch/bar'"
    check "the same bytes" cmp "$scratch/bar.jsonl" "$scratch/whole.jsonl"
else
    skip "the bar on a terminal: there is no script(1)" 2
fi

# ---- GNU parallel ----

in_parallel() {
    parallel --will-cite --version >/dev/null 2>&1 || return 1
    # Each of ten shards is killed at its first start, after some lines.
    cat >"$scratch/job" <<EOT
#!/bin/sh
file=$scratch/parallel.\$1
if [ ! -e "\$file" ]; then
    '$query' --jsonl "\$file" --manifest '$list' --shard "\$1/10" --resume &
    until [ -s "\$file" ]; do sleep 0.01; done
    kill -KILL \$!
    exit 137
fi
exec '$query' --jsonl "\$file" --manifest '$list' --shard "\$1/10" --resume
EOT
    chmod +x "$scratch/job"
    seq 10 | parallel --will-cite -j2 --retries 3 "$scratch/job" {} >/dev/null 2>&1
    for i in $(seq 10); do cat "$scratch/parallel.$i"; done | cmp - "$scratch/whole.jsonl"
}
if parallel --version 2>/dev/null | grep -q GNU; then
    check "ten shards by GNU parallel, each killed once" in_parallel
else
    skip "GNU parallel is not there ('make deps with=batch')"
fi
finish

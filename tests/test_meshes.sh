#!/bin/sh
# sc-query on meshes whose counts are known: the small ones (meshes/expected.csv) and, if `make
# meshes` could fetch them, glmark2's cat, bunny and horse. All methods and partitions, same counts.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

query=$SC_BIN/sc-query
if [ ! -x "$query" ]; then
    skip "sc-query was not built; looked for the list of meshes only"
    check "there are meshes with known counts" test -s meshes/expected.csv
    finish
fi

# counts FILE TRIANGLE_PAIRS EDGE_TRIANGLE_PAIRS OPTION...: sc-query finds so many (-: any number).
counts() {
    file=$1
    triangle=$2
    edge=$3
    shift 3
    "$query" --json "$@" "$file" >"$scratch/answer"
    status=$?
    cat "$scratch/answer"
    [ "$status" -le 1 ] || return 1
    for pair in "triangle_pairs:$triangle" "edge_triangle_pairs:$edge"; do
        [ "${pair#*:}" = - ] || grep -q "\"${pair%:*}\": *${pair#*:}[,}]" "$scratch/answer" || return 1
    done
}

# counts sees a wrong number.
wrong_count() {
    ! counts meshes/crossing_tetrahedra.obj 3 4
}
check "a wrong count is seen" wrong_count

grep -v -e '^#' -e '^name' meshes/expected.csv >"$scratch/expected"
while IFS=, read -r name _ _ triangle edge proper_triangle proper_edge; do
    check "$name" counts "meshes/$name.obj" "$triangle" "$edge"
    check "$name, proper" counts "meshes/$name.obj" "$proper_triangle" "$proper_edge" --proper
done <"$scratch/expected"

# known NAME EDGE_TRIANGLE_PAIRS: proper crossings of a fetched mesh.
known() {
    if [ ! -f "build/meshes/$1" ]; then
        skip "$1: 'make meshes' has not fetched it"
        return
    fi
    for options in "--method sctt" "--method aabb-sctt" "--method aabb" "--no-rest-cache" \
        ${SC_METIS:+"--partition metis"}; do
        # shellcheck disable=SC2086
        check "$1 $options" counts "build/meshes/$1" - "$2" --proper $options
    done
}
known cat.3ds 173
known bunny.obj 1
known horse.3ds 4

finish

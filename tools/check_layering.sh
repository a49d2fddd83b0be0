#!/bin/sh
# Checks what no compiler checks: who includes whom, names, and lib/sources.list.
#
#     tools/check_layering.sh [DIRECTORY]      default: the directory above this script
#
#   - Folders include only what `may` below allows: lib/ in the order base, simd, build, pose,
#     query, step, near, trace, run, and programs only the public headers. No "../", no circles,
#     where a header and the C file of its name count as one, nothing that does not exist. In
#     lib/simd, all_kernels.h and kernels_SET.c see all of lib/, as if they stood beside
#     starcontour.c.
#   - The oracle of the tests reaches no header of lib/, however indirectly.
#   - File names are unique (but README.md and CMakeLists.txt), and the top level holds only what
#   belongs there.
#   - lib/sources.list names each C file in lib/ once, in the order of the layers.
#   - What C files in lib/ keep to themselves has a name that no other one uses: all of them can be
#     compiled as one (tools/amalgamate.awk). Seen are functions, constants, types and macros. What
#     lib/simd/kernels_SET.c include gets names of its own for each SET there.
#
# Prints offenders, one a line; exit status 1 if there is one. Needs sh, find, sort and awk.
#
# SPDX-License-Identifier: MIT
set -u
export LC_ALL=C

cd "${1:-$(dirname "$0")/..}" || exit 2
if [ ! -f lib/sources.list ]; then
    echo "check_layering: no lib/sources.list in $PWD" >&2
    exit 2
fi

files() {
    find . -name .git -prune -o -path ./build -prune -o -type f -print | sed 's|^\./||' | sort
}

offenders=$(
    # Top level.
    for entry in *; do
        case $entry in
        Makefile | CMakeLists.txt | LICENSE) ;;
        README.md | CHANGELOG.md | CONTRIBUTING.md | SECURITY.md) ;;
        include | lib | tools | tests | bench | meshes | build) ;;
        *) echo "$entry: does not belong at the top level" ;;
        esac
    done

    # Names.
    files | awk -F/ '
        $NF == "README.md" || $NF == "CMakeLists.txt" { next }
        $NF == "__init__.py" || $NF == "requirements.txt" || $NF == "control" { next }
        /^bench\/results\// { next } # a folder for each machine, with files of the same names
        $NF in first { print $0 ": same name as " first[$NF]; next }
        { first[$NF] = $0 }' || echo "check_layering: awk failed"

    # The source list.
    {
        sed -e 's/#.*//' -e 's/[[:space:]]*$//' -e '/^$/d' -e 's/^/listed /' lib/sources.list
        files | sed -n -e '/^lib\/build\/partition_metis\.c$/d' -e 's/^\(lib\/.*\.c\)$/found \1/p'
    } | awk '
        function layer(path) {
            if (path ~ /^lib\/simd\/kernels_/) return 10
            if (path ~ /^lib\/base\//) return 1
            if (path ~ /^lib\/simd\//) return 2
            if (path ~ /^lib\/build\//) return 3
            if (path ~ /^lib\/pose\//) return 4
            if (path ~ /^lib\/query\//) return 5
            if (path ~ /^lib\/step\//) return 6
            if (path ~ /^lib\/near\//) return 7
            if (path ~ /^lib\/trace\//) return 8
            if (path ~ /^lib\/run\//) return 9
            return 10
        }
        $1 == "listed" {
            if ($2 in listed) print "lib/sources.list: names " $2 " twice"
            if (layer($2) < last) print "lib/sources.list: " $2 " stands after a higher layer"
            listed[$2] = 1
            last = layer($2)
        }
        $1 == "found" {
            found[$2] = 1
            if (!($2 in listed)) print "lib/sources.list: lacks " $2
        }
        END { for (path in listed) if (!(path in found)) print "lib/sources.list: no file " path }
    ' || echo "check_layering: awk failed"

    # Names of one file.
    files | grep '^lib/.*\.c$' |
        grep -v -e '^lib/build/partition_metis\.c$' -e '^lib/simd/kernels_' | xargs awk '
        function found(name) {
            if (name in first && first[name] != FILENAME)
                print FILENAME ": " name " is also a name of " first[name]
            first[name] = FILENAME
        }
        # static functions and constants, the end of a structure that is a type, macros, enumerators
        /^static / { if (match($0, /[A-Za-z_0-9]+(\(|\[| = )/)) { name = substr($0, RSTART, RLENGTH)
                     sub(/[^A-Za-z_0-9]+$/, "", name); found(name) } }
        /^} [A-Za-z_0-9]+;/ { name = $2; sub(/;.*/, "", name); found(name) }
        /^#define / { name = $2; sub(/\(.*/, "", name); found(name) }
        /^enum \{/, /\}/ { line = $0; sub(/^enum \{/, "", line)
                     while (match(line, /[A-Z][A-Z_0-9]* =/)) {
                         found(substr(line, RSTART, RLENGTH - 2)); line = substr(line, RSTART + RLENGTH) } }
    ' || echo "check_layering: awk failed"

    # Includes.
    files | grep -E '^(include|lib|tools|tests|bench|meshes)/.*\.(c|h|cpp|hpp|inc)$' | awk '
        function folder(path) { sub(/\/[^\/]*$/, "", path); return path }

        # A header and the C file of its name, as one.
        function unit(path) { sub(/\.[ch]$/, "", path); return path }

        # The folder whose rules hold for a file.
        function room(path) {
            return path ~ /^lib\/simd\/(all_kernels\.h|kernels_[a-z0-9]+\.c)$/ ? "lib" : folder(path)
        }

        # The file of the repository that path means by name, or "".
        function resolve(path, name,    i, candidate) {
            for (i = 0; i <= search_count; ++i) {
                candidate = (i == 0 ? folder(path) : search[i]) "/" name
                if (candidate in known) return candidate
            }
            return ""
        }

        function visit(path,    i) {
            state[path] = 1
            stack[++depth] = path
            for (i = 1; i <= edges[path]; ++i) {
                if (!(edge[path, i] in state)) visit(edge[path, i])
                else if (state[edge[path, i]] == 1) circle(edge[path, i])
            }
            --depth
            state[path] = 2
        }

        function circle(path,    i, text) {
            for (i = depth; stack[i] != path; --i) text = " -> " stack[i] text
            print path ": includes itself:" text " -> " path
        }

        function oracle(root, path,    i, to) {
            reached[root, path] = 1
            for (i = 1; i <= edges[path]; ++i) {
                to = edge[path, i]
                if (to ~ /^lib\//) print root ": the oracle must not reach " to " (by " path ")"
                if (!((root, to) in reached)) oracle(root, to)
            }
        }

        BEGIN {
            search_count = split("include lib tools bench meshes tests", search, " ")
            may["include"] = "include"
            may["lib/base"] = "include lib/base"
            may["lib/simd"] = may["lib/base"] " lib/simd"
            may["lib/build"] = may["lib/simd"] " lib/build"
            may["lib/pose"] = may["lib/build"] " lib/pose"
            may["lib/query"] = may["lib/pose"] " lib/query"
            may["lib/step"] = may["lib/query"] " lib/step"
            may["lib/near"] = may["lib/step"] " lib/near"
            may["lib/trace"] = may["lib/query"] " lib/trace"
            may["lib/run"] = may["lib/near"] " lib/trace lib/run"
            may["lib"] = may["lib/run"] " lib"
            may["tools"] = "include tools"
            may["bench"] = may["bench/scenes"] = "include tools bench bench/scenes"
            may["bench/peers"] = "include tools bench/peers"
            may["meshes"] = "include tools meshes"
            may["tests"] = may["lib"] " tests tests/fuzz"
            may["tests/fuzz"] = may["tests/runs"] = may["tests"]
            may["tests/bench"] = may["bench"] " tests tests/bench"
            may["tests/abi"] = "tests tests/abi"
            may["tests/packages"] = may["tools/npm"] = "include"
            may["tests/packages/libc"] = "tests/packages/libc"
            may["tests/wasm"] = "include tests"
            may["tests/cgal"] = "include tools tests tests/cgal"
            may["tests/ffi/cxx"] = "include tests/ffi/cxx"
            may["tools/clients/bullet"] = "include tools/clients/bullet"
            may["tools/clients/ipctk"] = "include tests/ffi/cxx tools/clients/ipctk"
            may["tools/clients/ipctk/stand_in/ipc/broad_phase"] = ""
        }

        { known[$0] = 1; order[++count] = $0 }

        END {
            for (f = 1; f <= count; ++f) {
                path = order[f]
                home = room(path)
                if (!(home in may)) {
                    print path ": no files here, as no rule says what they may include"
                    continue
                }
                number = 0
                while ((getline line < path) > 0) {
                    ++number
                    if (line !~ /^[ \t]*#[ \t]*include[ \t]*["<]/) continue
                    quoted = line ~ /^[ \t]*#[ \t]*include[ \t]*"/
                    split(line, part, /["<>]/)
                    name = part[2]
                    where = path ":" number ": "
                    if (name ~ /(^|\/)\.\.?\//) {
                        print where "names " name " by a relative path"
                        continue
                    }
                    to = resolve(path, name)
                    if (to == "") {
                        if (quoted) print where "there is no " name " in the repository"
                        continue
                    }
                    if (to !~ /\.(h|hpp|inc)$/) print where "includes " to ", not a header"
                    if (index(" " may[home] " ", " " room(to) " ") == 0)
                        print where home " must not include " to
                    edge[path, ++edges[path]] = to
                    if (unit(path) != unit(to)) edge[unit(path), ++edges[unit(path)]] = unit(to)
                }
                close(path)
            }
            for (f = 1; f <= count; ++f) if (!(order[f] in state)) visit(order[f])
            for (f = 1; f <= count; ++f) if (!(unit(order[f]) in state)) visit(unit(order[f]))
            for (f = 1; f <= count; ++f)
                if (order[f] ~ /^tests\/((step|near|stencil)_)?oracle[^\/]*$/) oracle(order[f], order[f])
        }' || echo "check_layering: awk failed"
)

if [ -n "$offenders" ]; then
    printf '%s\n' "$offenders"
    exit 1
fi

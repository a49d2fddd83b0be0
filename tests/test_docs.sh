#!/bin/sh
# The documents beside README.md: include/EMBEDDING.md is a program that compiles, runs and prints
# what is said there, and its sizes are right; man pages have the tools' options; the API pages have
# every call.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

guide=include/EMBEDDING.md

remake() {
    "$MAKE" --no-print-directory -j1 config="$SC_CONFIG" "$@"
}

# blocks LANGUAGE: all code blocks of that language in the guide, one after the other.
blocks() {
    awk -v fence='```'"$1" '
        !inside && $0 == fence { inside = 1; next }
        inside && $0 == "```" { inside = 0 }
        inside' "$guide"
}

# ------------------------------------------------------------------------------------------------
# The guide

blocks c >"$scratch/guide.c"
blocks text >"$scratch/expected"
check "the guide has code in every part" test "$(grep -c '^```c$' "$guide")" -ge 6
check "it says what it prints" test -s "$scratch/expected"

compile() {
    # shellcheck disable=SC2086
    $CC -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Werror -Iinclude "$scratch/guide.c" \
        "$SC_LIB/libstarcontour.a" -pthread -lm -o "$scratch/guide" $SC_FLAGS
}
run() {
    (cd "$scratch" && ./guide) >"$scratch/printed" && diff "$scratch/expected" "$scratch/printed"
}
check "the guide compiles" compile
check "it prints what it says" run

for file in $(grep -o '`[a-z]*/[a-zA-Z_./]*`' "$guide" | tr -d '`' | grep -v '^build/' | sort -u); do
    check "$file exists" test -e "$file"
done

# The sizes of models and workspaces, within 5 %.
if [ -x "$SC_BIN/sc-partition" ]; then
    sed -n 's/^| \([0-9]*\) | \([0-9,]*\) | \([0-9,]*\) | \([0-9,]*\) |$/\1 \2 \3 \4/p' "$guide" |
        tr -d ',' >"$scratch/sizes"
    check "the guide has a table of sizes" test "$(wc -l <"$scratch/sizes")" -ge 5
    # Prints the line as it should be.
    size() {
        "$SC_BIN/sc-partition" --json --grid "$1" | tr '{,' '\n\n' | awk -F: -v grid="$1" \
            -v triangles="$2" -v model="$3" -v workspace="$4" '
            function near(a, b) { return a < 1.05 * b && b < 1.05 * a }
            { value[$1] = $2 }
            END {
                t = value["\"triangles\""]
                m = value["\"model_bytes\""] / 1000
                w = value["\"workspace_bytes\""] / 1000
                printf "should be | %d | %d | %.0f | %.0f |\n", grid, t, m, w
                exit !(t == triangles && near(m, model) && near(w, workspace))
            }'
    }
    while read -r grid triangles model workspace; do
        # The large ones take long to build.
        [ "$triangles" -gt 60000 ] ||
            check "sizes for $triangles triangles" size "$grid" "$triangles" "$model" "$workspace"
    done <"$scratch/sizes"
else
    skip "sizes: sc-partition was not built"
fi

# ------------------------------------------------------------------------------------------------
# Man pages

# Options, and those that are a choice with their values: --weld rest|none
options() {
    grep -o -e '--[a-z][a-z-]*\( [a-z-]*|[a-z|-]*\)\{0,1\}' | sort -u >"$scratch/options"
    # Mentioned elsewhere without its values.
    awk 'NR == FNR { if (NF > 1) full[$1] = 1; next } NF > 1 || !($1 in full)' "$scratch/options" \
        "$scratch/options"
}
for program in sc-query sc-partition; do
    page=tools/man/$program.1
    if command -v mandoc >/dev/null 2>&1; then
        check "$page: mandoc" mandoc -Tlint -W warning "$page"
    elif man --warnings --version >/dev/null 2>&1; then
        formats() {
            man --warnings -l "$page" 2>&1 >"$scratch/formatted" | tee "$scratch/warnings"
            test -s "$scratch/formatted" && ! test -s "$scratch/warnings"
        }
        check "$page: man --warnings" formats
    else
        skip "$page: neither mandoc nor man"
    fi
    if [ -x "$SC_BIN/$program" ]; then
        "$SC_BIN/$program" --help 2>&1 | options >"$scratch/has"
        # In the page, .It Fl -weld Cm rest | none
        sed -e '/^\.Dl/d' -e 's/^\.It / /' -e 's/^\.Fl/ Fl/' -e 's/ Fl -/ --/g' \
            -e 's/ Cm \([a-z-]* | \)/ \1/' -e 's/ | /|/g' "$page" | options >"$scratch/described"
        check "$page has the options of $program --help" diff "$scratch/has" "$scratch/described"
        check "there are options" test "$(wc -l <"$scratch/has")" -gt 5
    else
        skip "$page: $program was not built"
    fi
done

if [ -x "$SC_BIN/sc-query" ]; then
    check "make install" remake install DESTDIR="$scratch/root" PREFIX=/usr
    for program in sc-query sc-partition; do
        check "$program.1 is installed" cmp "tools/man/$program.1" \
            "$scratch/root/usr/share/man/man1/$program.1"
    done
    check "make uninstall" remake uninstall DESTDIR="$scratch/root" PREFIX=/usr
    check "nothing is left" test -z "$(find "$scratch/root" ! -type d)"
fi

# ------------------------------------------------------------------------------------------------
# API pages

# documented FOLDER: each public function has a text of its own.
documented() {
    sed -n 's/^SC_API .*[ *]\(sc_[a-z_]*\)(.*/\1/p' include/*.h | sort >"$scratch/functions"
    awk '
        /<memberdef kind="function"/ { inside = 1; name = brief = "" }
        inside && /<name>/ { name = $0; gsub(/.*<name>|<\/name>.*/, "", name) }
        inside && /<briefdescription>/ { getline; brief = $0 }
        /<\/memberdef>/ && inside { if (brief ~ /<para>/) print name; inside = 0 }' \
        "$1"/xml/starcontour*_8h.xml | sort | diff "$scratch/functions" -
}
if [ "$SC_CONFIG" != release ]; then
    skip "API pages: once is enough, with config=release"
elif command -v doxygen >/dev/null 2>&1; then
    check "make docs, without warnings" remake docs BUILD="$scratch/build"
    check "there are pages" test -s "$scratch/build/docs/html/index.html"
    check "every function is described" documented "$scratch/build/docs"
else
    skip "API pages: no doxygen ('make deps with=docs')"
fi

finish

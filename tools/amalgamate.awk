# Writes the library as one C file that needs nothing but starcontour.h: the files of
# lib/sources.list in their order, with the library's own headers in the place where each is
# included.
#
#     awk -f tools/amalgamate.awk lib/sources.list >starcontour.c     from the top of the repository
#
# What a file keeps to itself must have a name that no other file has, as all of it is one unit now;
# tests/test_packages.sh compiles it.
#
# SPDX-License-Identifier: MIT

# Where a header of the library is, or "" for the public header and the system's.
function own(name,    line, path) {
    path = "lib/" name
    if ((getline line < path) < 0) return ""
    close(path)
    return path
}

# Headers with a guard are put in once, those that are meant to be included several times each time.
# Where an #include depends on a condition (its # stands apart), a later one may still be needed.
function add(path,    line, name, header, status) {
    print "\n/* ---- " path " ---- */\n"
    while ((status = (getline line < path)) > 0) {
        if (line ~ /^#ifndef [A-Z_0-9]*_H$/) guarded[path] = 1
        if (line !~ /^[ \t]*#[ \t]*include[ \t]*"/) {
            print line
            continue
        }
        name = line
        sub(/^[^"]*"/, "", name)
        sub(/".*/, "", name)
        header = own(name)
        if (header == "") {
            if (name != "starcontour.h") {
                print "amalgamate.awk: " path ": where is " name "?" >"/dev/stderr"
                failed = 1
            }
            print line
        } else if (!(header in included)) {
            add(header)
            if (guarded[header] && line ~ /^#include/) included[header] = 1
            print "\n/* ---- " path ", on ---- */\n"
        }
    }
    close(path)
    if (status < 0) {
        print "amalgamate.awk: cannot read " path >"/dev/stderr"
        failed = 1
    }
}

BEGIN {
    print "/*"
    print " * starcontour, the whole library in one file: compile it with your program, with -std=c99 or"
    print " * later, -ffp-contract=off, and never with -ffast-math. The manual is starcontour.h."
    print " *"
    print " * SPDX-License-Identifier: MIT"
    print " *"
    while ((getline line < "LICENSE") > 0) print line == "" ? " *" : " * " line
    print " *"
    print " * Made by `make amalgamation` from the files named below."
    print " */"
    # What warnings make of files apart does not hold where they follow one another: names that are
    # one file's functions and another's variables, and functions of headers that not all use.
    print "#if defined(__GNUC__)"
    print "#  pragma GCC diagnostic push"
    print "#  pragma GCC diagnostic ignored \"-Wshadow\""
    print "#  pragma GCC diagnostic ignored \"-Wunused-function\""
    print "#endif"
}

/^lib\// { add($1) }

END {
    print "\n#if defined(__GNUC__)"
    print "#  pragma GCC diagnostic pop"
    print "#endif"
    exit failed
}

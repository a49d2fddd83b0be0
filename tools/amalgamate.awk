# Writes the library as one C file that needs nothing but starcontour.h: the files of
# lib/sources.list in their order, with the library's own headers in the place where each is
# included.
#
#     awk -f tools/amalgamate.awk lib/sources.list >starcontour.c     from the top of the repository
#
# What a file keeps to itself must have a name that no other file has, as all of it is one unit now;
# tests/test_packages.sh compiles it. But lib/simd/kernels_SET.c include the same files for each
# instruction set, those without a guard: what these define gets names that end with _SET, and their
# macros are undefined behind it.
#
# SPDX-License-Identifier: MIT

# Where a header of the library is, or "" for the public header and the system's.
function own(name,    line, path) {
    path = "lib/" name
    if ((getline line < path) < 0) return ""
    close(path)
    return path
}

# What stands in quotes behind an #include, or "".
function include_of(line) {
    if (line !~ /^[ \t]*#[ \t]*include[ \t]*"/) return ""
    sub(/^[^"]*"/, "", line)
    sub(/".*/, "", line)
    return line
}

function has_guard(path,    line, found) {
    while (!found && (getline line < path) > 0) found = line ~ /^#ifndef [A-Z_0-9]*_H$/
    close(path)
    return found
}

# Lists what a file and headers without a guard define outside of functions: functions, constants,
# types and enumerators in local, macros in macro[1 to macros] and in local_macro.
function list_names(path,    line, more, name) {
    while ((getline line < path) > 0) {
        name = include_of(line)
        if (name != "" && own(name) != "" && !has_guard(own(name))) list_names(own(name))
        if (line ~ /^static / && line !~ /[(\[=]/ && (getline more < path) > 0) line = line " " more
        if (line ~ /^static / && match(line, /[A-Za-z_0-9]+(\(|\[| = )/)) {
            name = substr(line, RSTART, RLENGTH)
            sub(/[^A-Za-z_0-9]+$/, "", name)
            local[name] = 1
        }
        if (line ~ /^(typedef .*|\} )[A-Za-z_0-9]+;/) {
            name = line
            sub(/;.*/, "", name)
            sub(/.*[^A-Za-z_0-9]/, "", name)
            local[name] = 1
        }
        if (line ~ /^(typedef )?(struct|union|enum) [A-Za-z_0-9]+ \{/) {
            name = line
            sub(/ \{.*/, "", name)
            sub(/.* /, "", name)
            local[name] = 1
        }
        if (line ~ /^enum .*\{/) in_enum = 1
        if (in_enum) {
            more = line
            sub(/.*\{/, "", more)
            while (match(more, /[A-Z][A-Z_0-9]* =/)) {
                local[substr(more, RSTART, RLENGTH - 2)] = 1
                more = substr(more, RSTART + RLENGTH)
            }
            if (line ~ /\}/) in_enum = 0
        }
        if (line ~ /^#[ ]*define /) {
            name = line
            sub(/^#[ ]*define /, "", name)
            sub(/[^A-Za-z_0-9].*/, "", name)
            if (!(name in local_macro)) macro[++macros] = name
            local_macro[name] = 1
        }
    }
    close(path)
}

# The code with _SET behind names in local; members, behind a . or ->, are none of them.
function code_of_set(code,    out, name, before) {
    while (match(code, /[A-Za-z_][A-Za-z_0-9]*/)) {
        before = out substr(code, 1, RSTART - 1)
        name = substr(code, RSTART, RLENGTH)
        out = before name (name in local && before !~ /([0-9.]|->)$/ ? "_" set : "")
        code = substr(code, RSTART + RLENGTH)
    }
    return out code
}

# The same of a line, but for comments.
function line_of_set(line,    out, at) {
    for (;;) {
        at = index(line, in_comment ? "*/" : "/*")
        if (at == 0) return out (in_comment ? line : code_of_set(line))
        out = out (in_comment ? substr(line, 1, at + 1) : code_of_set(substr(line, 1, at - 1)) "/*")
        line = substr(line, at + 2)
        in_comment = !in_comment
    }
}

# Headers with a guard are put in once, those that are meant to be included several times each time.
# Where an #include depends on a condition (its # stands apart), a later one may still be needed.
function add(path,    line, name, header, status) {
    print "\n/* ---- " path " ---- */\n"
    guarded[path] = has_guard(path)
    while ((status = (getline line < path)) > 0) {
        name = include_of(line)
        if (name == "") {
            # One file asks for POSIX of 1993, which here is for all: macOS has C99 from 2001 on.
            if (line ~ /define _POSIX_C_SOURCE/) sub(/199309L/, "200112L", line)
            print set == "" || guarded[path] ? line : line_of_set(line)
            continue
        }
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
    print "#if defined(__GNUC__) || defined(__clang__)"
    print "#  pragma GCC diagnostic push"
    print "#  pragma GCC diagnostic ignored \"-Wshadow\""
    print "#  pragma GCC diagnostic ignored \"-Wunused-function\""
    print "#endif"
}

/^lib\// && !/^lib\/simd\/kernels_/ { add($1) }

/^lib\/simd\/kernels_/ {
    set = $1
    sub(/.*kernels_/, "", set)
    sub(/\.c$/, "", set)
    list_names($1)
    add($1)
    for (i = 1; i <= macros; ++i) print "#undef " code_of_set(macro[i])
    split("", local)
    split("", local_macro)
    macros = 0
    set = ""
}

END {
    print "\n#if defined(__GNUC__) || defined(__clang__)"
    print "#  pragma GCC diagnostic pop"
    print "#endif"
    exit failed
}

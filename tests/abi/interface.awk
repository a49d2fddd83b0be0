# Writes a C program that prints the binary interface of public headers, one line for each fact:
#
#     struct sc_pose: 24 bytes, aligned to 8
#     sc_pose.positions: at 16, 8 bytes: const void *positions
#     SC_OK = 0
#     sc_status sc_query(const sc_model *model, ...)
#
#     awk -f tests/abi/interface.awk include/starcontour.h >interface.c
#
# Whatever a header declares is found, so nothing can be added or changed without a line that
# changes. It reads the plain C of these headers: no nested structures, no bit fields, no
# declarations across conditionals. What it cannot read ends it with status 1.
#
# SPDX-License-Identifier: MIT

# Text without comments, with single spaces.
function plain(text,    start, end) {
    while ((start = index(text, "/*")) > 0) {
        end = index(substr(text, start), "*/")
        text = substr(text, 1, start - 1) " " substr(text, start + end + 1)
    }
    gsub(/[ \t\n]+/, " ", text)
    gsub(/ $|^ /, "", text)
    return text
}

function show(format, values) { printf "    printf(\"%s\\n\", %s);\n", format, values }

function give_up(text) {
    print "interface.awk: cannot read: " text >"/dev/stderr"
    failed = 1
    exit 1
}

# The name that a declarator declares.
function name_of(declarator) {
    if (match(declarator, /\(\*[a-z_0-9]+\)/)) return substr(declarator, RSTART + 2, RLENGTH - 3)
    sub(/\[.*$/, "", declarator)
    if (!match(declarator, /[A-Za-z_0-9]+$/)) give_up(declarator)
    return substr(declarator, RSTART)
}

function structure(name, body,    count, members, i, parts, pieces, k, member) {
    show("struct " name ": %u bytes, aligned to %u", "SIZE(" name "), ALIGNMENT(" name ")")
    count = split(body, members, ";")
    for (i = 1; i < count; i++) {
        # Several declarators share a type; commas of a function's parameters separate none.
        pieces = members[i] ~ /\(/ ? 1 : split(members[i], parts, ",")
        if (pieces == 1) parts[1] = members[i]
        for (k = 1; k <= pieces; k++) {
            member = plain(parts[k])
            if (k > 1) member = plain(parts[1]) ", " member
            show(name "." name_of(parts[k]) ": at %u, %u bytes: " member,
                "OFFSET(" name ", " name_of(parts[k]) "), MEMBER(" name ", " name_of(parts[k]) ")")
        }
    }
}

# One declaration, without its semicolon.
function declaration(text,    name, body, count, entries, i) {
    if (text == "" || text == "}") return
    if (text ~ /^typedef struct [a-z_0-9]+ \{/) {
        name = text
        sub(/^typedef struct /, "", name)
        sub(/ .*/, "", name)
        body = text
        sub(/^[^{]*\{/, "", body)
        sub(/\}[^}]*$/, "", body)
        structure(name, body)
    } else if (text ~ /^enum \{/) {
        body = text
        sub(/^[^{]*\{/, "", body)
        sub(/\}.*$/, "", body)
        count = split(body, entries, ",")
        for (i = 1; i <= count; i++) {
            name = plain(entries[i])
            sub(/ *=.*/, "", name)
            if (name != "") show(name " = %lld", "(long long)" name)
        }
    } else if (text ~ /^(SC_API|typedef) .*[a-z_0-9)]$/ && text !~ /[{}]/) {
        sub(/^SC_API /, "", text)
        show("%s", "\"" text "\"")
    } else give_up(text)
}

FNR == 1 {
    headers[++header_count] = FILENAME
    sub(/.*\//, "", headers[header_count])
    skipping = 0
}
{ all = all $0 "\n" }

END {
    if (failed) exit 1
    print "/* Written by tests/abi/interface.awk. */"
    print "#include <stddef.h>\n#include <stdio.h>"
    for (i = 1; i <= header_count; i++) print "#include \"" headers[i] "\""
    print "#define SIZE(type) (unsigned)sizeof(type)"
    print "#define OFFSET(type, member) (unsigned)offsetof(type, member)"
    print "#define MEMBER(type, member) (unsigned)sizeof(((type *)0)->member)"
    print "#define ALIGNMENT(type) (unsigned)offsetof(struct { char c; type t; }, t)"
    print "int main(void)\n{"

    # Comments go first: they hold anything. Then the preprocessor's lines, of which constants
    # count.
    while ((start = index(all, "/*")) > 0) {
        end = index(substr(all, start), "*/")
        if (!end) give_up("a comment that does not end")
        all = substr(all, 1, start - 1) " " substr(all, start + end + 1)
    }
    gsub(/\\\n/, " ", all)
    count = split(all, lines, "\n")
    code = ""
    for (i = 1; i <= count; i++) {
        if (lines[i] ~ /^[ \t]*#/) {
            if (lines[i] ~ /^#define SC_[A-Z_0-9]+ [^"]+$/ && lines[i] !~ /SC_VERSION_|SC_API/) {
                split(lines[i], words, " ")
                show(words[2] " = %lld", "(long long)" words[2])
            }
        } else if (lines[i] !~ /^extern "C" \{$/) code = code lines[i] "\n"
    }

    # Declarations end at semicolons outside braces.
    depth = 0
    text = ""
    for (i = 1; i <= length(code); i++) {
        c = substr(code, i, 1)
        if (c == "{") depth++
        if (c == "}" && depth > 0) depth--
        if (c == ";" && depth == 0) {
            text = plain(text)
            sub(/^\} /, "", text)
            declaration(text)
            text = ""
        } else text = text c
    }
    if (plain(text) !~ /^(\} ?)*$/) give_up(plain(text))
    print "    return 0;\n}"
}

# Turns include/starcontour.h into a C program that prints its binary interface, a line each:
#
#     struct NAME BYTES
#     member STRUCT NAME OFFSET BYTES
#     value ENUMERATOR NUMBER
#
# Bindings compare their own structures with these lines, so that none falls behind the header
# unnoticed. The header is the only source: nothing here names a structure or a member.
#
#     awk -f tests/ffi/layout.awk include/starcontour.h > layout.c
#
# SPDX-License-Identifier: MIT

# Comments go, directives as well, and what is left becomes one text.
{
    line = $0
    while (line != "") {
        if (inside) {
            at = index(line, "*/")
            if (!at) break
            line = substr(line, at + 2)
            inside = 0
        } else {
            at = index(line, "/*")
            code = at ? substr(line, 1, at - 1) : line
            if (code !~ /^[ \t]*#/) text = text " " code
            if (!at) break
            line = substr(line, at + 2)
            inside = 1
        }
    }
}

# The last identifier of a declaration, or the one in "(*name)".
function declared(text,    parts) {
    if (match(text, /\(\*[A-Za-z_0-9]+\)/)) return substr(text, RSTART + 2, RLENGTH - 3)
    sub(/\[.*/, "", text)
    sub(/[ \t]+$/, "", text)
    match(text, /[A-Za-z_0-9]+$/)
    return substr(text, RSTART, RLENGTH)
}

END {
    print "#include <stddef.h>\n#include <stdio.h>\n#include <starcontour.h>"
    print "int main(void)\n{"
    while (match(text, /(typedef struct [a-z_0-9]+|enum) \{[^}]*\}/)) {
        block = substr(text, RSTART, RLENGTH)
        text = substr(text, RSTART + RLENGTH)
        body = block
        sub(/^[^{]*\{/, "", body)
        sub(/\}$/, "", body)
        if (block ~ /^enum/) {
            count = split(body, entries, ",")
            for (i = 1; i <= count; ++i) {
                if (!match(entries[i], /SC_[A-Z_0-9]+/)) continue
                name = substr(entries[i], RSTART, RLENGTH)
                printf "    printf(\"value %s %%ld\\n\", (long)%s);\n", name, name
            }
            continue
        }
        split(block, words, " ")
        type = words[3]
        printf "    printf(\"struct %s %%u\\n\", (unsigned)sizeof(%s));\n", type, type
        count = split(body, entries, ";")
        for (i = 1; i <= count; ++i) {
            if (entries[i] !~ /[a-z]/) continue
            # "uint32_t a, b" declares two; a comma within brackets separates parameters.
            plain = entries[i] ~ /\(/ ? 1 : split(entries[i], names, ",")
            if (entries[i] ~ /\(/) names[1] = entries[i]
            for (k = 1; k <= plain; ++k) {
                name = declared(names[k])
                printf "    printf(\"member %s %s %%u %%u\\n\", (unsigned)offsetof(%s, %s),\n", \
                    type, name, type, name
                printf "           (unsigned)sizeof(((%s *)0)->%s));\n", type, name
            }
        }
    }
    print "    return 0;\n}"
}

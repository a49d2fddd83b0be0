# Turns the plain comments of a public header into Doxygen's, for `make docs`:
#
#     at the start of a line    ->  /** ... */     of what follows; the first is the file's
#     behind code               ->  /**< ... */    of what stands before
#     banners between sections  ->  left out
#
# One comment above several functions is given to each of them; "name   what it is", three spaces in,
# becomes an entry of a list. Line numbers change.
#
# SPDX-License-Identifier: MIT

# A line of a comment: what Doxygen would take for markup of its own is escaped, but in examples.
function line_of(text,    words, after) {
    if (text ~ /^ \*   [a-z_]+  +[^ ]/) {
        listing = 1
        split(text, words, " ")
        sub(/^ \*   [a-z_]+  +/, "", text)
        return " * - `" words[2] "` " escaped(text)
    }
    if (listing && sub(/^ \*        +/, "", text)) return " *   " escaped(text)
    after = listing ? " *\n" : ""
    listing = 0
    return after (text ~ /^ \*     / ? text : escaped(text))
}

function escaped(text) {
    gsub(/[\\@<>#%]/, "\\\\&", text)
    gsub(/^\*\\\//, "*/", text)
    return text
}

inside == "block" {
    comment = comment line_of($0) "\n"
    if (/\*\//) done()
    next
}
inside == "behind" {
    print escaped($0)
    if (/\*\//) inside = ""
    next
}
/^\/\* -----/ { inside = "banner" }
inside == "banner" {
    if (/\*\//) inside = ""
    next
}
/^\/\*/ {
    comment = "/**" (first++ ? "" : " @file") line_of(substr($0, 3)) "\n"
    inside = "block"
    if (/\*\//) done()
    next
}

/^$/ { comment = "" }
/^SC_API/ && comment != "" && given { printf "%s", comment }
{ given = 1 }
/\/\*/ {
    at = index($0, "/*")
    print substr($0, 1, at - 1) "/**<" escaped(substr($0, at + 2))
    if (!/\*\//) inside = "behind"
    next
}
{ print }

# The comment above a declaration is complete.
function done() {
    printf "%s", comment
    inside = ""
    listing = 0
    given = 0
}

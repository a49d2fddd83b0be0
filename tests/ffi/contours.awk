# What `sc-query --trace --json FILE | tr '{' '\n'` prints becomes lines of golden.txt: a contour's
# number of nodes, how it begins and ends (SC_TRACE_...) and its length; then edge and triangle of
# each node. Before each line are what to sort by for the library's order, as sc-query has the
# longest contour first: how it begins, edge and triangle of its first node, the line's own number.
#
# SPDX-License-Identifier: MIT
BEGIN { value["border"] = 1; value["branch"] = 2; value["vertex"] = 3; value["closed"] = 0 }

# The member's value, without quotes.
function member(name, text) {
    if (!match($0, "\"" name "\":[^],}]*")) return ""
    text = substr($0, RSTART + length(name) + 3, RLENGTH - length(name) - 3)
    gsub("\"", "", text)
    return text
}

function print_contour(i, rank) {
    if (!count) return
    rank = begin == "closed" ? 2 : begin == "vertex"
    printf "%d %s 0 contour %d %d %d %s\n", rank, node[1], count, value[begin], value[end], len
    for (i = 1; i <= count; ++i) printf "%d %s %d node %s\n", rank, node[1], i, node[i]
}

/^"length":/ {
    print_contour()
    count = 0
    len = member("length")
    begin = member("begin")
    end = member("end")
}
/^"point":/ {
    if (/"vertex":/) node[++count] = "4294967295 " member("vertex")
    else node[++count] = member("edge") " " member("triangle")
}
END { print_contour() }

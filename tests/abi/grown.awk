# Says what in a newer interface would break callers of an older one; both as tests/abi/goldens.sh
# writes them, enumerators included, which abidiff does not see.
#
#     awk -f tests/abi/grown.awk OLD_INTERFACE NEW_INTERFACE
#
# Every old line must still be there. Allowed are further lines; that a member named reserved, in
# which old callers have 0, becomes another of its size; and that a structure which has a
# struct_size grows, by members behind what was its end, padding included. It may be aligned more
# strictly then, as the library copies it byte by byte. Status 1 if something breaks.
#
# SPDX-License-Identifier: MIT

function breaks(text) { print text; broken = 1 }

# "struct NAME: SIZE bytes, aligned to ALIGNMENT"
/^struct / {
    name = $2
    sub(/:$/, "", name)
    if (NR == FNR) { old_size[name] = $3; old_alignment[name] = $7 }
    else if (name in old_size) {
        seen[name] = 1
        if ($3 < old_size[name]) breaks(name ": was " old_size[name] " bytes, is " $3)
        else if ($3 > old_size[name] && !(name in sized))
            breaks(name ": grows, but has no struct_size")
        if ($7 < old_alignment[name] || ($7 > old_alignment[name] && !(name in sized)))
            breaks(name ": was aligned to " old_alignment[name] ", is to " $7)
    }
    next
}

NR == FNR {
    old[$0] = 1
    if ($1 ~ /\.reserved:$/) { name = $1; sub(/\..*/, "", name); reserved[name] = $3 $4; spare[name] = $0 }
    if ($1 ~ /\.struct_size:$/) { name = $1; sub(/\..*/, "", name); sized[name] = 1 }
    next
}

$0 in old { delete old[$0]; next }

# "NAME.MEMBER: at OFFSET, BYTES bytes: DECLARATION", a new or another one
$1 ~ /^[a-z_0-9]+\.[a-z_0-9]+:$/ {
    name = $1
    sub(/\..*/, "", name)
    if (name in reserved && reserved[name] == $3 $4) delete old[spare[name]]
    else if (name in old_size && $3 + 0 < old_size[name])
        breaks($1 " lies within what old callers know as " name)
}

END {
    for (line in old) breaks("gone or changed: " line)
    for (name in old_size) if (!(name in seen)) breaks("gone: struct " name)
    exit broken
}

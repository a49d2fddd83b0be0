# Turns a golden of tests/abi into C11 that compiles only where the interface is that one: for
# compilers whose programs cannot run here.
#
#     awk -f tests/abi/asserted.awk tests/abi/interface_64.txt >asserted.c
#
# Types and calls are declared once more, as the golden has them. What it cannot read ends it with
# status 1.
#
# SPDX-License-Identifier: MIT
function holds(condition) { printf "_Static_assert(%s, \"%s\");\n", condition, condition }

BEGIN {
    print "/* Written by tests/abi/asserted.awk. */"
    print "#include <stddef.h>\n#include \"starcontour.h\"\n#include \"starcontour_metis.h\""
}
/^struct [a-z_0-9]+: [0-9]+ bytes, aligned to [0-9]+$/ {
    name = substr($2, 1, length($2) - 1)
    holds("sizeof(" name ") == " $3)
    holds("_Alignof(" name ") == " $NF)
    ++facts
    next
}
/^[a-z_0-9]+\.[A-Za-z_0-9]+: at [0-9]+, [0-9]+ bytes: / {
    split(substr($1, 1, length($1) - 1), names, ".")
    holds("offsetof(" names[1] ", " names[2] ") == " $3 + 0)
    holds("sizeof(((" names[1] " *)0)->" names[2] ") == " $4)
    ++facts
    next
}
/^[A-Z_0-9]+ = -?[0-9]+$/ {
    holds($1 " == " $3)
    ++facts
    next
}
/^[a-z].*[a-z_0-9)]$/ {
    print /^typedef / ? $0 ";" : "SC_API " $0 ";"
    ++facts
    next
}
{
    print "asserted.awk: cannot read: " $0 >"/dev/stderr"
    failed = 1
    exit 1
}
END {
    if (failed || !facts) exit 1
}

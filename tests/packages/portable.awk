# Which C files of the tests include, by whatever way, nothing but headers of C and of the library:
# neither GMP's nor libccd's nor POSIX's. One a line.
#
#     awk -f tests/packages/portable.awk tests/*.[ch]
#
# SPDX-License-Identifier: MIT
/^# *include </ {
    name = $2
    if (name ~ /^<(gmp|ccd\/ccd|dirent|pthread|signal|unistd|sys\/.*)\.h>/) outside[FILENAME] = 1
}
/^# *include "/ {
    split($0, parts, "\"")
    includes[FILENAME] = includes[FILENAME] " " parts[2]
}
FNR == 1 { files[++count] = FILENAME }

function reaches_outside(file,    list, n, i) {
    if (seen[file]++) return 0
    if (file in outside) return 1
    n = split(includes[file], list, " ")
    for (i = 1; i <= n; ++i) if (reaches_outside("tests/" list[i])) return 1
    return 0
}

END {
    for (k = 1; k <= count; ++k) {
        split("", seen)
        if (files[k] ~ /\.c$/ && !reaches_outside(files[k])) print files[k]
    }
}

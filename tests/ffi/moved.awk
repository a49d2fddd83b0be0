# Writes an OBJ mesh in its second pose: z + x / 4 - 1 / 4 for the later half of its vertices. On
# meshes/crossing_cloths.obj that moves one cloth, and is exact in floats and doubles.
#
# SPDX-License-Identifier: MIT
$1 == "v" { ++count; x[count] = $2; y[count] = $3; z[count] = $4; next }
$1 == "f" { faces = faces $0 "\n" }
END {
    for (i = 1; i <= count; ++i)
        printf "v %.17g %.17g %.17g\n", x[i], y[i], z[i] + (i > count / 2 ? x[i] / 4 - 0.25 : 0)
    printf "%s", faces
}

# Sourced, after script.sh, by those of tests/packages/ that build tests for other systems, where
# there is C and the library (with partition_metis.c, without METIS), and neither GMP nor libccd nor
# POSIX:
#
#     $portable_tests          the tests, NAME of tests/test_NAME.c; the longest first
#     $portable_support        C files that they are linked with, as an archive
#     $portable_left_out       the tests that need more
#     $portable_determinism    C files of the program of tests/runs that hashes pairs of all methods
#     $jobs                    how many processors there are
#     tool NAME                where clang has that program, else PATH
#     layouts_hold WHERE COMMAND...    two checks: that structures, enumerators and calls are those of
#                              tests/abi on 64 bits, by a command that compiles a C file without
#                              writing anything, and that others are noticed; WHERE begins their
#                              names
#
# SPDX-License-Identifier: MIT
portable_tests='forged_models arguments base feature_records filters flattening hooks lanes near_input
    queries records refinement step_slabs step_stencils steps structures underflow'
portable_support=$(awk -f tests/packages/portable.awk tests/*.[ch] | grep -v '^tests/test_')
portable_determinism='tests/runs/determinism.c tests/adversaries.c tests/harness.c tests/inputs.c
    tests/oracle_weld.c tests/shapes.c tests/soups.c'
portable_left_out=$(for file in tests/test_*.c; do
    name=$(basename "$file" .c)
    # shellcheck disable=SC2086
    printf '%s\n' $portable_tests | grep -qx "${name#test_}" || echo "$name"
done)
jobs=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)

tool() {
    found=$(clang -print-prog-name="$1" 2>/dev/null) && command -v "$found"
}
layouts() {
    interface=$1
    shift
    awk -f tests/abi/asserted.awk "$interface" >"$scratch/asserted.c" && "$@" "$scratch/asserted.c"
}
other_layouts() {
    sed '/^struct sc_pose: /s/[0-9]* bytes/4 bytes/' tests/abi/interface_64.txt >"$scratch/other.txt"
    ! layouts "$scratch/other.txt" "$@"
}
layouts_hold() {
    where=$1
    shift
    check "${where}structures, enumerators and calls are those of tests/abi" layouts \
        tests/abi/interface_64.txt "$@"
    check "${where}another layout is noticed" other_layouts "$@"
}

# Sourced, after script.sh, by those of tests/packages/ that build tests for other systems, where
# there is C and the library (with partition_metis.c, without METIS), and neither GMP nor libccd nor POSIX:
#
#     $portable_tests      the tests, NAME of tests/test_NAME.c
#     $portable_support    C files that they are linked with, as an archive
#     $portable_left_out   the tests that need more
#
# SPDX-License-Identifier: MIT
portable_tests='arguments base feature_records filters flattening forged_models hooks lanes near_input
    queries records refinement step_slabs step_stencils steps structures underflow'
portable_support=$(awk -f tests/packages/portable.awk tests/*.[ch] | grep -v '^tests/test_')
portable_left_out=$(for file in tests/test_*.c; do
    name=$(basename "$file" .c)
    # shellcheck disable=SC2086
    printf '%s\n' $portable_tests | grep -qx "${name#test_}" || echo "$name"
done)

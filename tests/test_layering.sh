#!/bin/sh
# The repository keeps its layering, and tools/check_layering.sh sees each kind of offence: planted
# in a copy, one at a time. The faults of tests/mutants are such as can be planted.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

check "the repository has no offenders" tools/check_layering.sh
check "planted faults fit the sources" tests/mutants/mutants.sh --check

copy=$scratch/copy
mkdir "$copy"
cp -R Makefile include lib tools tests bench "$copy"
mkdir -p "$copy/lib/base" "$copy/lib/simd" "$copy/lib/build" "$copy/lib/pose" "$copy/lib/query" \
    "$copy/lib/step" "$copy/lib/near" "$copy/lib/run"
for layer in base simd build pose query step near; do
    echo "/* planted */" >"$copy/lib/$layer/planted_$layer.h"
done
echo "/* planted */" >"$copy/tests/planted_tests.h"
check "nor has the copy" tools/check_layering.sh "$copy"

# offence "words of the message" FILE "line": plants the line at the end of FILE.
offence() {
    before=0
    [ -f "$copy/$2" ] && before=1 && cp "$copy/$2" "$scratch/before"
    printf '%s\n' "$3" >>"$copy/$2"
    check "seen: $2 with $3" seen "$1"
    if [ "$before" -eq 1 ]; then cp "$scratch/before" "$copy/$2"; else rm "$copy/$2"; fi
}

seen() {
    output=$(tools/check_layering.sh "$copy")
    status=$?
    printf '%s\n' "$output"
    [ "$status" -eq 1 ] && printf '%s\n' "$output" | grep -qF -e "$1"
}

offence "lib/base must not include lib/build" lib/base/planted_base.h '#include "build/planted_build.h"'
offence "lib/base must not include lib/simd" lib/base/planted_base.h '#include "simd/planted_simd.h"'
offence "lib/simd must not include lib/build" lib/simd/planted_simd.h '#include "build/planted_build.h"'
offence "lib/step must not include lib/simd/all_kernels.h" lib/step/planted_step.h '#include "simd/all_kernels.h"'
offence "lib/build must not include lib/pose" lib/build/planted_build.h '# include "pose/planted_pose.h"'
offence "lib/pose must not include lib/query" lib/pose/planted_pose.h '#include "query/planted_query.h"'
offence "lib/query must not include lib/step" lib/query/planted_query.h '#include "step/planted_step.h"'
offence "lib/step must not include lib/near" lib/step/planted_step.h '#include "near/planted_near.h"'
offence "lib/near must not include lib/run" lib/near/planted_near.h '#include "run/runner.h"'
offence "lib/step must not include lib/run" lib/step/planted_step.h '#include "run/runner.h"'
offence "lib/query must not include tests" lib/query/planted_query.h '#include "planted_tests.h"'
offence "tools must not include lib/base" tools/planted.c '#include "base/planted_base.h"'
offence "tools must not include lib/base" tools/planted.c '#include <base/planted_base.h>'
offence "bench must not include lib/query" bench/planted.c '#include "query/planted_query.h"'
offence "include must not include lib/base" include/starcontour.h '#include "base/planted_base.h"'
offence "by a relative path" lib/query/planted_query.h '#include "../base/planted_base.h"'
offence "there is no absent.h" lib/base/planted_base.h '#include "absent.h"'
offence "not a header" tests/planted.c '#include "starcontour.c"'
offence "includes itself" lib/base/planted_base.h '#include "base/planted_base.h"'
offence "includes itself" lib/base/hooks.c '#include "base/arguments.h"'
offence "the oracle must not reach lib/base" tests/oracle.h '#include "base/planted_base.h"'
offence "same name as" tools/planted_base.h '/* planted */'
offence "does not belong at the top level" planted.txt 'planted'
offence "lacks lib/base/planted.c" lib/base/planted.c '/* planted */'
offence "lacks lib/simd/kernels_planted.c" lib/simd/kernels_planted.c '/* planted */'
offence "no file lib/base/planted.c" lib/sources.list 'lib/base/planted.c'
offence "number_components is also a name of" lib/query/star.c 'static int number_components(int i)'
offence "LEAST_RUN is also a name of" lib/query/star.c 'static const double LEAST_RUN = 1;'
offence "wide_difference is also a name of" lib/query/star.c '} wide_difference;'
offence "PATIENCE_LEAST is also a name of" lib/query/star.c 'enum { STAR = 1, PATIENCE_LEAST = 2 };'
offence "DIGITS is also a name of" lib/query/star.c '#define DIGITS 10'

echo '#include "planted_base.h"' >"$copy/lib/base/planted_other.h"
offence "includes itself" lib/base/planted_base.h '#include "base/planted_other.h"'

echo '#include "base/planted_base.h"' >"$copy/tests/planted_tests.h"
offence "includes itself" lib/base/hooks.c '#include "base/arguments.h"'
offence "the oracle must not reach lib/base" tests/oracle.h '#include "planted_tests.h"'
offence "the oracle must not reach lib/base" tests/near_oracle.h '#include "planted_tests.h"'

check "after all that the copy is as before" tools/check_layering.sh "$copy"

finish

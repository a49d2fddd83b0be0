#!/bin/sh
# `make bench-wasm` on a small scene: it finds as many pairs in Node as here, and times them. Run by
# `make test-wasm`.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

bench=$SC_BIN/sc-bench
if [ ! -x "$bench" ] || ! command -v node >/dev/null 2>&1; then
    skip "times: there is no sc-bench, or no node ('make deps with=wasm')" 4
    finish
fi
measure() { # SC-BENCH
    FRAMES=12 RUNS=2 bench/wasm_times.sh "$scratch/wasm.csv" "$1" "${BUILD:-build}/wasm/package/index.js" \
        "$scratch/scenes" twisted-cloth:4096
}
check "it measures" status 0 measure "$bench"
check "the speed is said" grep -q "4096 triangles: best .* of the speed of SSE2" "$scratch/out"
lines() { # SAME
    cat "$scratch/wasm.csv"
    awk -F, -v same="$1" '/^#/ { next } /^scene/ { head = NF == 8; next }
        $1 == "twisted-cloth" && $2 == 4096 && $3 == 12 && $4 > 0 && $5 > 0 && $6 > 0 && $7 > 0 && $8 == same { ++good }
        END { exit !(head && good == 1 && NR == 4) }' "$scratch/wasm.csv"
}
check "and kept" lines 1

# An sc-bench that finds another number of pairs.
cat >"$scratch/other" <<EOT
#!/bin/sh
"$bench" "\$@" | sed 's/^\\(.*,triangle,1,[^,]*,[^,]*\\),0,/\\1,7,/'
EOT
chmod +x "$scratch/other"
other() {
    status 1 measure "$scratch/other" && lines 0
}
check "other numbers of pairs are a failure" other
finish

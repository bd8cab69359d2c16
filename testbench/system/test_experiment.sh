#!/bin/sh
# docs/experiment.md says what the simulated board says, and that is what it must be.
. testbench/support/check.sh
mkdir -p "$BUILD/log"
table=$BUILD/log/experiment.md
check "the experiments run" sh -c "HITPIPE=$HITPIPE BUILD=$BUILD testbench/tools/experiment.sh >'$table'"
check "sixteen rows" test "$(grep -c 'wscg2007\|usb3\|ideal\|PCI' "$table")" = 16
while IFS= read -r row; do
    check "in the page: $row" grep -qxF -- "$row" docs/experiment.md
done <"$table"

# The third: its columns are upload, compute, read-back, sum, collisions.
swarm() { # NAME: the row, numbers alone
    grep -F "$1" "$table" | sed 's/^[^|]*|[^|]*|//; s/|/ /g' | awk '{$1 = $1; print}'
}
every=$(swarm 'all against all, mode `all`, `wscg2007`') once=$(swarm 'each pair once, mode `all`, `wscg2007`')
check "each pair once finds the same collisions" test "${every##* }" = "${once##* }"
holds() { # NAME CONDITION-OF-AWK ROW
    check "$1: $3" sh -c "echo '$3' | awk '{exit !($2)}'"
}
for row in "$every" "$once" "$(swarm 'mode `any`')" "$(swarm '`ideal` ' | tail -n 1)"; do
    holds "the sum is that of its parts" "\$1 + \$2 + \$3 - \$4 < 0.0016 && \$4 - \$1 - \$2 - \$3 < 0.0016" "$row"
done
# a million tests at one a clock of 100 MHz, and 28 bytes a record at 330 MB/s
holds "compute is a clock a pair, and what DDR takes" '$2 >= 10 && $2 < 10.5' "$every"
holds "read-back is a million records, less what compute hides" '$2 + $3 >= 84.8 && $2 + $3 < 87' "$every"
holds "625,216 pairs where each is tested once" '$2 >= 6.25 && $2 < 6.6 && $2 + $3 >= 53.0 && $2 + $3 < 55' "$once"
status 2 "a swarm of no way" "$BUILD/testbench/tools/swarm" usb3 some
status 3 "a swarm on no board" "$BUILD/testbench/tools/swarm" nowhere all
report

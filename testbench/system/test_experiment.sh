#!/bin/sh
# docs/experiment.md says what the simulated board says.
. testbench/support/check.sh
table=$(HITPIPE=$HITPIPE testbench/tools/experiment.sh)
check "the experiment runs" test "$(printf '%s\n' "$table" | grep -c 'wscg2007\|usb3\|ideal\|PCI')" = 8
mkdir -p "$BUILD/log"
printf '%s\n' "$table" >"$BUILD/log/experiment.md"
while IFS= read -r row; do
    check "in the page: $row" grep -qxF -- "$row" docs/experiment.md
done <"$BUILD/log/experiment.md"
report

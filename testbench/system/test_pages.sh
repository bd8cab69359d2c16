#!/bin/sh
# Pages with figures that a program writes say what it says now.
. testbench/support/check.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export HITPIPE
check "docs/pipes.md is written again" testbench/tools/pipes_page.sh "$work/pipes.md"
check "docs/pipes.md: make pipes-page" diff docs/pipes.md "$work/pipes.md"
pairs=$(sed -nE 's/^HP_PAIR\(.*"([a-z-]+)".*/\1/p' rtl_model/include/hitpipe/pairs.def)
for pair in $pairs; do
    check "docs/pipes.md has $pair" grep -qx "## $pair" docs/pipes.md
    check "docs/pipes.md has what $pair costs" grep -A 4 -x "<!-- cost: $pair -->" docs/pipes.md
    check "two rows of it" test "$(printf '%s\n' "$output" | grep -cE '^\| (F, T and|and the).*( [0-9]+ \|){12}$')" = 2
    for word in F T CP Method Degenerate; do
        check "$pair: $word" sh -c "sed -n '/^## $pair\$/,/^<!-- cost/p' docs/pipes.md | grep -q '^- \*\*$word\*\*: '"
    done
done
report

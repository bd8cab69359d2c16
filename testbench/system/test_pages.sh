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

# docs/vectors.md: how many there are, and where binary32 is wrong outside the band
check "all golden vectors replay" "$HITPIPE" replay vectors/*/*.hex
check "their sum is in docs/vectors.md" grep -qxF "$(printf '%s\n' "$output" | tail -n 1)" docs/vectors.md
wrong() { # FILE GROUP: "6 of 140"
    awk -v group="// group: $2" '/^\/\/ group: / {on = $0 == group} on && / outside/ {
        match($0, /[0-9]+ outside/); n = substr($0, RSTART, RLENGTH) + 0; sub(",", "", $3); print n " of " $3}' "$1"
}
for pair in $pairs; do
    [ "$pair" = ray-triangle ] && continue
    row="| $pair | $(wrong "vectors/$pair/subnormals-gradual.hex" small) | $(wrong "vectors/$pair/subnormals-flush.hex" small) |"
    check "docs/vectors.md: $row" grep -qxF "$row" docs/vectors.md
    check "$pair: thin and parallel without one" test "$(wrong "vectors/$pair/degenerate.hex" 'thin and parallel')" = "0 of 120"
done
# a row of ray-triangle: the file and its groups, blanks as _
while IFS='|' read -r file groups; do
    names='' numbers=''
    for group in $groups; do
        name=$(echo "$group" | tr _ ' ')
        names="$names${names:+, }$name"
        numbers="$numbers${numbers:+, }$(wrong "vectors/ray-triangle/$file.hex" "$name")"
    done
    check "docs/vectors.md: $file: $names: $numbers" grep -qF "| $file | $names | $numbers |" docs/vectors.md
done <<END
slivers|needles_and_caps
grazing|slanting
subnormals-gradual|all_subnormal underflow
subnormals-flush|all_subnormal underflow
overflow|large_words long_directions far_hits
END
others=$(grep -lE ', [1-9][0-9]* outside' vectors/*/*.hex | grep -cvE '/(subnormals-(gradual|flush)|overflow)\.hex$')
check "wrong flags in no other file" test "$others" = 0
report

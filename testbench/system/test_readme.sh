#!/bin/sh
# Every command that README.md shows runs as shown; its JSON board is taken; its C lines are in examples/closest.c's tongue.
. testbench/support/check.sh
root=$(pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
ln -s "$root/vectors" "$root/examples" "$work"
mkdir "$work/bin"
ln -s "$(realpath "$HITPIPE")" "$work/bin/hitpipe"
PATH=$work/bin:$PATH

# block LANGUAGE: the fenced block of that language
block() { awk -v fence="\`\`\`$1" '$0 == fence {on = 1; next} /^```/ {on = 0} on' "$root/README.md"; }

block sh >"$work/commands"
check "there are commands" test "$(wc -l <"$work/commands")" -ge 12
while IFS= read -r line; do
    check "README: $line" sh -c "cd '$work' && $line"
done <"$work/commands"
for file in hits.exr hits.png report.json spheres.png hits.csv board.vcd contact.svg; do
    check "README left $file" test -s "$work/$file"
done

block json >"$work/board.json"
check "README: the JSON board" hitpipe info --board "$work/board.json"
says "its name" 'four lanes'

{
    printf '#include <hitpipe/hitpipe.h>\nint shown(const float *triangles, size_t count, const float *rays, size_t n, '
    printf 'hp_result *results);\nint shown(const float *triangles, size_t count, const float *rays, size_t n, '
    printf 'hp_result *results) {\n'
    block c
    printf 'return 0; }\n'
} >"$work/shown.c"
check "README: the C lines compile" "${CC:-cc}" -std=c17 -Wall -Wextra -Irtl_model/include -Idriver/include -c "$work/shown.c" \
    -o "$work/shown.o"

for page in $(grep -oE '\]\([a-zA-Z/_.-]+\)' README.md CONTRIBUTING.md docs/*.md | sed 's/.*:\](/](/; s/](\(.*\))/\1/' | sort -u); do
    check "a page links to $page" sh -c "test -e '$page' || test -e 'docs/$page'"
done
# [...](page.md#heading): the heading is there, as GitHub calls it
for link in $(grep -ohE '\]\([a-zA-Z/_.-]*#[a-z0-9-]+\)' README.md CONTRIBUTING.md docs/*.md | sed 's/](\(.*\))/\1/' | sort -u); do
    page=${link%%#*} heading=${link#*#}
    [ -e "$page" ] || page=docs/$page
    check "a page links to $link" sh -c "sed -nE 's/^#+ //p' '$page' | tr 'A-Z ' 'a-z-' | tr -cd 'a-z0-9\\n-' | grep -qx -- '$heading'"
done
# `make TARGET` in a page is a target
for target in $(grep -ohE '\`make [a-z][a-z-]*' README.md CONTRIBUTING.md docs/*.md | sed 's/.* //' | sort -u); do
    check "a page says make $target" grep -qE "^([a-z-]+ )*$target( [a-z-]+)*:" Makefile mk/*.mk
done
# every pipe is in the table
for pair in $(sed -nE 's/^HP_PAIR\(.*"([a-z-]+)".*/\1/p' rtl_model/include/hitpipe/pairs.def); do
    check "README links to $pair" grep -qF "(docs/pipes.md#$pair)" README.md
done
report

#!/bin/sh
# pipes_page.sh [PAGE]: puts the table of `hitpipe info --pipes` for each pipe behind its mark <!-- cost: PAIR --> in
# docs/pipes.md. With a PAGE, writes that instead. Run from the project's root.
set -eu
: "${HITPIPE:=build/hitpipe}"
page=docs/pipes.md
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$HITPIPE" info --pipes >"$work/costs"
awk -v costs="$work/costs" '
    function row(name, line,    n, word, i, text) {
        n = split(line, word, / +/)
        text = "| " name
        for (i = n - 11; i <= n; i++) text = text " | " word[i]
        return text " |"
    }
    BEGIN {
        while ((getline line < costs) > 0) {
            if (line ~ /^pair /) head = line
            else if (line ~ /^  with separation/) { sub(/^ +/, "", line); with[pair] = row("and the distance of a miss", line) }
            else if (line ~ /^[a-z]+-[a-z]+ /) { pair = line; sub(/ .*/, "", pair); without[pair] = row("F, T and CP of a hit", line) }
        }
    }
    /^<!-- end of cost -->$/ { skip = 0 }
    !skip
    /^<!-- cost: [a-z-]+ -->$/ {
        skip = 1
        print row("", head) "\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n" without[$3] "\n" with[$3]
    }
' "$page" >"$work/page"
cat "$work/page" >"${1:-$page}"

#!/bin/sh
# peers_page.sh PEERS COUNT ROUNDS [agreement|speed]: puts what the program prints between the marks of docs/peers.md: who
# is right on COUNT pairs of each class, and how fast each is in ROUNDS rounds; or one of the two. Run from the project's
# root.
set -eu
page=docs/peers.md
peers=$1 count=$2 rounds=$3 part=${4:-both}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# put MARK: standard input between <!-- MARK --> and <!-- end of MARK -->
put() {
    cat >"$work/table"
    awk -v table="$work/table" -v mark="$1" '
        $0 == "<!-- end of " mark " -->" { skip = 0 }
        !skip
        $0 == "<!-- " mark " -->" { skip = 1; while ((getline line < table) > 0) print line }
    ' "$page" >"$work/page"
    cat "$work/page" >"$page"
}

# Each pair once, without its name in every row; and of the speed the table of the fastest peers.
once() { awk -F'|' 'BEGIN {OFS = "|"} {name = $2} NF > 1 && name == last {$2 = " "} {last = name; print}'; }
if [ "$part" != speed ]; then "$peers" summary --count "$count" | once | put agreement; fi
if [ "$part" != agreement ]; then "$peers" speed --rounds "$rounds" | awk '/^$/ && ++blank == 2 {exit} {print}' | put speed; fi

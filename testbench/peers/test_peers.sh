#!/bin/sh
# docs/peers.md has the rows that the program prints; where the other libraries are, also on fewer pairs now.
. testbench/support/check.sh
page=docs/peers.md
table() { sed -n '/^<!-- agreement -->$/,/^<!-- end of agreement -->$/p' $page; }
# pair and library of each row, the pair's name filled in
labels() { awk -F' *[|] *' 'NF > 8 && $3 !~ /^(library|-+)$/ {if ($2 != "") pair = $2; print pair, $3}'; }
table | labels >"$BUILD/log/peers.page"
for pair in $(sed -nE 's/^HP_PAIR\(.*"([a-z-]+)".*/\1/p' rtl_model/include/hitpipe/pairs.def); do
    check "$page has $pair" grep -qx "$pair hitpipe" "$BUILD/log/peers.page"
    check "$page: $pair beside a library" grep -qE "^$pair (FCL|ODE|Bullet|libccd)\$" "$BUILD/log/peers.page"
done
check "hitpipe is never wrong" sh -c "! grep -E '^\| [a-z-]+ \| hitpipe \|' $page | grep -vE 'hitpipe \| 0 \| 0 \| pipe \| 0 % .* pipe \| 0 % .* pipe \|'"
check "the place of the speed table" grep -qx '<!-- end of speed -->' $page
if [ -x "$BUILD/testbench/peers/peers" ]; then
    check "few pairs again" "$BUILD/testbench/peers/peers" summary --count 50
    printf '%s\n' "$output" | labels >"$BUILD/log/peers.now"
    check "the same rows: make peers-page" diff "$BUILD/log/peers.page" "$BUILD/log/peers.now"
    status 2 "what it does not print" "$BUILD/testbench/peers/peers" weight
    status 2 "a pair that is none" "$BUILD/testbench/peers/peers" summary ray-moon
    status 2 "no pairs" "$BUILD/testbench/peers/peers" agreement --count 0
fi
report

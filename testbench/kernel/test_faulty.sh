#!/bin/sh
# The faults of level 4 as the page has them, without the kernel: docs/testing.md has the rows of `faulty`, and what they name is there.
# Run from the project's root with $BUILD.
. testbench/support/check.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
guest=testbench/kernel/guest

"$BUILD/testbench/kernel/faulty" --rows >"$work/rows"
sed '1,/^## Faults at level 4$/d' docs/testing.md | grep '^| 4 |' >"$work/page"
check "docs/testing.md has every fault, and no other" diff "$work/rows" "$work/page"
check "there are some" test "$(wc -l <"$work/rows")" -gt 20

# Each row names a test and, but for those that the test is told of by `faulty`, a check of it.
while read -r script name; do
    check "$script is there" test -x "$guest/$script.sh"
    [ "$script" = test_faults ] || check "$script has a check '$name'" grep -qF "$name\"" "$guest/$script.sh"
done <<ROWS
$(sed -n 's/.*| `\(test_[a-z]*\): \(.*\)` |$/\1 \2/p' "$work/rows")
ROWS
status 2 "faulty takes no other option" "$BUILD/testbench/kernel/faulty" --list
report

#!/bin/sh
# The golden vectors in the tree are, byte for byte, what their generator makes.
. testbench/support/check.sh

made=$BUILD/vectors
rm -rf "$made"
mkdir -p "$made/ray-triangle"
check "the oracle agrees with every group" "$BUILD/testbench/tools/make_vectors" "$made"
for file in vectors/*/*.hex; do
    check "$file is what make_vectors makes" cmp "$file" "$made/${file#vectors/}"
done
check "every file made is in the tree" sh -c "[ \$(ls '$made'/*/*.hex | wc -l) = \$(ls vectors/*/*.hex | wc -l) ]"
status 1 "a directory that is not there fails" "$BUILD/testbench/tools/make_vectors" "$made/absent"
says "and is named" "absent/ray-triangle/random.hex: No such file or directory"
report

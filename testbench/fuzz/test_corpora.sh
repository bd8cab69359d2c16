#!/bin/sh
# Every fuzzer over the files kept for it. Run from the project's root with $BUILD.
. testbench/support/check.sh

for source in testbench/fuzz/fuzz_*.c; do
    name=$(basename "$source" .c)
    check "$name" "$BUILD/testbench/fuzz/$name" "testbench/fuzz/corpus/${name#fuzz_}"
done
report

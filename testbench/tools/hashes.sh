#!/bin/sh
# hashes.sh "COMPILER OPT"...: builds hash_pipes with each and compares what every instruction set computes with
# vectors/hashes.txt, on 12 million pairs of ray-triangle and 50,000 of each other pipe in each way of underflow; without
# optimisation, and for aarch64, whose program runs under qemu, on fewer. Ends with 'N passed, N failed'.
. testbench/support/check.sh

# hash BUILD COMPILER COUNT RUNNER... : one check for each instruction set of that build
hash() {
    build=$1 compiler=$2 count=$3
    shift 3
    grep -E "^[a-z+-]+ [a-z]+ [0-9]+ ($count|$((count / 240))) " vectors/hashes.txt >"$build/expected"
    check "$compiler: there are hashes of $count pairs" test -s "$build/expected"
    isas="scalar $("$@" "$build/hash_pipes" --isas)"
    for isa in $isas; do
        "$@" "$build/hash_pipes" --count "$count" "$isa" >"$build/$isa.hash" 2>/dev/null &
    done
    wait
    for isa in $isas; do check "$compiler: $isa" cmp "$build/$isa.hash" "$build/expected"; done
}

for compiler in "$@"; do
    case $compiler in # the builds that tests are run in need not be made again
    "gcc -O3") build=build ;;
    "clang -O2") build=build/clang ;;
    *) build=build/hashes-$(echo "$compiler" | tr ' ' '-') ;;
    esac
    check "build with $compiler" make -j "$JOBS" BUILD="$build" CC="${compiler% *}" OPT="${compiler#* }" CFLAGS=-g0 hash_pipes
    case $compiler in
    aarch64*) hash "$build" "$compiler" 500000 qemu-aarch64 -L /usr/aarch64-linux-gnu ;;
    *-O0) hash "$build" "$compiler" 500000 env ;;
    *) hash "$build" "$compiler" 12000000 env ;;
    esac
done
report

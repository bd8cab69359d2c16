#!/bin/sh
# The pictures in docs/ are what the program draws: drawings to the byte, traced pictures to a level of 255 (their files
# depend on the compressor), README's terrain as far as a small one tells.
. testbench/support/check.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/pictures"
export HITPIPE
check "the pictures are drawn" testbench/tools/pictures.sh "$work/pictures"
check "there are 28" test "$(find "$work/pictures" -type f | wc -l)" = 28
check "they are those of docs/pictures" test "$(ls docs/pictures)" = "$(ls "$work/pictures")"
for picture in "$work"/pictures/*; do
    name=$(basename "$picture")
    case $name in
    *.svg) check "docs/pictures/$name: make pictures" cmp "docs/pictures/$name" "$picture" ;;
    *.png) check "docs/pictures/$name: make pictures" "$BUILD/testbench/tools/same_picture" "docs/pictures/$name" "$picture" 1 ;;
    esac
    check "docs/pictures/$name is small" test "$(wc -c <"docs/pictures/$name")" -lt 100000
    check "docs/pipes.md shows $name" grep -qF "(pictures/$name)" docs/pipes.md
done
check "a small terrain" testbench/tools/pictures.sh --terrain "$work/terrain.png" 64x36
check "docs/terrain.png: make terrain-picture" "$BUILD/testbench/tools/same_picture" docs/terrain.png "$work/terrain.png" 10
report

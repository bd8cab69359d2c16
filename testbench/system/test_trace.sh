#!/bin/sh
# hitpipe trace: pictures, rays from files, flights; the same bits by every engine; and scenes that are broken.
. testbench/support/check.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
h=$HITPIPE
terrain=vectors/terrain/jacksboro.exr
field() { # KEY FILE: the number under a JSON key, the first time it stands there
    grep -oE "\"$1\": [0-9.e+-]+" "$2" | head -n 1 | sed 's/.*: //'
}

# ---- a picture ----
small="$terrain --resample 20x30 --size 40x24"
# shellcheck disable=SC2086
{
    status 0 "picture" "$h" trace $small --out "$work/a.exr" --png "$work/a.png" --report "$work/a.json"
    says "summary: triangles" '^scene .*: 1,102 triangles from 20 x 30 samples'
    says "summary: rays" '^rays +960, [0-9]+ hit \([0-9.]+ %\)'
    says "summary: board" '^board +usb3 at 100 MHz, quick engine: .* compute .* read-back'
    says "summary: files" 'wrote .*a\.exr, .*a\.png, .*a\.json'
    check "an EXR file" sh -c "head -c 4 '$work/a.exr' | od -An -tx1 | grep -q '76 2f 31 01'"
    check "a PNG file" sh -c "head -c 8 '$work/a.png' | od -An -tx1 | grep -q '89 50 4e 47 0d 0a 1a 0a'"
    status 0 "clocked" "$h" trace $small --out "$work/b.exr" --png "$work/b.png" --engine clocked --isa plain \
        --threads 1 --report "$work/b.json"
    check "engines agree on every pixel" cmp "$work/a.exr" "$work/b.exr"
    check "and on the shadows" cmp "$work/a.png" "$work/b.png"
    for key in total issue link_to_board ddr_row update idle command fill drain to_board to_host run compute upload; do
        check "engines agree on $key" test "$(field $key "$work/a.json")" = "$(field $key "$work/b.json")"
    done
    check "every pixel and every shadow ray was tested" test "$(field run "$work/a.json")" -gt $((960 * 1102))
    status 0 "no shadows" "$h" trace $small --png "$work/c.png" --no-shadows --json
    says "no shadows: only the pixels" "\"run\": $((960 * 1102)),"
    status 0 "camera" "$h" trace $small --camera 0,0,3000,14000,-15000,500,40 --out "$work/d.csv"
    check "a line for each pixel" test "$(wc -l <"$work/d.csv")" = 961
    status 0 "the same camera" "$h" trace $small --eye 0,0,3000 --at 14000,-15000,500 --fov 40 --out "$work/e.csv"
    check "the same rays" cmp "$work/d.csv" "$work/e.csv"
    status 2 "a camera on its target" "$h" trace $small --eye 1,2,3 --at 1,2,3
}

# ---- rays from a file, and a mesh with a triangle without area ----
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nf 1 2 3\nf 1 2 4\n' >"$work/mesh.obj"
printf '0.25,0.25,1,0,0,-1\n0.5,0,1,0,0,-2\n2,2,2,0,0,1\n' >"$work/rays.csv"
status 0 "rays" "$h" trace "$work/mesh.obj" --rays "$work/rays.csv" --out "$work/r.csv" --report "$work/r.json"
says "degenerate triangles are counted" '2 triangles, 1 without area'
check "and reported" test "$(field degenerate "$work/r.json")" = 1
check "and never hit" test "$(cat "$work/r.csv")" = "primary,secondary,F,T,cpx,cpy,cpz
0,0,1,1,0.25,0.25,0
1,0,1,0.5,0.5,0,0
2,4294967295,0,inf,0,0,0"
status 0 "rays to standard output" "$h" trace "$work/mesh.obj" --rays "$work/rays.csv" --out -
check "nothing else is there" test "$("$h" trace "$work/mesh.obj" --rays "$work/rays.csv" --out -)" = "$(cat "$work/r.csv")"
status 0 "rays to EXR" "$h" trace "$work/mesh.obj" --rays "$work/rays.csv" --out "$work/r.exr"
status 0 "rays to EXR in capitals" "$h" trace "$work/mesh.obj" --rays "$work/rays.csv" --out "$work/R.EXR"
check "an EXR all the same" cmp "$work/r.exr" "$work/R.EXR"
check "a picture to standard output" sh -c "'$h' trace '$work/mesh.obj' --size 8x8 --png - >'$work/s.png'"
check "the picture by name" "$h" trace "$work/mesh.obj" --size 8x8 --png "$work/t.png"
check "nothing but the picture was there" cmp "$work/s.png" "$work/t.png"
status 2 "two things on standard output" "$h" trace "$work/mesh.obj" --size 8x8 --png - --out -
status 2 "JSON and a file on standard output" "$h" trace "$work/mesh.obj" --size 8x8 --json --out -
status 0 "the default camera sees a mesh" "$h" trace "$work/mesh.obj" --size 32x32 --json
check "it hits" sh -c "[ \"\$('$h' trace '$work/mesh.obj' --size 32x32 --json | grep -oE '\"hits\": [0-9]+' | grep -oE '[0-9]+')\" -gt 50 ]"

# names of files need not be UTF-8, JSON must be
odd=$(printf '%s/m\303\050.obj' "$work")
cp "$work/mesh.obj" "$odd"
status 0 "a name that is not UTF-8" "$h" trace "$odd" --size 2x2 --json
says "it is in the report" '"file": ".*m\?\(\.obj"'

# ---- a flight ----
flight() { # SCENE-SIZE FRAMES ARGUMENT...
    size=$1 frames=$2
    shift 2
    "$h" trace $terrain --resample "$size" --flight "$frames" "$@"
}
for moving in "" --moving; do
    for mode in closest all; do
        # shellcheck disable=SC2086
        status 0 "flight $mode $moving" flight 20x30 5 --board wscg2007 --mode $mode $moving --report "$work/f.json" \
            --out "$work/f.csv"
        says "flight $mode $moving: table" '^read_back +[0-9.]+ +[0-9.]+ +[0-9.]+$'
        lines=6
        [ $mode = closest ] || lines=$((5 * 1102 + 1))
        check "flight $mode $moving: lines" test "$(wc -l <"$work/f.csv")" = $lines
        check "flight $mode $moving: frames" test "$(field count "$work/f.json")" = 5
        check "flight $mode $moving: tests" test "$(field run "$work/f.json")" = $((5 * 1102))
        # shellcheck disable=SC2086
        check "flight $mode $moving clocked" flight 20x30 5 --board wscg2007 --mode $mode $moving --engine clocked \
            --out "$work/g.csv"
        check "flight $mode $moving: engines agree" cmp "$work/f.csv" "$work/g.csv"
    done
done
check "the same flight again" flight 20x30 5 --out "$work/f1.csv"
check "moving" flight 20x30 5 --moving --out "$work/f2.csv"
check "moving changes what is hit" sh -c "! cmp -s '$work/f1.csv' '$work/f2.csv'"

# one triangle a clock: a frame on the ideal board takes as many clocks more as the scene has triangles more
compute_clocks() { flight "$1" 3 --board ideal --json | awk '/"compute"/ {inside = 1} inside && /"min"/ {print $2 + 0; exit}'; }
check "one triangle a clock" test $(($(compute_clocks 50x60) - $(compute_clocks 20x30))) = $((2 * 49 * 59 - 1102))

# the paper's terrain, one ray: the closed form of docs/timing.md
clocks=$(flight 292x447 1 --board ideal --json | awk '/"compute"/ {inside = 1} inside && /"min"/ {print $2 + 0; exit}')
latency=$("$h" info --pipes --json --board ideal | awk '/"clocks":/ {print $2 + 0; exit}')
check "one ray against the terrain: fill, issues, drain, flush" test "$clocks" = $((1 + 259572 + latency + 1))

for frames in 0 -1 1000001 -18446744073709551615 2x ''; do status 2 "flight of '$frames' frames" flight 20x30 "$frames"; done
status 2 "flight with a picture's size" flight 20x30 5 --size 4x4
status 2 "no shadows of no picture" flight 20x30 5 --no-shadows
for size in 0x0 4 4x4x4 -4x4 65537x1 4x 1e1x4 ''; do status 2 "size '$size'" "$h" trace "$work/mesh.obj" --size "$size"; done
for size in -5x-5 999999999x2 9 0x0 ''; do status 2 "resampling to '$size'" "$h" trace $terrain --resample "$size"; done
for spacing in nan,1 1,inf 0,1 1,,1 1,1,; do
    status 2 "spacing '$spacing'" "$h" trace $terrain --resample 4x4 --size 2x2 --spacing "$spacing"
done
status 2 "moving without a flight" "$h" trace "$work/mesh.obj" --moving
status 2 "mode all without a flight" "$h" trace "$work/mesh.obj" --mode all
status 2 "a flight as EXR" flight 20x30 5 --out "$work/f.exr"
status 2 "a picture of a flight" flight 20x30 5 --png "$work/f.png"

# ---- bad scenes ----
bad_scene() { # STATUS NAME WORDS ARGUMENT...
    bad_status=$1 bad_name=$2 bad_words=$3
    shift 3
    status "$bad_status" "$bad_name" "$h" trace "$@"
    says "$bad_name" "$bad_words"
}
bad_scene 3 "no such scene" 'none\.obj: No such file' "$work/none.obj"
printf 'v 0 0 0\n' >"$work/empty.obj"
bad_scene 3 "empty mesh" 'empty\.obj: the mesh has no triangles' "$work/empty.obj"
printf 'v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n' >"$work/nan.obj"
bad_scene 3 "NaN vertex" 'nan\.obj:2:[0-9]+: vertex 2: a coordinate is NaN' "$work/nan.obj"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n' >"$work/index.obj"
bad_scene 3 "index out of range" 'index\.obj:4:[0-9]+: vertex index 4' "$work/index.obj"
printf 'v 0 0 0\nv 1 0' >"$work/cut.obj"
bad_scene 3 "OBJ cut off" 'cut\.obj:2:[0-9]+: a vertex needs three numbers' "$work/cut.obj"
for scene in testbench/fuzz/corpus/ply/huge-count.ply testbench/fuzz/corpus/ply/little-cut-off.ply \
    testbench/fuzz/corpus/stl/huge-count.stl testbench/fuzz/corpus/stl/text-cut-off.stl \
    testbench/fuzz/corpus/exr/cut-off.exr testbench/fuzz/corpus/exr/huge-window.exr; do
    bad_scene 3 "$scene" "$(basename $scene)" "$scene"
done
head -c 100000 $terrain >"$work/cut.exr"
bad_scene 3 "EXR cut off" 'cut\.exr: ' "$work/cut.exr"
{ head -c 5000 $terrain && head -c 1000 /dev/zero && tail -c +6001 $terrain; } >"$work/damaged.exr"
bad_scene 3 "EXR damaged" 'damaged\.exr: ' "$work/damaged.exr"
printf 'P5\n9 9\n255\nabc' >"$work/cut.pgm"
bad_scene 3 "PGM cut off" 'cut\.pgm:.*truncated' "$work/cut.pgm"
printf 'not a mesh at all\n' >"$work/nothing.dae"
bad_scene 3 "nothing that assimp reads" 'nothing\.dae: ' "$work/nothing.dae"
bad_scene 2 "resampling a mesh" 'only heightfields' "$work/mesh.obj" --resample 3x3
bad_scene 2 "resampling to a line" '2 x 2 samples' $terrain --resample 1x9
echo '{"ddr": {"bytes": 36000}}' >"$work/tiny.json"
bad_scene 4 "more triangles than the DDR holds" '[0-9]' $terrain --resample 20x30 --board "$work/tiny.json" --size 2x2
# more than the host's memory holds is refused, and not tried; a sanitizer's own memory leaves no room for the limit
if [ -z "${SANITIZE:-}" ]; then
    bad_scene_in() { # GIBIBYTES ARGUMENT...: as bad_scene, in so little memory
        status 4 "memory: $*" sh -c "ulimit -v $(($1 << 20)) && shift && exec '$h' trace \"\$@\"" sh "$@"
        says "memory: $*" 'no memory for'
    }
    bad_scene_in 4 "$work/mesh.obj" --size 20000x20000
    bad_scene_in 4 $terrain --resample 8000x8000 --size 2x2
fi
for option in --out --png --report; do
    bad_scene 4 "$option to a full disk" 'dev/full: cannot be written: No space' "$work/mesh.obj" --size 4x4 $option /dev/full
    bad_scene 4 "$option to nowhere" 'none/x: cannot be written: No such file' "$work/mesh.obj" --size 4x4 $option "$work/none/x"
done
report

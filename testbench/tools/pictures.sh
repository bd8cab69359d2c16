#!/bin/sh
# pictures.sh DIRECTORY: draws the pictures of docs/pipes.md there. Run from the project's root.
#
# Of each pair a hit and a miss out of examples/objects, and for rays what a camera sees of spheres and of cylinders; of
# triangles that is README's terrain (pictures.sh --terrain FILE.png, minutes of work).
set -eu
: "${HITPIPE:=build/hitpipe}"

if [ "$1" = --terrain ]; then
    "$HITPIPE" trace vectors/terrain/jacksboro.exr --resample 292x447 --size "${3:-960x540}" --png "$2"
    exit
fi
directory=$1
trace() { "$HITPIPE" trace "examples/$1.csv" --size 400x300 --png "$2" --json "$3" "$4" "$5" >/dev/null; }
trace spheres "$directory/ray-sphere.png" --eye=-5,-3.2,2.6 --at=0,0,-0.02 --fov=28.5
trace cylinders "$directory/ray-cylinder.png" --eye=-52,-30,5 --at=0,0,45 --fov=78

for pair in $(sed -nE 's/^HP_PAIR\(.*"([a-z-]+)".*/\1/p' rtl_model/include/hitpipe/pairs.def); do
    draw() { "$HITPIPE" draw "$pair" -p "examples/objects/${pair%-*}.csv" -s "examples/objects/${pair#*-}.csv" -i "$1" -o "$2"; }
    draw 1,0 "$directory/$pair-hit.svg"
    draw 2,0 "$directory/$pair-miss.svg"
done

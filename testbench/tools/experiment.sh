#!/bin/sh
# The paper's three experiments on the simulated board, as the tables of docs/experiment.md. Run from the project's root.
set -eu
: "${HITPIPE:=build/hitpipe}" "${BUILD:=build}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
printf '{"preset": "wscg2007", "name": "PCI at half its peak", "link": {"to_board_bytes_per_second": 264000000,
 "to_host_bytes_per_second": 264000000}}' >"$work/half.json"

# row NAME BOARD ARGUMENT...: milliseconds a frame, mean of the frames
row() {
    name=$1 board=$2
    shift 2
    "$HITPIPE" trace vectors/terrain/jacksboro.exr --resample 292x447 --flight 20 --separation off --board "$board" "$@" --json >"$work/out"
    field() { # mean seconds of a phase, from the object frame.seconds
        awk -v phase="\"$1\"" '/"seconds"/ {inside = 1} inside && $0 ~ phase {found = 1}
            found && /"mean"/ {gsub(/[^0-9.e-]/, "", $2); printf "%.3f", $2 * 1000; exit}' "$work/frame"
    }
    awk '/"frame": *\{/ {f = 1} f' "$work/out" >"$work/frame"
    printf '| %s | %s | %s | %s | %s |\n' "$name" "$(field upload)" "$(field compute)" "$(field read_back)" "$(field total)"
}

echo '| one ray a frame against 259,572 triangles, ms of board time | upload | compute | read-back | sum |'
echo '|---|---|---|---|---|'
row 'static, mode `closest`, `wscg2007`' wscg2007 --mode closest
row 'static, mode `all`, `wscg2007`' wscg2007 --mode all
row 'moving, mode `closest`, `wscg2007`' wscg2007 --mode closest --moving
row 'moving, mode `all`, `wscg2007`' wscg2007 --mode all --moving
row 'static, mode `all`, PCI at half its peak' "$work/half.json" --mode all
row 'moving, mode `all`, PCI at half its peak' "$work/half.json" --mode all --moving
row 'static, mode `closest`, `usb3`' usb3 --mode closest
row 'static, mode `closest`, `ideal`' ideal --mode closest

# swarm NAME BOARD WAY: the third, by testbench/tools/swarm.c
swarm() {
    # shellcheck disable=SC2046,SC2183  # its five numbers are five words
    printf '| %s | %s | %s | %s | %s | %s |\n' "$1" $("$BUILD/testbench/tools/swarm" "$2" "$3")
}

echo
echo '| 1,000 moving spheres, ms of board time a frame | upload | compute | read-back | sum | collisions found |'
echo '|---|---|---|---|---|---|'
swarm 'all against all, mode `all`, `wscg2007`' wscg2007 all
swarm 'each pair once, mode `all`, `wscg2007`' wscg2007 once
swarm 'all against all, mode `any`, `wscg2007`' wscg2007 any
swarm 'all against all, mode `all`, PCI at half its peak' "$work/half.json" all
swarm 'each pair once, mode `all`, PCI at half its peak' "$work/half.json" once
swarm 'all against all, mode `all`, `usb3`' usb3 all
swarm 'each pair once, mode `all`, `usb3`' usb3 once
swarm 'all against all, mode `all`, `ideal`' ideal all

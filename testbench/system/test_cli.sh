#!/bin/sh
# The command line: verbs, options, exit statuses, and every bad input with the words that a person needs.
. testbench/support/check.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
h=$HITPIPE

begins() { # NAME LINE: that is the first line of $output
    if [ "$(printf '%s\n' "$output" | head -n 1)" = "$2" ]; then good; else bad "$1: $output"; fi
}

pairs=$(sed -nE 's/^HP_PAIR\(.*"([a-z-]+)".*/\1/p' rtl_model/include/hitpipe/pairs.def)
check "there are thirteen pairs" test "$(echo "$pairs" | wc -l)" = 13

# ---- verbs and options ----
status 2 "no verb" "$h"
says "no verb" 'Usage: hitpipe VERB'
status 0 "help" "$h" --help
says "help" '^  trace '
status 0 "version" "$h" --version
says "version" '^hitpipe [0-9]+\.[0-9]+\.[0-9]+$'
status 2 "unknown verb" "$h" trase
says "unknown verb" "no verb 'trase'; did you mean 'trace'"
status 2 "unknown option" "$h" --verbose
says "unknown option" "no option '--verbose'"
for verb in info trace query draw replay; do
    status 0 "$verb --help" "$h" $verb --help
    says "$verb --help" "Usage: hitpipe $verb"
    status 2 "$verb --nonsense" "$h" $verb --nonsense
    says "$verb --nonsense" "hitpipe $verb: unrecognized option '--nonsense'"
    says "$verb --nonsense gives a hint" "Try .hitpipe $verb --help"
    status 2 "$verb --engine steam" "$h" $verb --engine steam
    says "$verb --engine steam" "quick or clocked, not 'steam'"
    status 3 "$verb --board nowhere" "$h" $verb --board nowhere
    says "$verb --board nowhere" 'there are usb3, wscg2007, ideal'
done
status 2 "--vcd with the quick engine" "$h" info --vcd "$work/x.vcd"
for count in many -1 1025 4294967297 1e3 ''; do status 2 "threads '$count'" "$h" info --threads "$count"; done
status 2 "two things to show" "$h" info --pipes --config
status 2 "a report of no board" "$h" info --pipes --report "$work/x.json"
status 2 "an ISA that is none" "$h" info --isa mmx
status 2 "HP_ISA that is none" env HP_ISA=mmx "$h" info
status 0 "HP_ISA that is empty" env HP_ISA= "$h" info
status 4 "a target that is none" "$h" info --target moon
says "a target that is none" 'there are model, usb, usb:SERIAL and null'
status 4 "no board on USB" "$h" info --target usb --usb-id fFfF:0
says "no board on USB" 'no board on USB with the identifiers ffff:0000$'
for id in 1209 1209:0001: 1209:x 0x1209:1 :1 1209:-1 12090:1 1209:00001 ''; do status 2 "USB id '$id'" "$h" info --usb-id "$id"; done
for depth in 0 33 4x ''; do status 2 "USB depth '$depth'" "$h" info --usb-depth "$depth"; done
for bytes in 1000 16778240 -1024; do status 2 "USB transfer '$bytes'" "$h" info --usb-transfer "$bytes"; done
for seconds in -1 1.5 86401; do status 2 "reconnect '$seconds'" "$h" info --reconnect "$seconds"; done
status 2 "trace without scene" "$h" trace
status 2 "trace with two scenes" "$h" trace a.obj b.obj
status 2 "query without pair" "$h" query -p a -s b
status 2 "query of no pair" "$h" query ray-moon -p a -s b
says "query of no pair" "no pair 'ray-moon'; there are ray-triangle, .*, sphere-obb\$"
status 2 "nearest of mode all" "$h" query ray-triangle -p a -s b -m all --nearest
status 2 "nearest without separation" "$h" query ray-triangle -p a -s b --nearest --separation off
status 2 "separation that is neither" "$h" query ray-triangle -p a -s b --separation yes
says "separation that is neither" "on or off, not 'yes'"
status 2 "query without files" "$h" query ray-triangle
status 2 "query of no mode" "$h" query ray-triangle -p a -s b -m some
status 2 "a matrix too short" "$h" query ray-triangle -p a -s b -t 1,2,3

# ---- info ----
status 0 "info" "$h" info
says "info" '^pipes +ray-triangle'
status 0 "info --json" "$h" info --json
says "info --json" '"target": "model"'
status 0 "info --pipes" "$h" info --pipes
says "the paper's operators" '^ray-triangle +27 +1 +0 +12 +15 '
for pair in $pairs; do
    says "operators of $pair" "^$pair( +[0-9]+){12}\$"
done
printf '%s\n' "$output" >"$work/pipes"
check "each pair again, with separation" test "$(grep -cE '^  with separation( +[0-9]+){12}$' "$work/pipes")" = 13
check "it fits in 120 columns" test -z "$(grep -E '.{121}' "$work/pipes")"
printf '{"pipes": ["ray-triangle", "sphere-obb"]}' >"$work/two.json"
status 0 "info --pipes of two pipes" "$h" info --pipes --board "$work/two.json"
says "which are not there" '^obb-obb .*  not resident$'
check "the two are" test "$(printf '%s\n' "$output" | grep -c 'not resident')" = 11
status 0 "info --report" "$h" info --report "$work/info.json"
check "the report is there" grep -q '"to_board": [1-9]' "$work/info.json"
status 0 "info --report -" "$h" info --report -
begins "the report alone" '{'
status 0 "info --pipes --json" "$h" info --pipes --json
printf '%s\n' "$output" >"$work/pipes.json"
for key in multipliers dividers square_roots adders subtractors comparators ands ors selects levels clocks interval; do
    check "pipe key $key, twice a pair" test "$(grep -c "\"$key\": [0-9]" "$work/pipes.json")" = 26
done
status 0 "info --config" "$h" info --config --board wscg2007
says "a knob" '^ddr\.row_beats +512 '
status 0 "info --config --json" "$h" info --config --json
says "a knob" '"key": "lanes"'
status 4 "info to a full disk" sh -c "'$h' info --config >/dev/full"
says "by its name" 'standard output: cannot be written: No space left'

# ---- verbs of the control plane; test_umockdev has boards for them ----
for verb in reset watch; do
    status 0 "$verb --help" "$h" $verb --help
    says "$verb --help" "Usage: hitpipe $verb"
    status 2 "$verb of something" "$h" $verb it
    status 2 "$verb --engine" "$h" $verb --engine quick
    for target in model null usb: usb3 ''; do
        status 2 "$verb --target '$target'" "$h" $verb --target "$target"
        says "$verb --target '$target'" "usb or usb:SERIAL here, not '$target'"
    done
done
for hz in 0 -1 1e8 '' 99999999999999999999; do status 2 "a clock of '$hz'" "$h" reset --clock "$hz"; done
for count in 0 -1 many ''; do status 2 "a count of '$count'" "$h" watch --count "$count"; done
for seconds in 0 -1 nan long '' 1e10; do status 2 "'$seconds' seconds" "$h" watch --seconds "$seconds"; done

# ---- query ----
cat >"$work/rays.csv" <<END
ox,oy,oz,dx,dy,dz
0.25,0.25,5,0,0,-2   # hits the upper, then the lower
0.75,0.75,5,0,0,-1   # misses both
0,0,0.5,0,0,-1       # a corner of the lower
END
cat >"$work/triangles.csv" <<END
0,0,0, 1,0,0, 0,1,0
0,0,1, 1,0,1, 0,1,1
0,0,0, 1,1,1, 2,2,2  # no area
END
q() { "$h" query ray-triangle --primary "$work/rays.csv" --secondary "$work/triangles.csv" "$@"; }
same() { # NAME EXPECTED: $output is exactly that
    if [ "$output" = "$2" ]; then good; else bad "$1: $output"; fi
}
status 0 "closest" q
same "closest" "primary,secondary,F,T,cpx,cpy,cpz
0,1,1,2,0.25,0.25,1
1,4294967295,0,inf,0,0,0
2,0,1,0.5,0,0,0"
status 0 "any" q --mode any
same "any: the lowest index" "primary,secondary,F,T,cpx,cpy,cpz
0,0,1,2.5,0.25,0.25,0
1,4294967295,0,inf,0,0,0
2,0,1,0.5,0,0,0"
status 0 "zip" q --mode zip
same "zip" "primary,secondary,F,T,cpx,cpy,cpz
0,0,1,2.5,0.25,0.25,0
1,1,0,0.353553385,0,0,0
2,2,0,0,0,0,0"
status 0 "all" q --mode all
if [ "$(echo "$output" | tail -n +2 | sort -t, -k1n -k2n | head -n 3)" = "0,0,1,2.5,0.25,0.25,0
0,1,1,2,0.25,0.25,1
0,2,0,0,0,0,0" ] && [ "$(echo "$output" | wc -l)" = 10 ]; then good; else bad "all: $output"; fi
status 0 "clocked" q --engine clocked
same "clocked" "$(q)"
status 0 "moved" q --transform "1,0,0,0, 0,1,0,0, 0,0,1,3"
says "moved" '^0,1,1,0.5,0.25,0.25,4$'
# just above the middle of two floats: by way of a double it would become the lower one
printf '0.25,0.25,0,0,0,1\n' >"$work/up.csv"
printf '0,0,0,1,0,0,0,1,0\n' >"$work/flat.csv"
status 0 "moved to the nearest" "$h" query ray-triangle --primary "$work/up.csv" --secondary "$work/flat.csv" \
    --transform "1,0,0,0, 0,1,0,0, 0,0,1,1.0000000596046447753906251"
says "moved to the nearest" '^0,0,1,1\.00000012,'
for words in "1,0,0,0, 0,1,0,0, 0,0,1" "1,0,0,0,,0,1,0,0, 0,0,1,3" "1,0,0,0, 0,1,0,0, 0,0,1,3," "1,0,0,0, 0,1,0,0, 0,0,1,3x"; do
    status 2 "no 12 numbers: $words" q --transform "$words"
done
# standard output takes one thing: the report, the results or the waveform
status 0 "--report -" q --report -
begins "no results before" '{'
status 0 "--vcd -" q --vcd - --engine clocked
begins "no results before" '$version hitpipe clocked engine $end'
for two in "--json --report -" "--json --out -" "--out - --report -" "--report - --vcd - --engine clocked"; do
    # shellcheck disable=SC2086
    status 2 "on standard output: $two" q $two
    says "on standard output: $two" 'standard output takes one thing'
done
status 0 "to a file" q --out "$work/r.csv" --report "$work/report.json"
check "the file" sh -c "[ \"\$(cat $work/r.csv)\" = \"\$('$h' query ray-triangle -p $work/rays.csv -s $work/triangles.csv)\" ]"
for key in clocks.total stalls.idle bytes.to_board bytes.to_host tests.run tests.skipped seconds.board seconds.host; do
    output=$(cat "$work/report.json")
    says "report: group of $key" "\"${key%.*}\": \{"
    says "report: $key" "\"${key#*.}\": [0-9]"
done
says "report: tests run" '"run": 9,'
for key in board engine target isa; do says "report: $key" "\"$key\": \"[a-z0-9]+\""; done

# ---- draw ----
d() { "$h" draw "$@" --out "$work/d.svg"; }
object() { echo "examples/objects/$1.csv"; }
for pair in $pairs; do
    primary=$(object "${pair%-*}") secondary=$(object "${pair#*-}")
    status 0 "draw $pair, a hit" d "$pair" -p "$primary" -s "$secondary" -i 1,0 --json
    says "$pair: F" '"F": 1'
    output=$(cat "$work/d.svg")
    says "$pair: a bar for T" 'class="measure bar"'
    says "$pair: CP" '>CP</text>'
    says "$pair: in words" ">$pair: F 1, T [0-9.]+ \\((penetration depth|lengths of the direction)\\)<"
    status 0 "draw $pair, a miss" d "$pair" -p "$primary" -s "$secondary" -i 2,0 --json
    says "$pair: F" '"F": 0'
    says "$pair: the nearest points" '"on_secondary": \['
    check "$pair: no CP" sh -c "! grep -q '>CP<' '$work/d.svg'"
    check "$pair: the distance in words" grep -q ">$pair: F 0, T [0-9.]* (distance)<" "$work/d.svg"
done
status 0 "concentric balls" d sphere-sphere -p "$(object sphere)" -s "$(object sphere)"
check "no single direction" grep -q '(penetration depth, direction unclear)' "$work/d.svg"
status 2 "draw without files" d sphere-obb
says "draw without files" '--primary and --secondary are needed'
status 2 "draw to nowhere" "$h" draw sphere-obb -p a -s b
says "draw to nowhere" '--out is needed'
status 2 "draw of no number" d sphere-obb -p a -s b -i one
says "draw of no number" "--index takes I or I,J, counted from 0, not 'one'"
for view in 30 30,91 361,0 a,b nan,0; do status 2 "a view from $view" d sphere-obb -p a -s b "--view=$view"; done
status 3 "draw what is not there" d sphere-obb -p "$(object sphere)" -s "$(object obb)" -i 7
says "draw what is not there" 'sphere\.csv: there is no sphere 7: the file has 3, counted from 0'
status 4 "draw without the pipe" d obb-obb -p "$(object obb)" -s "$(object obb)" --board "$work/two.json"

# ---- bad input ----
bad_rays() { # NAME WORDS LINE...: exit 3 with the words
    bad_name=$1 bad_words=$2
    shift 2
    printf '%s\n' "$@" >"$work/bad.csv"
    status 3 "$bad_name" "$h" query ray-triangle -p "$work/bad.csv" -s "$work/triangles.csv"
    says "$bad_name" "$bad_words"
}
bad_rays "zero direction" 'bad\.csv:2:1: direction is zero' '1,2,3,4,5,6' '1,2,3,0,0,0'
bad_rays "NaN" 'bad\.csv:1:3: a NaN' '1,nan,3,0,0,1'
bad_rays "past binary32" 'bad\.csv:1:3: an infinity, or a number past binary32' '1,1e39,3,0,0,1'
bad_rays "a word" "bad\.csv:2:7: 'four' is not a number" '1,2,3,4,5,6' '1,2,3,four,5,6'
bad_rays "cut off" 'a ray has 6 numbers: origin xyz, .*; here are 3' '1,2,3'
bad_rays "empty" 'no ray in the file' ''
status 3 "no such file" "$h" query ray-triangle -p "$work/none.csv" -s "$work/triangles.csv"
says "no such file" 'none\.csv: No such file'
head -n 2 "$work/rays.csv" >"$work/one.csv"
status 3 "zip of different counts" "$h" query ray-triangle -m zip -p "$work/one.csv" -s "$work/triangles.csv"
says "zip of different counts" 'as many secondaries as primaries, here are 3 and 1'
status 3 "a matrix that is no number" q --transform "nan,0,0,0, 0,1,0,0, 0,0,1,3"
says "a matrix that is no number" '--transform: number 1 of 12 is a NaN'
status 3 "a matrix past binary32" q --transform "1,0,0,1e39, 0,1,0,0, 0,0,1,3"
says "a matrix past binary32" '--transform: number 4 of 12 is an infinity, or past binary32'
status 3 "a directory" "$h" query ray-triangle -p "$work" -s "$work/triangles.csv"
says "a directory" 'Is a directory'
status 3 "no name" "$h" query ray-triangle -p '' -s "$work/triangles.csv"
says "no name" "'': No such file"
status 2 "standard input twice" "$h" query ray-triangle -p - -s -
says "standard input twice" 'cannot both be standard input'
status 2 "types the other way round" "$h" query obb-sphere -p a -s b
says "types the other way round" "no pair 'obb-sphere', but sphere-obb: swap primaries and secondaries"

# ---- every pair as a new user would ask it ----
rigid=0.6,-0.8,0,1,0.8,0.6,0,2,0,0,1,-1 mirror=-1,0,0,0,0,1,0,0,0,0,1,0 along=2,0,0,1,0,1,0,0,0,0,3,0
rounded=0.6,-0.8,0,1,0.8,0.6,0,2,0,0,1.0001,-1 shear=1,0.5,0,0,0,1,0,0,0,0,1,0 flat=1,0,0,0,0,1,0,0,0,0,0,0
echo '{"pipes": ["ray-triangle"]}' >"$work/one.json"
echo '{"pipes": ["sphere-sphere"]}' >"$work/other.json"
for pair in $pairs; do
    primary=$(object "${pair%-*}") secondary=$(object "${pair#*-}")
    p=$(grep -c '^[^#]' "$primary") s=$(grep -c '^[^#]' "$secondary")
    a() { "$h" query "$pair" --primary "$primary" --secondary "$secondary" "$@"; }
    # asks MODE ARGUMENT...: what comes is kept in $came, for checks write $output anew
    asks() {
        asks_name="$pair $*"
        status 0 "$asks_name" a "$@"
        came=$(printf '%s\n' "$output" | grep '^[0-9]')
    }
    lines() { check "$asks_name: $1 records" test "$(printf '%s\n' "$came" | wc -l)" = "$1"; }
    misses() { printf '%s\n' "$came" | awk -F, '$3 == 0 {print $4}'; } # their T
    asks --mode closest
    lines "$p"
    asks --mode any
    lines "$p"
    asks --mode all --separation off
    lines $((p * s))
    check "$asks_name: no distances" test "$(misses | grep -vc inf)" = 0
    asks --mode all
    lines $((p * s))
    check "$asks_name: distances" test "$(misses | grep -c inf)" = 0
    every=$came
    asks --mode all --engine clocked
    check "$asks_name: the same" test "$came" = "$every"
    asks --nearest
    lines "$p"
    check "$asks_name: each stands in all" test "$(printf '%s\n' "$came" | grep -vxcF "$every")" = 0
    sed "$((s + 1))q" "$primary" >"$work/short.csv" # and the comment
    asks --primary "$work/short.csv" --mode zip
    lines "$s"
    check "$asks_name: each stands in all" test "$(printf '%s\n' "$came" | grep -vxcF "$every")" = 0
    for matrix in "$rigid" "$along" "$rounded" "$shear" "$mirror" "$flat"; do
        case ${pair#*-}:$matrix in
        triangle:* | aabb:"$along") wanted=0 ;;
        aabb:*) wanted=3 ;;
        *:"$rigid" | *:"$mirror") wanted=0 ;;
        *) wanted=3 ;;
        esac
        status $wanted "$pair moved by $matrix" a --transform "$matrix"
        [ $wanted = 0 ] || says "$pair refuses $matrix by name" "--transform: an? ${pair#*-} cannot carry a"
    done
    board=$work/one.json
    [ "$pair" = ray-triangle ] && board=$work/other.json
    status 4 "$pair without its pipe" a --board "$board"
    says "$pair without its pipe" "board 'usb3' has no pipe $pair; it has (ray-triangle|sphere-sphere)\$"
done
status 3 "a rotation of four digits" "$h" query sphere-obb -p "$(object sphere)" -s "$(object obb)" -t "$rounded"
says "a rotation of four digits" 'an obb cannot carry a scale or a shear: row 3 has the squared length 1\.0002, not 1'
status 3 "a shear" "$h" query sphere-obb -p "$(object sphere)" -s "$(object obb)" -t "$shear"
says "a shear" 'rows 1 and 2 have the scalar product 0\.5, not 0'

echo '{"ddr": {"bytes": 72}}' >"$work/tiny.json"
status 4 "more triangles than the DDR holds" q --board "$work/tiny.json"
says "more triangles than the DDR holds" '3 objects of type triangle: the board holds 2'
echo older >"$work/older.csv"
status 4 "the same, with results from before" q --board "$work/tiny.json" --out "$work/older.csv"
check "they stay" grep -qx older "$work/older.csv"
status 4 "the same, with none" q --board "$work/tiny.json" --out "$work/newer.csv"
check "none appear" test ! -e "$work/newer.csv"
echo '{"lanes": 65}' >"$work/lanes.json"
status 3 "a knob out of its range" q --board "$work/lanes.json"
says "a knob out of its range" 'lanes\.json: .*lanes.*64'
echo '{"wings": 2}' >"$work/wings.json"
status 3 "an unknown knob" q --board "$work/wings.json"
says "an unknown knob" 'wings\.json: .*wings'
status 4 "full disk" q --out /dev/full
says "full disk" '/dev/full: cannot be written: No space left'
status 4 "full disk in mode all" q --mode all --out /dev/full
says "full disk in mode all" '/dev/full: cannot be written'
status 4 "no such directory" q --out "$work/none/r.csv"
status 4 "report to a full disk" q --out "$work/r.csv" --report /dev/full
status 4 "waveform to a full disk" q --out "$work/r.csv" --engine clocked --vcd /dev/full
# a bar on a terminal, for what takes more than a second, whatever it waits for; then it goes away
if command -v script >/dev/null; then
    slow="(sleep 1.5; cat '$work/rays.csv') | '$h' query ray-triangle -p - -s '$work/triangles.csv' --out '$work/r.csv'"
    output=$(script -qec "$slow" /dev/null </dev/null | tr '\r' '\n')
    says "a bar after a second" '^reading +\[\.{40}\]   0 %  since 1 s'
    check "none at the end" test "$(printf '%s' "$output" | tail -n 1 | cut -c1-3)" = "$(printf '\033[K')"
    quick="'$h' query ray-triangle -p '$work/rays.csv' -s '$work/triangles.csv' --out '$work/r.csv'"
    check "none for what is quick" test -z "$(script -qec "$quick" /dev/null </dev/null)"
fi
# a pipe is written to once, and a link that leads nowhere stays a link
mkfifo "$work/pipe"
cat "$work/pipe" >"$work/through-the-pipe" &
check "report into a pipe" timeout 20 "$h" query ray-triangle -p "$work/rays.csv" -s "$work/triangles.csv" -o "$work/r.csv" \
    --report "$work/pipe"
wait
check "it came through" grep -q '"run": 9' "$work/through-the-pipe"
ln -s "$work/to-be-made" "$work/link"
status 0 "report through a link" q --out "$work/r.csv" --report "$work/link"
check "the link stays, and the file is where it leads" sh -c "test -h '$work/link' && test -s '$work/to-be-made'"
report

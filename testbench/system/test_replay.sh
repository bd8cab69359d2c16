#!/bin/sh
# hitpipe replay: golden vectors pass on every instruction set and engine; a changed bit or a broken file does not.
. testbench/support/check.sh
: "${HITPIPE:=$BUILD/hitpipe}"

work=$BUILD/replay
vectors=vectors/ray-triangle
rm -rf "$work"
mkdir -p "$work"

# records FILE...: how many there are
records() { cat "$@" | grep -c '^[0-9a-f]'; }
all=$(records $vectors/*.hex)

# flip FILE RECORD WORD BIT: the file with one bit changed; records and words from 0
flip() {
    awk -v record="$2" -v word="$3" -v bit="$4" '
        BEGIN { digits = "0123456789abcdef" }
        /^\/\// || NF == 0 { print; next }
        n++ != record { print; next }
        {
            at = 8 - int(bit / 4)
            weight = 2 ^ (bit % 4)
            old = index(digits, substr($(word + 1), at, 1)) - 1
            new = int(old / weight) % 2 ? old - weight : old + weight
            $(word + 1) = substr($(word + 1), 1, at - 1) substr(digits, new + 1, 1) substr($(word + 1), at + 1)
            print
        }' "$1" >"$work/flipped.hex"
}

# ---- they pass ----
isas=0
for isa in plain sse2 avx2 avx512 neon; do
    HP_ISA=$isa "$HITPIPE" info >/dev/null 2>&1 || continue
    isas=$((isas + 1))
    for engine in quick clocked; do
        check "all vectors, $isa, $engine" env HP_ISA=$isa "$HITPIPE" replay --engine $engine $vectors/*.hex
        check "of all records" [ "$(echo "$output" | tail -n 1 | tr -d ,)" = "11 files $all records 0 differ" ]
    done
done
check "at least plain C was there" [ $isas -ge 1 ]
for board in wscg2007 ideal; do
    check "all vectors on board $board" "$HITPIPE" replay --board $board $vectors/*.hex
done
check "two threads" "$HITPIPE" replay --threads 2 $vectors/*.hex

# ---- a changed bit does not: every field of the answer, and every word of both objects ----
line=$(awk '!/^\/\// && NF { print NR; exit }' $vectors/random.hex)
field=0
for name in F index T CP.x CP.y CP.z; do
    for bit in 0 7 22 31; do
        flip $vectors/random.hex 0 $((15 + field)) $bit
        status 1 "bit $bit of $name" "$HITPIPE" replay "$work/flipped.hex"
        says "$name, bit $bit: its place" "^$work/flipped.hex:$line: record 0 differs, group 'anywhere'"
        says "$name, bit $bit: its field" "^  $name +[0-9a-f]{8} .* differs\$"
        says "$name, bit $bit: nothing else" "^1 file, 500 records, 1 differ\$"
        check "only $name differs" [ "$(echo "$output" | grep -c ' differs$')" = 1 ]
    done
    field=$((field + 1))
done
for word in 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14; do
    flip $vectors/random.hex 0 $word 31
    status 1 "the sign of word $word of record 0" "$HITPIPE" replay "$work/flipped.hex"
done
last=$(($(records $vectors/nan-and-infinity.hex) - 1))
flip $vectors/nan-and-infinity.hex $last 15 0
status 1 "the last record of a file" "$HITPIPE" replay "$work/flipped.hex"
says "is numbered" "record $last differs"
sed 's/numerics: flush/numerics: gradual/' $vectors/subnormals-flush.hex >"$work/gradual.hex"
status 1 "the other numerics give other bits" "$HITPIPE" replay "$work/gradual.hex"
flip $vectors/random.hex 3 17 0
status 1 "other files are replayed all the same" "$HITPIPE" replay "$work/flipped.hex" $vectors/grazing.hex
says "and counted" '^2 files, 1,100 records, 1 differ$'

# ---- for machines ----
flip $vectors/random.hex 7 17 3
status 1 "--json" "$HITPIPE" replay --json "$work/flipped.hex"
says "the count" '"differ": 1'
says "the record" '"record": 7'
says "the word" '"T"'
check "--report" "$HITPIPE" replay --report "$work/report.json" $vectors/*.hex
check "counts every test of every file" grep -q "\"run\": $all,\?$" "$work/report.json"

odd=$(printf '%s/f\303\050.hex' "$work")
LC_ALL=C sed "s|^// why: .*|$(printf '// why: \303\050')|" "$work/flipped.hex" >"$odd"
status 1 "a name and a remark that are not UTF-8" "$HITPIPE" replay --json "$odd"
says "the file is in the report" '"file": ".*f\?\(\.hex"'
says "the record too" '"record": 7'
check "--report -" "$HITPIPE" replay --report - $vectors/random.hex
check "nothing before it" test "$(printf '%s\n' "$output" | head -n 1)" = "{"

# ---- broken files ----
head -c 20000 $vectors/random.hex >"$work/short.hex"
lines=$(($(wc -l <"$work/short.hex") + 1))
status 3 "a file cut off within a record" "$HITPIPE" replay "$work/short.hex"
says "names file and line" "^hitpipe replay: $work/short.hex:$lines:[0-9]+: "
head -n 100 $vectors/random.hex >"$work/short.hex"
status 3 "a file cut off after a record" "$HITPIPE" replay "$work/short.hex"
says "names the missing" 'short.hex:101:1: the file ends after 89 of the 500 records'
sed '20s/^[0-9a-f]/x/' $vectors/random.hex >"$work/corrupt.hex"
status 3 "a word that is none" "$HITPIPE" replay "$work/corrupt.hex"
says "names its place" 'corrupt.hex:20:1: word 1 of the record is not eight hex digits'
: >"$work/empty.hex"
status 3 "an empty file" "$HITPIPE" replay "$work/empty.hex"
says "is named" 'empty.hex:1:1: not a file of golden vectors'
status 3 "a file that is not there" "$HITPIPE" replay "$work/absent.hex"
says "is named" 'absent.hex: No such file'
status 3 "a directory" "$HITPIPE" replay "$work"
status 3 "another kind of file" "$HITPIPE" replay Makefile

# ---- wrong use ----
status 2 "no file" "$HITPIPE" replay
status 2 "an unknown option" "$HITPIPE" replay --nonsense $vectors/random.hex
status 2 "one waveform for two files" "$HITPIPE" replay --engine clocked --vcd "$work/a.vcd" $vectors/r*.hex $vectors/g*.hex
check "--help" "$HITPIPE" replay --help
report

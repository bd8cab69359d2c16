#!/bin/sh
# Queries through the real usbcore and usbfs: every golden vector and a picture with the bits of the model, another program at the
# interface, Ctrl-C, and a board that is pulled in the midst of a picture, for good or to come back.
. testbench/kernel/guest/board.sh
scene="vectors/terrain/jacksboro.exr --resample 30x45 --size 48x30"
long="vectors/terrain/jacksboro.exr --resample 73x112 --size 320x180"
middle="vectors/terrain/jacksboro.exr --resample 30x45 --size 200x120"

# board_works NAME: the board answers as it should
board_works() { status 0 "$1: the board works" hitpipe replay --target usb:K-1 vectors/sphere-sphere/random.hex; }

# begin NAME COMMAND...: starts it in the background, and returns when it has used the board for a moment
begin() {
    begin_name=$1
    shift
    "$@" >"$work/begun.out" 2>&1 &
    begun=$!
    sleep 2
    check "$begin_name" kill -0 $begun
}

# ends NAME STATUS PATTERN: what was begun ends with this status and words
ends() {
    wait $begun
    check "$1: exit status" test "$?" = "$2"
    check "$1: $3" grep -qE "$3" "$work/begun.out"
}

echo '{"preset": "usb3", "name": "gradual", "subnormals": "gradual"}' >"$work/gradual.json"
# shellcheck disable=SC2046
for board in usb3 "$work/gradual.json"; do
    case $board in usb3) these=-v ;; *) these= ;; esac # each file once, on the board that it is for
    serve --serial K-1 --board "$board"
    check "attach $(basename "$board")" attach 1-1
    status 0 "golden vectors on $(basename "$board")" hitpipe replay --target usb $(ls vectors/*-*/*.hex | grep $these subnormals-gradual)
    says "no record differs" '^[0-9]+ files, [0-9,]+ records, 0 differ$'
    check "detach" detach
    end_serving
done

serve --serial K-1
check "attach" attach 1-1
# shellcheck disable=SC2086
status 0 "a picture on the model" hitpipe trace $scene --out "$work/model.exr"
# shellcheck disable=SC2086
status 0 "a picture over USB" hitpipe trace $scene --target usb --out "$work/usb.exr"
check "the same picture" cmp "$work/model.exr" "$work/usb.exr"

# shellcheck disable=SC2086
begin "a long picture begins" hitpipe trace $long --target usb --out "$work/long.exr"
status 4 "the interface is busy" hitpipe replay --target usb vectors/sphere-sphere/random.hex
says "it says so" 'busy|another program'
kill -INT $begun
ends "Ctrl-C" 4 'cancelled'
board_works "after Ctrl-C"

# shellcheck disable=SC2086
begin "a long picture begins again" hitpipe trace $long --target usb --out "$work/long.exr"
check "the board is pulled" detach
ends "a board that is pulled" 4 'board disconnected.*[0-9]+ of [0-9]+ primaries answered'
check "and put back" attach 1-1
board_works "after it was pulled"

# shellcheck disable=SC2086
begin "a picture that waits for its board begins" hitpipe trace $middle --target usb --reconnect 20 --out "$work/long.exr"
check "the board is pulled in its midst" detach
check "the picture waits" kill -0 $begun
check "the board is back" attach 1-1
wait $begun
check "the picture is finished" test $? = 0
# shellcheck disable=SC2086
status 0 "the same on the model" hitpipe trace $middle --out "$work/model.exr"
check "it lost nothing" cmp "$work/model.exr" "$work/long.exr"
board_works "in the end"
report_board

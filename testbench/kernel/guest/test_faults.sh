#!/bin/sh
# Each fault of a cable in the midst of a picture over USB (testbench/kernel/faulty.c): the picture is the model's all the same.
# All boards are used at the same time, since some of their programs wait for a timeout.
. testbench/kernel/guest/board.sh
awk -f testbench/support/triangles.awk >"$work/triangles.csv"

trace() { hitpipe trace "$work/triangles.csv" --size 64x36 "$@"; }

# begin BUSID SERIAL FAULT: attaches that board and uses it in the background; the exit status comes into $work/FAULT.status
begin() {
    check "attach the board of $3" attach "$1"
    {
        trace --target "usb:$2" --out "$work/$3.exr" >"$work/$3.out" 2>&1
        echo $? >"$work/$3.status"
    } &
    runs="$runs $!"
}

# struck FAULT: how often, as the server says
struck() { grep -c "^$1: packet " "$work/serve.err"; }

# ended STATUS FAULT: how its run ended; its words are in $output then
ended() { status "$1" "$2" sh -c "cat '$work/$2.out'; exit \$(cat '$work/$2.status')"; }

mended() {
    ended 0 "$1"
    check "$1: struck once" test "$(struck "$1")" = 1
    check "$1: the model's picture" cmp "$work/model.exr" "$work/$1.exr"
}

# refused FAULT WORDS: it ended in an error, with these words
refused() {
    check "$1: struck" test "$(struck "$1")" -ge 1
    ended 4 "$1"
    says "$1: words" "$2"
}

serve_with faulty
check "a board for each fault" test "$(wc -l <"$work/serve.out")" -gt 20
runs=
status 0 "the model's picture" trace --out "$work/model.exr"
while read -r busid serial fault; do begin "$busid" "$serial" "$fault"; done <"$work/serve.out"
# shellcheck disable=SC2086
wait $runs
while read -r _ _ fault; do
    case $fault in
    never_answers) refused "$fault" 'did not answer in time' ;;
    newer_protocol) refused "$fault" 'the board speaks version 2, this program version 1' ;;
    *) mended "$fault" ;;
    esac
done <"$work/serve.out"
check "detach" detach
kill "$served"
wait "$served"
check "the server ends" test $? = 0
served=
report_board

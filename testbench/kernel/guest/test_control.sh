#!/bin/sh
# The control plane by way of the kernel's HID driver: identity, health, reset, abort, clock, events; of several boards too.
. testbench/kernel/guest/board.sh

status 0 "info without a board" hitpipe info
says "none" '^No board is plugged in: looked for 1209:0001'
status 4 "watch without a board" hitpipe watch --seconds 1
status 4 "reset without a board" hitpipe reset

serve --serial C-1 --serial C-2
check "attach" attach 1-1
status 0 "info" hitpipe info
says "the target" '^target +usb:C-1, collision board$'
says "USB" '^usb +1209:0001 release 1\.00, bus 2, address [0-9]+, 5000 Mbit/s$'
says "HID" '^hid +/dev/hidraw0$'
says "identity" '^board +usb3, protocol 1, clock 100 MHz$'
says "pipes" '^pipes +ray-triangle, obb-obb, .*sphere-obb$'
says "features" '^control +reports of version 1: HEALTH, EVENTS, RESET, ABORT, CLOCK$'
says "health" 'no session, packets: 0, refused: 0 \(CRC: 0, order: 0\), resets: 0'
status 0 "info --json" hitpipe info --json
says "the serial number" '"serial": "C-1"'

status 0 "reset" hitpipe reset
says "which board" 'C-1'
status 0 "info after a reset" hitpipe info
says "is counted" 'resets: 1,'
status 0 "abort" hitpipe reset --abort
status 0 "another clock" hitpipe reset --clock 125000000
status 0 "a session, which begins with HELLO" hitpipe replay --target usb vectors/ray-triangle/det-zero.hex
status 0 "info after the clock" hitpipe info
says "the clock is another from then on" 'clock 125 MHz$'
status 4 "a clock out of range" hitpipe reset --clock 1

hitpipe watch --count 2 >"$work/events" 2>&1 &
watcher=$!
hitpipe watch --json --count 1 >"$work/json" 2>&1 &
second=$!
sleep 1
check "reset while two programs watch" hitpipe reset
check "and again" hitpipe reset
wait $watcher
check "watch ends after its count" test $? = 0
wait $second
check "so does the other" test $? = 0
status 0 "the events" cat "$work/events"
says "resets" 'RESET'
check "two lines" test "$(wc -l <"$work/events")" = 2
status 0 "for machines" cat "$work/json"
says "a reset" '"kind":"RESET"'

check "a second board" attach 1-2
status 4 "reset of which?" hitpipe reset
says "there are two" '2 boards are plugged in'
status 0 "reset of the second" hitpipe reset --target usb:C-2
says "the second" 'C-2'
status 4 "reset of one that is not there" hitpipe reset --target usb:C-3
says "names those that are" 'there is C-., C-.'

hitpipe watch --target usb:C-2 >"$work/events" 2>&1 &
watcher=$!
sleep 1
kill -INT $watcher
wait $watcher
check "watch ends with Ctrl-C" test $? = 0
hitpipe watch --target usb:C-2 >"$work/events" 2>&1 &
watcher=$!
sleep 1
detach
wait $watcher
check "watch ends with its board" test $? = 4
status 0 "its words" cat "$work/events"
says "unplugged" 'unplugged|disconnected'
report_board

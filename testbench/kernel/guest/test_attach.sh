#!/bin/sh
# `hitpipe serve` and the kernel: usbip finds the boards, a board is enumerated with the descriptors it should have, at both speeds,
# its drivers are bound, and it goes and comes again.
. testbench/kernel/guest/board.sh

status 1 "nobody serves" usbip list -r 127.0.0.1
status 1 "nothing to attach" usbip attach -r 127.0.0.1 -b 1-1

# value FILE: what a file of the board's in sysfs says
value() { cat "$(paths)/$1"; }

serve --serial K-1 --serial K-2
status 0 "usbip list" usbip list -r 127.0.0.1
says "the first board" '1-1: .*\(1209:0001\)'
says "the second" '1-2: .*\(1209:0001\)'
says "its interfaces" 'unknown protocol \(ff/48/00\)'
status 1 "a board that there is not" usbip attach -r 127.0.0.1 -b 1-3
check "attach" attach 1-1
check "one board" boards_are 1
for pair in idVendor=1209 idProduct=0001 bcdDevice=0100 speed=5000 bNumInterfaces=' 2' serial=K-1 manufacturer=hitpipe bConfigurationValue=1; do
    check "${pair%%=*}" test "$(value "${pair%%=*}")" = "${pair#*=}"
done
check "the HID has the kernel's driver" test "$(basename "$(readlink "$(paths):1.1/driver")")" = usbhid
check "the data interface has none" test ! -e "$(paths):1.0/driver"
status 0 "lsusb" lsusb -d 1209:0001
says "lsusb shows it" 'ID 1209:0001 hitpipe'
status 0 "lsusb -v" lsusb -v -d 1209:0001
says "packets" 'iInterface .*packets'
says "reports" 'iInterface .*reports'
says "SuperSpeed packets" 'wMaxPacketSize +0x0400'
check "endpoints" test "$(printf '%s\n' "$output" | grep -c 'bEndpointAddress.*EP [12] ')" = 3
status 1 "a board that is attached is nobody else's" usbip attach -r 127.0.0.1 -b 1-1
check "another one" attach 1-2
check "both are there" boards_are 2
status 0 "usbip port" usbip port
says "names them" '-> usbip://127\.0\.0\.1:3240/1-2'
check "detach" detach
for round in 1 2; do
    check "attach again, $round" attach 1-2
    check "the same board" test "$(value serial)" = K-2
    check "detach again, $round" detach
done
end_serving

serve --serial K-H --speed high
check "attach at high speed" attach 1-1
check "high speed" test "$(value speed)" = 480
status 0 "lsusb -v" lsusb -v -d 1209:0001
says "high speed packets" 'wMaxPacketSize +0x0200'
echo 0 >"$(paths)/authorized"
check "a board that is not authorised has no HID" until_true 5 sh -c "! ls /dev/hidraw0"
echo 1 >"$(paths)/authorized"
check "it comes back" boards 1
kill $served
wait $served
check "the server ends" test $? = 0
served=
check "the board goes with its server" boards 0
report_board

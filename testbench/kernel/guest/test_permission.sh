#!/bin/sh
# Who may use a board: without the udev rule root alone, and the message names the rule; with it group plugdev, by the node's
# group, and who sits at the machine, by an access list that udev's uaccess gives as logind says who that is.
. testbench/kernel/guest/board.sh
rules=/usr/local/lib/udev/rules.d # where `make install` puts it by default

# may USER, may_not USER: the program as that user sees the board on USB and on HID; or says why not, and what to do
may() {
    status 0 "$1: info" as "$1" hitpipe info
    says "$1: the board on USB" '^usb +1209:0001 .*Mbit/s$'
    says "$1: the board's identity" '^board +usb3, protocol 1'
    status 0 "$1: reset" as "$1" hitpipe reset
    status 0 "$1: replay" as "$1" hitpipe replay --target usb vectors/ray-triangle/det-zero.hex
}
may_not() {
    status 0 "$1: info" as "$1" hitpipe info
    says "$1: the board is seen, and why it cannot be opened" '^usb .*cannot be opened: no permission.*60-hitpipe\.rules'
    says "$1: the HID too" '^hid .*60-hitpipe\.rules'
    status 4 "$1: reset" as "$1" hitpipe reset
    says "$1: names the rule" '60-hitpipe\.rules'
    status 4 "$1: replay" as "$1" hitpipe replay --target usb vectors/ray-triangle/det-zero.hex
    says "$1: names the rule for packets" '60-hitpipe\.rules'
}

serve
check "attach" attach 1-1
may root
for user in stranger member seated; do may_not $user; done
detach

mkdir -p $rules /run/systemd/seats
cp mk/60-hitpipe.rules $rules
printf 'IS_SEAT0=1\nACTIVE=c1\nACTIVE_UID=%s\nUIDS=%s\n' "$(id -u seated)" "$(id -u seated)" >/run/systemd/seats/seat0
udevadm control --reload
check "attach with the rule" attach 1-1
# shellcheck disable=SC2046
check "modes and groups" test "$(stat -c '%A %U %G' $(nodes) | sort -u)" = "crw-rw---- root plugdev"
may member
may seated
may_not stranger
may root
detach

rm -f $rules/60-hitpipe.rules /run/systemd/seats/seat0
udevadm control --reload
check "attach without the rule again" attach 1-1
may_not member
report_board

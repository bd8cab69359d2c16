# testbench/kernel/guest/board.sh: counting checks (check.sh) with boards on the guest's USB. Source it, end with `report_board`.
#
#   serve OPTION...      starts `hitpipe serve`, and returns when it listens
#   serve_with COMMAND...   the same of another server
#   attach BUSID...      attaches boards, and returns when udev has made their nodes
#   detach               detaches all boards
#   boards N             waits until N boards are there, nodes and all
#   until_true SECONDS COMMAND...   waits until the command succeeds
#   as USER COMMAND...   runs a command as a user of image's list, with that user's groups
#   $work                a directory that anybody may write to
#
# What was started is ended with the script.
# shellcheck shell=sh
. testbench/support/check.sh
work=$(mktemp -d)
chmod 1777 "$work"
served=
devices=/sys/bus/usb/devices
trap 'detach; end_serving; rm -rf "$work"' EXIT
dmesg -c >/dev/null
modprobe vhci-hcd

until_true() {
    until_tries=$(($1 * 10))
    shift
    while ! "$@" >/dev/null 2>&1; do
        [ $((until_tries -= 1)) -gt 0 ] || return 1
        usleep 100000
    done
}

serve() { serve_with hitpipe serve "$@"; }

serve_with() {
    rm -f "$work/serve.out"
    "$@" >"$work/serve.out" 2>"$work/serve.err" &
    served=$!
    until_true 10 grep -q '^1-1' "$work/serve.out" || cat "$work/serve.out" "$work/serve.err"
}

end_serving() {
    [ -z "$served" ] || kill "$served" 2>/dev/null
    [ -z "$served" ] || wait "$served"
    served=
}

# paths: where in sysfs the boards are
paths() { grep -l '^1209$' $devices/*/idVendor 2>/dev/null | sed 's|/idVendor$||'; }

# nodes [KIND]: the device files of the boards, of usbfs and hidraw
nodes() {
    for nodes_path in $(paths); do
        [ "${1:-usb}" != usb ] || sed -n 's|^DEVNAME=|/dev/|p' "$nodes_path/uevent"
        [ "${1:-hidraw}" != hidraw ] || sed -n 's|^DEVNAME=|/dev/|p' "$nodes_path":1.1/*/hidraw/*/uevent 2>/dev/null
    done
}

# The guest has no other HID; a board's last node is that one. Asked often, so without another process.
boards_are() {
    set -- "$1" /dev/hidraw*
    [ -e "$2" ] || set -- "$1"
    [ $(($# - 1)) = "$1" ]
}
paths_are() { [ "$(paths | wc -l)" = "$1" ]; }
boards() { until_true 10 boards_are "$1" && until_true 10 paths_are "$1" && udevadm settle --timeout=10; }

attach() {
    attach_count=$(paths | wc -l)
    for attach_busid in "$@"; do usbip attach -r 127.0.0.1 -b "$attach_busid" || return 1; done
    boards $((attach_count + $#))
}

# What `usbip port` would say, at a quarter of the time: state 6 is a port in use.
ports() { sed -n 's/^[hs]s *0*\([0-9]\{1,\}\) 006 .*/\1/p' /sys/devices/platform/vhci_hcd.*/status*; }

detach() {
    for detach_port in $(ports); do usbip detach -p "$detach_port" >/dev/null 2>&1; done
    boards 0
}

as() {
    as_user=$1
    shift
    su -c 'exec "$@"' -- "$as_user" sh "$@"
}

# What the kernel itself says of a test: nothing that is a defect, of the kernel's or of a driver that was misused.
report_board() {
    detach || bad "boards that do not go away"
    dmesg >"$work/dmesg"
    check "the kernel has no complaint" sh -c "! grep -E 'BUG:|WARNING:|Oops|Call Trace|blocked for more|refcount|usbfs: .*did not claim' '$work/dmesg'"
    report
}

#!/bin/sh
# The guest itself: the modules go in, udev answers, a port of the virtual host controller is free.
. testbench/support/check.sh
check "modprobe" modprobe vhci-hcd
check "a virtual host controller" test -d /sys/devices/platform/vhci_hcd.0
check "settled" udevadm settle --timeout=10
check "its root hubs have nodes" test -c /dev/bus/usb/001/001 -a -c /dev/bus/usb/002/001
status 0 "lsusb" lsusb
says "shows them" 'Bus 002 Device 001: ID 1d6b:0003'
status 0 "usbip port" usbip port
report

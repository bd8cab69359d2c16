#!/bin/sh
# Every command that docs/usb.md shows runs as shown, in the order in which a reader would type them.
. testbench/kernel/guest/board.sh
project=$(pwd)
page=$project/docs/usb.md
for name in vectors examples mk; do ln -s "$project/$name" "$work/$name"; done
cd "$work" || exit 1

# labels: of all blocks of commands, as they stand on the page; block LABEL: the commands of these
labels() { sed -n 's/^ *```sh *//p' "$page"; }
block() { awk -v fence="\`\`\`sh $1" '{ sub(/^ +/, "") } $0 == fence { on = 1; next } /^```/ { on = 0 } on' "$page"; }

# try LABEL: runs its commands; a person would not type the next before the board is there
try() {
    block "$1" >"$work/commands"
    check "docs/usb.md has commands: $1" test -s "$work/commands"
    while IFS= read -r line; do
        check "docs/usb.md: $line" sh -c "$line"
        case $line in *"usbip attach"*) check "the board is there" boards 1 ;; esac
    done <"$work/commands"
}

# leave LABEL: starts its one command and leaves it running; $left is the process
leave() {
    check "docs/usb.md has one command: $1" test "$(block "$1" | wc -l)" = 1
    sh -c "exec $(block "$1")" >"$work/$1.out" 2>&1 &
    left=$!
}

check "blocks of commands are these" test "$(labels | sort -u | tr '\n' ' ')" = "attach bring-up detach rule serve several watch "
try rule
leave serve
served=$left
until_true 10 grep -q '^1-1' "$work/serve.out"
try attach
check "the rule holds" test "$(stat -c %G "$(nodes usb)")" = plugdev
leave watch
watcher=$left
try bring-up
try several
kill -INT $watcher
wait $watcher
status 0 "what watch saw" cat "$work/watch.out"
says "packets" 'PACKET_DONE'
says "the reset" 'RESET'
try detach
check "the board is gone" boards 0
check "the picture is one" test -s board.exr
rm /etc/udev/rules.d/60-hitpipe.rules
udevadm control --reload
report_board

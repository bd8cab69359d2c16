#!/bin/bash
# hitpipe serve: what it says, what a client gets over TCP (which bash speaks), and how it ends.
. testbench/support/check.sh
work=$(mktemp -d)
server=
trap '' PIPE
trap 'kill $server 2>/dev/null; rm -rf "$work"' EXIT
h=$HITPIPE

# start OPTION...: a server on a free port; sets $server and $port
start() {
    : >"$work/out" >"$work/log"
    "$h" serve --port 0 "$@" >"$work/out" 2>"$work/log" &
    server=$!
    for _ in $(seq 100); do
        port=$(sed -nE 's/^(serving on .*|  "port"): ?([0-9]+),?$/\2/p' "$work/out")
        [ -n "$port" ] && return
        sleep 0.05
    done
    bad "the server does not say where it listens: $(cat "$work/log")"
}

# ends STATUS NAME: the server ends by itself within five seconds, with this status
ends() {
    for _ in $(seq 100); do
        kill -0 $server 2>/dev/null || break
        sleep 0.05
    done
    kill -KILL $server 2>/dev/null && bad "$2: it does not end"
    wait $server
    check "$2: exit $1" test $? = "$1"
    server=
}

# logged NAME PATTERN: the log says so, soon
logged() {
    for _ in $(seq 100); do
        grep -qE -- "$2" "$work/log" && break
        sleep 0.05
    done
    check "$1: $2" grep -qE -- "$2" "$work/log"
}

# hexdump of the first N bytes that come on file descriptor FD
take() { timeout 5 head -c "$2" <&"$1" | od -An -v -tx1 | tr -d ' \n'; }
say() { printf '%b' "$2" >&"$1"; }
list='\x01\x11\x80\x05\0\0\0\0'
import() { # BUSID, three characters
    printf '%s' '\x01\x11\x80\x03\x00\x00\x00\x00' "$1"
    printf '\\x00%.0s' $(seq 29)
}

# ---- what it says ----
start
check "one board at SuperSpeed" grep -qx '1-1  HP-000001, SuperSpeed' "$work/out"
check "on loopback" grep -qE '^serving on 127\.0\.0\.1:[0-9]+$' "$work/out"
check "and nothing more" test "$(wc -l <"$work/out")" = 2

# ---- two clients ----
exec 3<>"/dev/tcp/127.0.0.1/$port"
say 3 "$list"
reply=$(take 3 332)
check "the list: one board" test "${reply:0:24}" = 011100050000000000000001
check "its bus id" test "${reply:536:8}" = 312d3100
check "its speed, vendor, product" test "${reply:616:16}" = 0000000512090001
say 3 "$(import 1-2)"
check "no board 1-2" test "$(take 3 8)" = 0111000300000004
say 3 "$(import 1-1)"
check "board 1-1 is there" test "$(take 3 8)" = 0111000300000000
take 3 312 >/dev/null
logged "attached" '^hitpipe serve: 127\.0\.0\.1:[0-9]+: attached to 1-1 \(HP-000001\)$'
exec 4<>"/dev/tcp/127.0.0.1/$port"
say 4 "$(import 1-1)"
check "it is taken" test "$(take 4 8)" = 0111000300000002
setup='\x80\x06\x00\x01\x00\x00\x12\x00' # the device descriptor
say 3 '\0\0\0\x01\0\0\0\x01\0\x01\0\x02\0\0\0\x01\0\0\0\0\0\0\0\0\0\0\0\x12\0\0\0\0\0\0\0\0\0\0\0\0'"$setup"
reply=$(take 3 66)
check "its device descriptor" test "${reply:96}" = 120120030000000909120100000101020301
say 4 'GET / HT'
logged "no USB/IP" 'ended: USB/IP version 4745, not 0111'
check "the connection is closed" test -z "$(take 4 1)"
exec 4<&-
exec 3<&-
logged "detached" 'detached from 1-1 \(HP-000001\): the client has closed the connection'

# ---- how it ends ----
kill -INT $server
ends 0 "SIGINT"
start --count 2 --speed high --json --usb-id 16d0:beef
check "JSON: address" grep -qE '^  "address": "127\.0\.0\.1:[0-9]+",$' "$work/out"
check "JSON: two boards" test "$(grep -c '"speed": "high"' "$work/out")" = 2
check "JSON: the second one" grep -qE '"serial": "HP-000002"' "$work/out"
exec 3<>"/dev/tcp/127.0.0.1/$port"
say 3 "$list"
reply=$(take 3 652)
check "two boards, high speed, other identifiers" test "${reply:16:8}${reply:616:16}" = 000000020000000316d0beef
exec 3<&-
kill -TERM $server
ends 0 "SIGTERM"
start --once --serial left --serial right
check "serials" grep -qx '1-2  right, SuperSpeed' "$work/out"
exec 3<>"/dev/tcp/127.0.0.1/$port"
say 3 "$(import 1-2)"
check "board 1-2 is there" test "$(take 3 8)" = 0111000300000000
exec 3<&-
ends 0 "--once"

# ---- what cannot be ----
start
status 4 "the port is taken" "$h" serve --port "$port"
says "the port is taken" "cannot listen on 127.0.0.1, port $port: Address already in use"
kill $server
ends 0 "the other one"
status 2 "no such address" "$h" serve --listen 300.1.1.1
says "no such address" 'no address 300.1.1.1'
status 2 "no such port" "$h" serve --port 65536
says "no such port" 'number from 0 to 65535'
status 2 "a long serial" "$h" serve --serial 1234567890123
says "a long serial" '1 to 12 ASCII characters'
status 2 "two of a serial" "$h" serve --serial a --serial a
says "two of a serial" 'two boards with serial number a'
status 2 "no board" "$h" serve --count 0
status 2 "many boards" "$h" serve --count 65
status 2 "count and serial" "$h" serve --count 2 --serial a
status 2 "an argument" "$h" serve usb3
status 2 "full speed" "$h" serve --speed full
says "full speed" 'high or super'
status 2 "a target" "$h" serve --target null
status 2 "a report" "$h" serve --report x.json
status 2 "a waveform" "$h" serve --engine clocked --vcd x.vcd
status 2 "an ISA that is none" "$h" serve --isa mmx
says "an ISA that is none" 'mmx is not to be had'
status 3 "a board that is none" "$h" serve --board nowhere
report

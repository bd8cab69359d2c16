# testbench/support/check.sh: counting checks for test scripts. Source it, call check / refuse, end with `report`.
#
#   check NAME COMMAND...          passes when the command succeeds
#   status N NAME COMMAND...       passes when the command exits with N; its output is in $output
#   says NAME PATTERN              passes when $output holds the extended regular expression
passed=0 failed=0
output=

good() { passed=$((passed + 1)); }
bad() {
    failed=$((failed + 1))
    echo "FAILED: $*"
}

check() {
    check_name=$1
    shift
    if output=$("$@" 2>&1); then good; else
        bad "$check_name: $*"
        echo "$output" | tail -n 20
    fi
}

status() {
    status_wanted=$1 status_name=$2
    shift 2
    output=$("$@" 2>&1)
    status_got=$?
    if [ "$status_got" = "$status_wanted" ]; then good; else
        bad "$status_name: exit $status_got, not $status_wanted: $*"
        echo "$output" | tail -n 20
    fi
}

says() {
    if printf '%s\n' "$output" | grep -qE -- "$2"; then good; else
        bad "$1: no '$2' in:"
        printf '%s\n' "$output" | tail -n 20
    fi
}

report() {
    echo "$passed passed, $failed failed"
    [ "$failed" = 0 ]
}

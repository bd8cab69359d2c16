#!/bin/sh
# Man pages are well formed, there is one for each verb, and options stand in --help and in the page, or in neither.
. testbench/support/check.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for page in docs/man/*.[1-9]; do
    check "lint $page" mandoc -T lint -W warning "$page"
    check "nothing said about $page" test -z "$output"
done

# options_of_page PAGE...: the long options that pages define
options_of_page() {
    grep -h '^\.It ' "$@" | grep -oE 'Fl -[a-z-]+' | sed 's/^Fl -//' | sort -u
}
options_of_help() {
    "$HITPIPE" "$1" --help | grep -oE '^ {2,6}(-., )? *--[a-z-]+' | grep -oE -- '--[a-z-]+' | sed 's/^--//' | sort -u
}

options_of_page docs/man/hitpipe.1 >"$work/common"
check "the common options are found" grep -qx board "$work/common"
for verb in $(sed -nE 's/^HP_VERB\(([a-z_]+),.*/\1/p' host/cli/verbs.def); do
    check "a page for $verb" test -s "docs/man/hitpipe-$verb.1"
    options_of_help "$verb" >"$work/help"
    options_of_page "docs/man/hitpipe-$verb.1" >"$work/own"
    cp "$work/own" "$work/page"
    if grep -q 'options of every verb' "docs/man/hitpipe-$verb.1"; then sort -u "$work/own" "$work/common" >"$work/page"; fi
    check "$verb: --help and the page have the same options" diff "$work/help" "$work/page"
    check "hitpipe.1 names $verb" grep -q "^\.It Cm $verb" docs/man/hitpipe.1
    check "hitpipe --help names $verb" sh -c "'$HITPIPE' --help | grep -q '^  $verb '"
done
report

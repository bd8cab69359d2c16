#!/bin/sh
# accuracy_page.sh ACCURACY COUNT: puts the tables that the program prints between the marks of docs/accuracy.md.
set -eu
page=docs/accuracy.md
tables=$(mktemp)
trap 'rm -f "$tables" "$tables.page"' EXIT
"$1" --count "$2" >"$tables" || [ $? = 1 ] # 1: a row is above its bound, which the table says
awk -v tables="$tables" '
    /^<!-- end of tables -->$/ { skip = 0 }
    !skip
    /^<!-- tables -->$/ { skip = 1; while ((getline line < tables) > 0) print line }
' "$page" >"$tables.page"
cat "$tables.page" >"$page"

#!/bin/sh
# Public headers: each compiles alone, as C17 and as C++17; what they show and examples/ show compiles, runs and is right.
# Run from the project's root with $BUILD.
. testbench/support/check.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
CC=${CC:-cc}
INC="-Irtl_model/include -Idriver/include"
LIBS="$BUILD/libhitpipe.a $(pkg-config --libs libusb-1.0 "hidapi-${HIDAPI:-hidraw}") -lm -pthread ${SANITIZE:+-fsanitize=$SANITIZE}"
CXX=$(command -v "${CXX:-c++}" || command -v g++ || command -v clang++)

for header in rtl_model/include/hitpipe/*.h driver/include/hitpipe/*.h; do
    name=hitpipe/$(basename "$header")
    printf '#include <%s>\n#include <%s>\nint main(void) { return 0; }\n' "$name" "$name" >"$work/alone.c"
    check "$name alone in C" $CC -std=c17 -Wall -Wextra -Wpedantic -Werror $INC -fsyntax-only "$work/alone.c"
    [ -z "$CXX" ] && continue
    check "$name alone in C++" "$CXX" -x c++ -std=c++17 -Wall -Wextra -Werror $INC -fsyntax-only "$work/alone.c"
done
[ -n "$CXX" ] || echo "no C++ compiler: C++17 not tried"

# shown HEADER: the lines of the header's opening comment that are code: indented by five blanks.
shown() { sed -n '1,/\*\//s/^ \*     //p' "driver/include/hitpipe/$1"; }
cat >"$work/shown.c" <<EOF
#include <hitpipe/hitpipe.h>
#include <stdio.h>
int main(void) {
    static const float triangles[] = {-1, -1, 2, 1, -1, 2, 0, 1, 2}, rays[] = {0, 0, 0, 0, 0, 1};
    enum { count = 1, n = 1 };
    hp_result results[n];
    $(shown hitpipe.h)
    if (status != HP_OK) return 1;
    printf("%u %u %g\n", results[0].F, results[0].index, (double)results[0].T);
    return 0;
}
EOF
check "the code in hitpipe.h is there" grep -q hp_query "$work/shown.c"
check "the code in hitpipe.h compiles" $CC -std=c17 -Wall -Wextra -Werror $INC "$work/shown.c" $LIBS -o "$work/shown"
status 0 "the code in hitpipe.h runs" "$work/shown"
says "the code in hitpipe.h is right" '^1 0 2$'

cat >"$work/control.c" <<EOF
#include <hitpipe/control.h>
#include <stdio.h>
int main(void) {
    $(shown control.h)
    printf("%d %s\n", status, hp_control_message(NULL));
    return 0;
}
EOF
check "the code in control.h is there" grep -q hp_control_read_health "$work/control.c"
check "the code in control.h compiles" $CC -std=c17 -Wall -Wextra -Werror $INC "$work/control.c" $LIBS -o "$work/control"
status 0 "the code in control.h runs" "$work/control"

check "examples/closest.c compiles" $CC -std=c17 -Wall -Wextra -Werror $INC examples/closest.c $LIBS -o "$work/closest"
status 0 "examples/closest.c runs" "$work/closest"
says "ray 0" '^ray 0 meets triangle 0 at t = 2: \(0, 0, 2\)$'
says "ray 1" '^ray 1 meets triangle 1 at t = 0\.5: \(0, 0, 4\)$'
says "ray 2" '^ray 2 meets triangle 2 at t = 3: \(3, 0, 3\)$'
says "ray 3" '^ray 3 meets nothing$'
report

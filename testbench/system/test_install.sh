#!/bin/sh
# `make install` puts a usable tree in place: a user's C program compiles against it, static and shared, and man pages show.
. testbench/support/check.sh
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
: "${CC:=cc}"

check "install" make install BUILD="$BUILD" DESTDIR="$root" PREFIX=/opt/hitpipe ${SANITIZE:+SANITIZE=$SANITIZE}
top=$root/opt/hitpipe
export PKG_CONFIG_PATH=$top/lib/pkgconfig PKG_CONFIG_SYSROOT_DIR=$root
flags=$(pkg-config --cflags hitpipe)
[ -z "${SANITIZE:-}" ] || flags="$flags -fsanitize=$SANITIZE"

private=$(pkg-config --static --libs-only-l --libs-only-other hitpipe | sed 's/-lhitpipe //')

for file in bin/hitpipe lib/libhitpipe.a lib/libhitpipe.so.0 include/hitpipe/hitpipe.h include/hitpipe/control.h \
    include/hitpipe/usb.h include/hitpipe/status.def \
    share/man/man1/hitpipe.1 share/man/man1/hitpipe-trace.1 share/man/man3/libhitpipe.3; do
    check "installed: $file" test -s "$top/$file"
done
check "the udev rule is installed" cmp mk/60-hitpipe.rules "$top/lib/udev/rules.d/60-hitpipe.rules"
check "the simulated board stays inside" test ! -e "$top/include/hitpipe/board.h"

# shellcheck disable=SC2086
check "compile against the shared library" $CC -std=c17 -Wall -Wextra -Werror examples/closest.c $flags \
    $(pkg-config --libs hitpipe) -o "$root/shared"
check "run it" env LD_LIBRARY_PATH="$top/lib" "$root/shared"
shared=$output
# shellcheck disable=SC2086
check "compile against the archive" $CC -std=c17 -Wall -Wextra -Werror examples/closest.c $flags \
    "$top/lib/libhitpipe.a" $private -o "$root/static"
check "run it" "$root/static"
check "both say the same" test "$shared" = "$output"
printf '#include <hitpipe/control.h>\nint main(void) { hp_control_close(0); return hp_control_open(0, 0) == HP_OK; }\n' \
    >"$root/control.c"
# shellcheck disable=SC2086
check "the control plane in the archive" $CC -std=c17 "$root/control.c" $flags "$top/lib/libhitpipe.a" $private \
    -o "$root/control"
check "run it" "$root/control"
status 0 "the installed program runs" "$top/bin/hitpipe" --version
says "the version" '[0-9]+\.[0-9]+\.[0-9]+'
check "man page" mandoc -T utf8 "$top/share/man/man1/hitpipe.1"
says "the man page is about hitpipe" 'hitpipe'
check "uninstall" make uninstall DESTDIR="$root" PREFIX=/opt/hitpipe
check "nothing is left" sh -c "! find '$top' -type f | grep ."
report

#!/bin/sh
# The rooms: who may include whom, what the tree may not hold. Run from the project's root.
. testbench/support/check.sh

# no_match NAME PATTERN FILE...: passes when no line of the files matches
no_match() {
    room_name=$1 pattern=$2
    shift 2
    found=$(git ls-files -- "$@" | xargs -r grep -nE -- "$pattern")
    if [ -z "$found" ]; then good; else
        bad "$room_name"
        echo "$found"
    fi
}

no_match "the model knows no driver and no host" '#include [<"](driver|host)/|hitpipe/hitpipe\.h|transport\.h' rtl_model
no_match "the model knows no files and no other library" '#include <(stdio|jansson|png|openexr|argp|assimp|libusb)|\bfopen\(' \
    ':(glob)rtl_model/**/*.h' ':(glob)rtl_model/[!bc]*/*.c'
no_match "the driver knows no host and no command line" '#include [<"](host)/|#include <(argp|jansson|png|openexr|assimp)' driver
no_match "only the model transport and the USB device side see the board" 'hitpipe/board\.h' ':(glob)driver/*.c' ':(glob)driver/*.h' \
    driver/hid host
no_match "the USB device side knows no driver" '#include [<"](driver/(transport|hid|[a-z_]+\.h)|hitpipe/hitpipe\.h|libusb|hidapi)' \
    driver/gadget driver/usbip
no_match "the gadget knows no cable" '#include [<"](sys/socket|netinet|arpa|netdb|poll|unistd|fcntl|linux)' driver/gadget
no_match "the library never prints" '\b(printf|puts|perror|fprintf)\(' ':(glob)rtl_model/**' ':(glob)driver/**'
no_match "no path of a machine, no host name" '(^|[^a-z.])/(work|home|root|Users)/|https?://[a-z.]*(debian|registry)' .
report

# Programs with a USB bus of their own: they have open, ioctl and libudev's functions from testbench/usb/ instead of the system's.
USB_OBJ      := $(patsubst %.c,$(BUILD)/%.o,$(filter-out testbench/usb/test_%.c,$(wildcard testbench/usb/*.c)))
USB_PROGRAMS := $(filter $(BUILD)/testbench/usb/test_% $(BUILD)/testbench/bench/bench_usb,$(TESTS) $(BENCHES))

$(USB_PROGRAMS): $(USB_OBJ)
$(USB_PROGRAMS): OWN_OBJ := $(USB_OBJ)

# Of hidapi's back ends the bus has what the libusb one asks for.
$(BUILD)/testbench/usb/test_usb_hid: PKGS_LIB := libusb-1.0 hidapi-libusb

# This one counts what the driver allocates: its own calls, not libusb's.
$(BUILD)/testbench/usb/test_usb_memory: OWN_OBJ := $(USB_OBJ) $(foreach f,malloc calloc realloc aligned_alloc,-Wl,--wrap=$(f))

# Programs with a USB bus of their own: they have open, ioctl and libudev's functions from testbench/usb/ instead of the system's.
USB_OBJ      := $(patsubst %.c,$(BUILD)/%.o,$(filter-out testbench/usb/test_%.c,$(wildcard testbench/usb/*.c)))
USB_PROGRAMS := $(filter $(BUILD)/testbench/usb/test_% $(BUILD)/testbench/bench/bench_usb,$(TESTS) $(BENCHES))

$(USB_PROGRAMS): $(USB_OBJ)
$(USB_PROGRAMS): OWN_OBJ := $(USB_OBJ)

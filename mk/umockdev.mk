# Programs on a machine of umockdev's: they bring libumockdev, and the bus of testbench/usb/ without its own system calls.
PACKAGES_CHECK   += umockdev libumockdev-dev
UMOCKDEV_OBJ     := $(patsubst %.c,$(BUILD)/%.o,$(filter-out testbench/umockdev/test_%.c,$(wildcard testbench/umockdev/*.c))) \
                    $(addprefix $(BUILD)/testbench/usb/,usbfs.o sockets.o cable.o)
UMOCKDEV_TESTS   := $(filter $(BUILD)/testbench/umockdev/test_%,$(TESTS))
UMOCKDEV_CFLAGS   = $(shell pkg-config --cflags umockdev-1.0 2>/dev/null)
# the program with hidapi's other back end
OTHER_hidraw     := libusb
OTHER_libusb     := hidraw
HITPIPE_OTHER    := $(BUILD)/hitpipe-$(OTHER_$(HIDAPI))

$(UMOCKDEV_TESTS): $(UMOCKDEV_OBJ) $(HITPIPE) $(HITPIPE_OTHER)
$(UMOCKDEV_TESTS): OWN_OBJ := $(UMOCKDEV_OBJ)
$(UMOCKDEV_TESTS): OWN_LIBS = $(shell pkg-config --libs umockdev-1.0)

$(BUILD)/testbench/umockdev/%.o: testbench/umockdev/%.c
	$(call say,CC)mkdir -p $(@D)
	$(run)$(CC) $(ALL_CFLAGS) $(LIB_CFLAGS) $(UMOCKDEV_CFLAGS) -c $< -o $@

$(HITPIPE_OTHER): $(HOST_OBJ) $(LIB) $(HIDAPI_CHOICE)
	$(call say,LD)
	$(run)$(CC) $(LDSAN) $(HOST_OBJ) $(LIB) -o $@ $(LIBS_HOST) $(subst hidapi-$(HIDAPI),hidapi-$(OTHER_$(HIDAPI)),$(LIBS_LIB))

# The tests that show hidapi in the library, with its libusb back end: of the program, test_umockdev has both anyway.
test-hidapi-libusb: ## run the tests of the control plane with hidapi's libusb back end
	@$(MAKE) HIDAPI=libusb $(HITPIPE) $(BUILD)/testbench/unit/test_hid $(UMOCKDEV_TESTS)
	@BUILD=$(BUILD) HIDAPI=libusb ONLY=library testbench/run $(JOBS) $(BUILD)/testbench/unit/test_hid $(UMOCKDEV_TESTS) testbench/unit/test_headers.sh

.PHONY: test-hidapi-libusb

# Level 4 of docs/testing.md: the board over USB under a real kernel, in a PC emulated by QEMU. Debian on x86-64 alone.
PACKAGES_KERNEL := qemu-system-x86 busybox-static kmod cpio udev usbip usbutils xz-utils
# The kernel is fetched and unpacked once; `make clean` forgets it.
KERNEL_DIR ?= build/kernel

check-kernel: ## install what it needs, test the board over USB under a Debian kernel in an emulated PC
	@mk/deps.sh $(PACKAGES_BUILD) $(PACKAGES_KERNEL)
	@$(MAKE) $(HITPIPE) $(FAULTY)
	@KERNEL_DIR=$(KERNEL_DIR) HITPIPE=$(HITPIPE) FAULTY=$(FAULTY) testbench/kernel/run $(TESTS_KERNEL)

# The server whose boards are at cables with faults: the product's own, but for what its client calls the gadget by.
FAULTY     := $(BUILD)/testbench/kernel/faulty
FAULTY_OBJ := $(addprefix $(BUILD)/testbench/,kernel/faulty.o kernel/cabled.o kernel/client.o usb/cable.o)

$(BUILD)/testbench/kernel/client.o: driver/usbip/client.c
	$(call say,CC)mkdir -p $(@D)
	$(run)$(CC) $(ALL_CFLAGS) $(foreach f,submit unlink run reset,-Dhp_gadget_$f=hpt_cabled_$f) -c $< -o $@

$(FAULTY): $(FAULTY_OBJ) $(LIB)
	$(call say,LD)
	$(run)$(CC) $(LDSAN) $^ -o $@ -lm -pthread

# test_faulty.sh asks it.
tests: $(FAULTY)

.PHONY: check-kernel

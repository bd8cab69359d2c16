# Level 4 of docs/testing.md: the board over USB under a real kernel, in a PC emulated by QEMU. Debian on x86-64 alone.
PACKAGES_KERNEL := qemu-system-x86 busybox-static kmod cpio udev usbip usbutils xz-utils
# The kernel is fetched and unpacked once; `make clean` forgets it.
KERNEL_DIR ?= build/kernel

check-kernel: ## install what it needs, test the board over USB under a Debian kernel in an emulated PC
	@mk/deps.sh $(PACKAGES_BUILD) $(PACKAGES_KERNEL)
	@$(MAKE) $(HITPIPE)
	@KERNEL_DIR=$(KERNEL_DIR) HITPIPE=$(HITPIPE) testbench/kernel/run $(TESTS_KERNEL)

.PHONY: check-kernel

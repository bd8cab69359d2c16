# Bits: vectors/hashes.txt met by every instruction set, at -O0 and -O3, of gcc, clang and an emulated aarch64.
# Each build prints "passed" or "failed" lines for testbench/tools/hashes.sh to add up.
HASH_PIPES := $(BUILD)/hash_pipes

$(HASH_PIPES): $(BUILD)/testbench/tools/hash_pipes.o $(BUILD)/testbench/support/hash.o $(BUILD)/testbench/support/plain_objects.o $(LIB)
	$(call say,LD)
	$(run)$(CC) $(LDSAN) $^ -o $@ -lm -pthread

hash_pipes: $(HASH_PIPES)

hashes: ## hold the committed hashes on all instruction sets, -O0 and -O3, gcc, clang and aarch64 under qemu
	@testbench/tools/hashes.sh "gcc -O0" "gcc -O3" "clang -O0" "clang -O3" "aarch64-linux-gnu-gcc -O2"

.PHONY: hashes hash_pipes

# Bits: vectors/hashes.txt met by every instruction set, at -O0 and -O3, of gcc, clang and an emulated aarch64.
# Each build prints "passed" or "failed" lines for testbench/tools/hashes.sh to add up.
HASH_PIPES := $(BUILD)/hash_pipes

$(HASH_PIPES): $(BUILD)/testbench/tools/hash_pipes.o $(BUILD)/testbench/support/hash.o $(BUILD)/testbench/support/plain_objects.o $(LIB)
	$(call say,LD)
	$(run)$(CC) $(LDSAN) $^ -o $@ -lm -pthread

hash_pipes: $(HASH_PIPES)

hashes: ## hold the committed hashes on all instruction sets, with and without optimisation, gcc, clang and aarch64 under qemu
	@JOBS=$(JOBS) testbench/tools/hashes.sh "gcc -O3" "gcc -O0" "clang -O2" "clang -O0" "aarch64-linux-gnu-gcc -O2"

.PHONY: hashes hash_pipes

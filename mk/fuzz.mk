# Fuzzers: testbench/fuzz/fuzz_NAME.c over the files kept in testbench/fuzz/corpus/NAME.
#
# Built as part of the tests with a plain main, which runs the corpora (testbench/fuzz/test_corpora.sh). `make fuzz` links
# them with clang's libFuzzer, in the sanitized build of `make test-clang-asan`, runs the corpora, and then FUZZ_SECONDS of new
# inputs each; what is new and worth keeping, and what crashed, is left in build/fuzz/found/NAME.
FUZZ_SECONDS ?= 0
FUZZ_MAIN    := $(BUILD)/testbench/fuzz/standalone.o
FUZZERS      := $(FUZZ_SRC:%.c=$(BUILD)/%)
LIBFUZZERS   := $(FUZZ_SRC:%.c=$(BUILD)/%.libfuzzer)

$(FUZZERS): $(BUILD)/%: $(BUILD)/%.o $(FUZZ_MAIN) $(SUPPORT_OBJ) $(HOST_LIB_OBJ) $(LIB)
	$(call say,LD)
	$(run)$(CC) $(LDSAN) $< $(FUZZ_MAIN) $(SUPPORT_OBJ) $(HOST_LIB_OBJ) $(LIB) -o $@ $(LIBS_TEST) $(LIBS_HOST) $(LIBS_LIB)

$(LIBFUZZERS): $(BUILD)/%.libfuzzer: $(BUILD)/%.o $(SUPPORT_OBJ) $(HOST_LIB_OBJ) $(LIB)
	$(call say,LD)
	$(run)$(CC) $(LDSAN) -fsanitize=fuzzer $< $(SUPPORT_OBJ) $(HOST_LIB_OBJ) $(LIB) -o $@ $(LIBS_TEST) $(LIBS_HOST) $(LIBS_LIB)

libfuzzers: $(LIBFUZZERS)

tests: $(FUZZERS)

fuzz: ## run the fuzzers over their corpora, and for FUZZ_SECONDS=N seconds each (needs clang)
	@$(MAKE) $(CLANG_ASAN) libfuzzers
	@FUZZERS=build/clang-asan/testbench/fuzz FUZZ_SECONDS=$(FUZZ_SECONDS) testbench/fuzz/run

.PHONY: libfuzzers

# Fuzzers: testbench/fuzz/fuzz_NAME.c over the files kept in testbench/fuzz/corpus/NAME.
#
# Built as part of the tests with a plain main, which runs the corpora (testbench/fuzz/test_corpora.sh). `make fuzz` builds
# them again with clang's libFuzzer and sanitizers, runs the corpora, and then FUZZ_SECONDS of new inputs each; what is new and
# worth keeping, and what crashed, is left in $(BUILD)/fuzz/found/NAME.
FUZZ_SECONDS ?= 0
FUZZ_MAIN    ?= $(BUILD)/testbench/fuzz/standalone.o
FUZZ_LINK    ?=
FUZZERS      := $(FUZZ_SRC:%.c=$(BUILD)/%)

.PHONY: fuzzers

$(FUZZERS): $(BUILD)/%: $(BUILD)/%.o $(FUZZ_MAIN) $(SUPPORT_OBJ) $(HOST_LIB_OBJ) $(LIB)
	$(call say,LD)
	$(run)$(CC) $(LDSAN) $(FUZZ_LINK) $< $(FUZZ_MAIN) $(SUPPORT_OBJ) $(HOST_LIB_OBJ) $(LIB) -o $@ $(LIBS_TEST) $(LIBS_HOST) $(LIBS_LIB)

fuzzers: $(FUZZERS)

tests: $(FUZZERS)

fuzz: ## run the fuzzers over their corpora, and for FUZZ_SECONDS=N seconds each (needs clang)
	@$(MAKE) BUILD=$(BUILD)/fuzz CC=clang OPT=-O1 SANITIZE=address,undefined CFLAGS=-fsanitize=fuzzer-no-link \
	    FUZZ_LINK=-fsanitize=fuzzer FUZZ_MAIN= fuzzers
	@BUILD=$(BUILD) FUZZ_SECONDS=$(FUZZ_SECONDS) testbench/fuzz/run

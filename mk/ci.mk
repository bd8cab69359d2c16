# What .ci/run needs beyond `make check`.
deps-ci: ## install the packages of the continuous integration
	@mk/deps.sh $(PACKAGES_BUILD) $(PACKAGES_CHECK) $(PACKAGES_CI) $(PACKAGES_PEERS) $(PACKAGES_KERNEL)

FORMATTED = $(shell git ls-files '*.c' '*.h' '*.cc' '*.hh')

format: ## lay out all C and C++ files by .clang-format
	clang-format -i $(FORMATTED)

format-check: ## fail if one is not laid out by .clang-format
	@clang-format --dry-run --Werror $(FORMATTED) && echo "$(words $(FORMATTED)) files well laid out"

# The same tests under sanitizers. That of clang is also what the fuzzers are made of.
CLANG_ASAN := BUILD=build/clang-asan CC=clang OPT=-O1 SANITIZE=address,undefined CFLAGS=-fsanitize=fuzzer-no-link
test-clang-asan: ## run the tests under clang's AddressSanitizer and UndefinedBehaviorSanitizer
	@$(MAKE) $(CLANG_ASAN) test TEST_SH="$(filter-out %/test_experiment.sh,$(TEST_SH))" # half a minute, of gcc's too

test-asan: ## the same of gcc
	@$(MAKE) BUILD=build/asan OPT=-O1 SANITIZE=address,undefined test

# The programs that start threads, under ThreadSanitizer.
TEST_THREADS ?= test_api test_driver test_board test_usbip
test-threads: ## run the tests that use threads under ThreadSanitizer
	@$(MAKE) BUILD=build/tsan CC=clang OPT=-O1 SANITIZE=thread $(TEST_THREADS:%=build/tsan/testbench/unit/%)
	@BUILD=build/tsan testbench/run $(JOBS) $(TEST_THREADS:%=build/tsan/testbench/unit/%)

.PHONY: format-check test-threads test-asan test-clang-asan

# hitpipe: make demo, make check, make install. `make help` lists the rest.

VERSION := 0.1.0
PREFIX  ?= /usr/local
DESTDIR ?=
CC      ?= cc
BUILD   ?= build
OPT     ?= -O3
SANITIZE ?=
# hidapi's back end: hidraw, or libusb, which works without the kernel's HID driver
HIDAPI  ?= hidraw
JOBS    ?= $(shell nproc 2>/dev/null || echo 2)
ifeq ($(MAKELEVEL),0)
MAKEFLAGS += -j$(JOBS)
endif
MAKEFLAGS += -r --no-print-directory
# V=1 shows whole commands
say = @$(if $(V),,echo "  $(1)  $@";)
run = $(if $(V),,@)

# ---- packages: one list, installed by `make deps` when something is missing ----------------------------------------
PACKAGES_BUILD := gcc libc6-dev pkg-config libjansson-dev libopenexr-dev libassimp-dev libpng-dev libusb-1.0-0-dev libhidapi-dev
PACKAGES_CHECK := libcmocka-dev libgmp-dev mandoc g++
PACKAGES_CI    := clang libclang-rt-14-dev clang-format gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user

# ---- sources: every room's files, no list by hand --------------------------------------------------------------------
ARCH    := $(or $(shell $(CC) -dumpmachine 2>/dev/null | cut -d- -f1),$(shell uname -m))
LIB_SRC := $(filter-out rtl_model/pipes/wide.c,$(wildcard rtl_model/*/*.c)) $(wildcard driver/*.c driver/*/*.c)
HOST_SRC := $(wildcard host/*/*.c)
SUPPORT_SRC := $(wildcard testbench/support/*.c testbench/reference/*.c)
TEST_SRC := $(wildcard testbench/unit/test_*.c testbench/equal/test_*.c testbench/system/test_*.c testbench/usb/test_*.c \
                       testbench/umockdev/test_*.c)
TEST_SH  := $(wildcard testbench/*/test_*.sh)
FUZZ_SRC := $(wildcard testbench/fuzz/fuzz_*.c)
BENCH_SRC := $(wildcard testbench/bench/bench_*.c)
TOOL_SRC := $(wildcard testbench/tools/*.c)

# wide.c once per pipe and instruction set; the flags of each
PIPES := $(filter-out every,$(notdir $(patsubst %.pipe.h,%,$(wildcard rtl_model/pipes/*.pipe.h))))
ifeq ($(ARCH),x86_64)
ISAS := plain sse2 avx2 avx512
else ifeq ($(ARCH),aarch64)
ISAS := plain neon
else
ISAS := plain
endif
ISA_FLAGS_plain  :=
ISA_FLAGS_sse2   := -msse2
ISA_FLAGS_avx2   := -mavx2
ISA_FLAGS_avx512 := -mavx512f -mavx512dq -mavx512vl -mavx512bw -mprefer-vector-width=512
ISA_FLAGS_neon   :=

# ---- flags: the same bits everywhere, so no contraction and no fast-math -------------------------------------------------
WARN   := -Wall -Wextra -Werror -Wshadow -Wvla -Wstrict-prototypes -Wmissing-prototypes
# gcc 12 at -O3 can lose the rounding of a double to a float in its straight-line vectoriser, hence the third flag.
BASE   := -std=c17 -D_GNU_SOURCE -ffp-contract=off -fno-fast-math -fno-tree-slp-vectorize $(WARN) -fPIC -pthread -g -MMD -MP
ifneq ($(SANITIZE),)
BASE   += -fsanitize=$(SANITIZE) -fno-sanitize-recover=all -fno-omit-frame-pointer
LDSAN  := -fsanitize=$(SANITIZE)
endif
INC    := -Irtl_model/include -Idriver/include -I.
CFLAGS ?=
ALL_CFLAGS = $(OPT) $(BASE) $(INC) -DHITPIPE_BUILD_VERSION='"$(VERSION)"' $(CFLAGS)
PKGS_LIB  := libusb-1.0 hidapi-$(HIDAPI)
LIB_CFLAGS = $(shell pkg-config --cflags $(PKGS_LIB) 2>/dev/null)
HOST_CFLAGS = $(shell pkg-config --cflags OpenEXR jansson libpng assimp 2>/dev/null)
LIBS_LIB   = $(shell pkg-config --libs $(PKGS_LIB) 2>/dev/null || echo -lusb-1.0 -lhidapi-$(HIDAPI)) -lm -pthread
LIBS_HOST = -lOpenEXRCore $(shell pkg-config --libs jansson libpng assimp 2>/dev/null || echo -ljansson -lpng -lassimp)
LIBS_TEST := -lcmocka -lgmp

LIB_OBJ  := $(LIB_SRC:%.c=$(BUILD)/%.o) $(foreach i,$(ISAS),$(PIPES:%=$(BUILD)/rtl_model/pipes/wide_$i/%.o))
HOST_OBJ := $(HOST_SRC:%.c=$(BUILD)/%.o)
HOST_LIB_OBJ := $(filter-out $(BUILD)/host/cli/main.o,$(HOST_OBJ))
SUPPORT_OBJ := $(SUPPORT_SRC:%.c=$(BUILD)/%.o)
TESTS    := $(TEST_SRC:%.c=$(BUILD)/%)
BENCHES  := $(BENCH_SRC:%.c=$(BUILD)/%)
TOOLS    := $(TOOL_SRC:%.c=$(BUILD)/%)
HITPIPE  := $(BUILD)/hitpipe
LIB      := $(BUILD)/libhitpipe.a
SHLIB    := $(BUILD)/libhitpipe.so.0

.PHONY: all help deps deps-check deps-ci demo check test tests install bench fuzz vectors format format-check clean
.DEFAULT_GOAL := all

all: $(HITPIPE) $(SHLIB) ## build program and library

help: ## list these targets
	@grep -hE '^[a-z-]+:.*## ' Makefile mk/*.mk | sed -E 's/^([a-z-]+):.*## /\1\t/' | expand -t 16

# Where speed does not matter the vocabulary is called, not melted into each pipe: a fraction of the compiling time.
CALLED := $(if $(or $(SANITIZE),$(filter -O0,$(OPT))),-DHP_CALLED)

define WIDE
$(BUILD)/rtl_model/pipes/wide_$1/%.o: rtl_model/pipes/wide.c
	$$(call say,CC)mkdir -p $$(@D)
	$$(run)$$(CC) $$(ALL_CFLAGS) $$(ISA_FLAGS_$1) $$(CALLED) -DHP_WIDE_ISA_$1=1 -DHP_WIDE_ISA=$1 -DHP_PIPE=$$* \
	    -DHP_PIPE_FILE='"rtl_model/pipes/$$*.pipe.h"' -c $$< -o $$@
endef
$(foreach i,$(ISAS),$(eval $(call WIDE,$i)))

$(BUILD)/host/%.o: host/%.c
	$(call say,CC)mkdir -p $(@D)
	$(run)$(CC) $(ALL_CFLAGS) $(HOST_CFLAGS) -c $< -o $@

$(BUILD)/%.o: %.c
	$(call say,CC)mkdir -p $(@D)
	$(run)$(CC) $(ALL_CFLAGS) $(LIB_CFLAGS) '-DHP_WIDE_ISAS(X,n,N)=$(foreach i,$(ISAS),X($(i),n,N))' -c $< -o $@

$(LIB): $(LIB_OBJ)
	$(call say,AR)rm -f $@
	$(run)ar rcs $@ $^

# What was linked with the other back end of hidapi is linked again.
HIDAPI_CHOICE := $(BUILD)/hidapi
$(HIDAPI_CHOICE): FORCE
	@mkdir -p $(@D); echo $(HIDAPI) | cmp -s - $@ || echo $(HIDAPI) >$@
FORCE:

$(SHLIB): $(LIB_OBJ) $(HIDAPI_CHOICE)
	$(call say,LD)
	$(run)$(CC) -shared -Wl,-soname,libhitpipe.so.0 $(LDSAN) $(LIB_OBJ) -o $@ $(LIBS_LIB)

$(HITPIPE): $(HOST_OBJ) $(LIB) $(HIDAPI_CHOICE)
	$(call say,LD)
	$(run)$(CC) $(LDSAN) $(HOST_OBJ) $(LIB) -o $@ $(LIBS_HOST) $(LIBS_LIB)

$(TESTS) $(BENCHES) $(TOOLS): $(BUILD)/%: $(BUILD)/%.o $(SUPPORT_OBJ) $(HOST_LIB_OBJ) $(LIB) $(HIDAPI_CHOICE)
	$(call say,LD)
	$(run)$(CC) $(LDSAN) $< $(OWN_OBJ) $(SUPPORT_OBJ) $(HOST_LIB_OBJ) $(LIB) -o $@ $(OWN_LIBS) $(LIBS_TEST) $(LIBS_HOST) $(LIBS_LIB)

# ---- what a new user runs ---------------------------------------------------------------------------------------------
TERRAIN := vectors/terrain/jacksboro.exr

demo: ## install missing packages, build, trace the real terrain on the simulated board
	@mk/deps.sh $(PACKAGES_BUILD)
	@$(MAKE) all
	@mkdir -p out
	$(HITPIPE) trace $(TERRAIN) --resample 292x447 --out out/terrain.exr --png out/terrain.png --report out/report.json

check: ## install missing packages, build, run all tests
	@mk/deps.sh $(PACKAGES_BUILD) $(PACKAGES_CHECK)
	@$(MAKE) test

test: all tests
	@BUILD=$(BUILD) testbench/run $(JOBS) $(TESTS) $(TEST_SH)

tests: $(TESTS) $(TOOLS) $(BENCHES)

bench: all $(BENCHES) ## time the datapath and the engines, as ratios in one run
	@for b in $(BENCHES); do $$b || exit 1; done
	@$(MAKE) bench-peers

include $(wildcard mk/*.mk)

clean: ## remove what was built
	rm -rf build out

-include $(shell find $(BUILD) -type f -name '*.d' 2>/dev/null)

# Other libraries beside hitpipe: docs/peers.md. Not part of the default build: it needs C++ and their packages.
PACKAGES_PEERS := g++ libfcl-dev libode-dev libbullet-dev libccd-dev libeigen3-dev
PEERS          := $(BUILD)/testbench/peers/peers
PEERS_OBJ      := $(patsubst %,$(BUILD)/%.o,$(basename $(wildcard testbench/peers/*.c testbench/peers/*.cc)))
PEERS_COUNT    ?= 10000
PEERS_ROUNDS   ?= 9
# Headers of other libraries are not ours to have warnings of.
PEERS_CXXFLAGS  = -std=c++17 $(OPT) -ffp-contract=off -Wall -Wextra -Werror -Wshadow -MMD -MP -g \
                  $(subst -I,-isystem ,$(shell pkg-config --cflags-only-I bullet eigen3 ccd 2>/dev/null))
PEERS_LIBS     := -lfcl -lode -lBulletCollision -lLinearMath -lccd

$(BUILD)/testbench/peers/%.o: testbench/peers/%.cc
	$(call say,CXX)mkdir -p $(@D)
	$(run)$(CXX) $(PEERS_CXXFLAGS) $(INC) -c $< -o $@

$(PEERS): $(PEERS_OBJ) $(SUPPORT_OBJ) $(LIB)
	$(call say,LD)
	$(run)$(CXX) $^ -o $@ $(PEERS_LIBS) $(LIBS_TEST) $(LIBS_LIB)

# A program that is there must be of today: test_peers.sh asks it.
tests: $(wildcard $(PEERS))

peers: ## install FCL, ODE, Bullet and libccd; print how hitpipe agrees with them, and how fast each is
	@mk/deps.sh $(PACKAGES_PEERS)
	@$(MAKE) $(PEERS)
	@$(PEERS) agreement --count $(PEERS_COUNT)
	@$(PEERS) speed --rounds $(PEERS_ROUNDS)

# For `make bench`: the speed alone, where the packages are.
bench-peers:
	@if dpkg-query -W $(PACKAGES_PEERS) >/dev/null 2>&1; then $(MAKE) $(PEERS) && $(PEERS) speed --rounds $(PEERS_ROUNDS); \
	else echo "peers: not compared; make peers installs the packages: $(PACKAGES_PEERS)"; fi

.PHONY: peers bench-peers

# One part alone: PEERS_PART=agreement or PEERS_PART=speed.
peers-page: $(PEERS) ## measure against the other libraries, and put both tables into docs/peers.md
	@testbench/tools/peers_page.sh $(PEERS) $(PEERS_COUNT) $(PEERS_ROUNDS) $(PEERS_PART)

test-peers: $(PEERS) ## hold docs/peers.md to the program (where the other libraries are)
	@BUILD=$(BUILD) testbench/run $(JOBS) testbench/peers/test_peers.sh

.PHONY: peers-page test-peers

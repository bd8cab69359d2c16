# Pages and pictures that a program writes. Tests hold each to what the program says now.
pictures: all ## draw the pictures of docs/pipes.md again (the terrain of README: make terrain-picture)
	@mkdir -p docs/pictures && HITPIPE=$(HITPIPE) testbench/tools/pictures.sh docs/pictures

terrain-picture: all ## trace README's picture again: 221 thousand million tests
	@HITPIPE=$(HITPIPE) testbench/tools/pictures.sh --terrain docs/terrain.png

pipes-page: all ## put what each pipe costs into docs/pipes.md
	@HITPIPE=$(HITPIPE) testbench/tools/pipes_page.sh

experiment: all $(BUILD)/testbench/tools/swarm ## print the tables of docs/experiment.md: the paper's experiments on the simulated board
	@HITPIPE=$(HITPIPE) BUILD=$(BUILD) testbench/tools/experiment.sh

.PHONY: pictures terrain-picture pipes-page experiment

experiment: all ## print the table of docs/experiment.md: the paper's experiment on the simulated board
	@HITPIPE=$(HITPIPE) testbench/tools/experiment.sh

.PHONY: experiment

# Accuracy: docs/accuracy.md. COUNT pairs of each kind and class, pipes against the oracle.
COUNT ?= 10000

accuracy: $(BUILD)/testbench/tools/accuracy ## print the table of docs/accuracy.md: errors of all pipes on COUNT pairs a class
	@$< --count $(COUNT)

.PHONY: accuracy

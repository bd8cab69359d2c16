# Accuracy: docs/accuracy.md. COUNT pairs of each kind and class, pipes against the oracle.
COUNT ?= 10000

accuracy: $(BUILD)/testbench/tools/accuracy ## print the tables of docs/accuracy.md: errors of all pipes on COUNT pairs a class
	@$< --count $(COUNT)

accuracy-page: $(BUILD)/testbench/tools/accuracy ## measure, and put the tables into docs/accuracy.md
	@testbench/tools/accuracy_page.sh $< $(COUNT)

.PHONY: accuracy accuracy-page

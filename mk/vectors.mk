# Golden vectors: docs/vectors.md. The files stand in the tree; a test holds them against what this makes.
vectors: $(BUILD)/testbench/tools/make_vectors ## write the golden vectors again, checked by the exact oracle
	$< vectors

"""Writer of SDF: `writer.export` writes a model, `edits` changes numbers in a file that was read."""

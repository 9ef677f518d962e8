"""Reader of SDF: `reader.read` makes a `Robot` of a file."""

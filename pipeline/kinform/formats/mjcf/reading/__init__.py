"""Reader of MJCF: `reader.read` makes a `Robot` of a file."""

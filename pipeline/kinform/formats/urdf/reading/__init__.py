"""Reader of URDF: `reader.read` makes a `Robot` of a file."""

"""Reader of glTF: `reader.read_gltf` makes a `Scene` of a file."""

"""Mesh files: reading, bodies in a file, welding, topology, health."""

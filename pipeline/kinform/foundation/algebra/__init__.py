"""Vectors, screws, displacements, rotations."""

"""Kinds of curved surfaces, one a file, with what ruled and what doubly curved ones share in files of their own."""

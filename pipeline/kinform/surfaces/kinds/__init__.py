"""Kinds of surfaces, one a file."""

"""Surfaces that lie on each other."""

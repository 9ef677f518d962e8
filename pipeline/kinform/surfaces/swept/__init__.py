"""Surfaces that a motion sweeps: helicoids, revolutions, extrusions."""

"""Surfaces that one motion sweeps: threads, revolutions, extrusions."""

"""Quantities that several rules compare."""

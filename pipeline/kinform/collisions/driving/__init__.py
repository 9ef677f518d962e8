"""Joints driven until something stops them: alone, or with the loops that tie them together."""

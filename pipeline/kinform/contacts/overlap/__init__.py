"""Solids that overlap."""

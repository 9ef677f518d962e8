"""Frozen types that the stages exchange. No algorithms."""

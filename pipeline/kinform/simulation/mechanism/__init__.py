"""A model to solve: the mechanism in joint coordinates, and what acts on it."""

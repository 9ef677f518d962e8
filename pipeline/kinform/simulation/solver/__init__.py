"""The solver: from a start through time."""

"""Numbers that several modules of `formats` share."""

from __future__ import annotations

INCLUDES = 32
"""Files in files in files that a description may include: more are a loop that no check of names has seen."""
AXIS_LENGTH = 1e-9
"""Length of a joint's axis below which it is none: axes are unit vectors, up to digits."""

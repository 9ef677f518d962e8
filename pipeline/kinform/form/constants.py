"""The numbers that decide how manifests and meshes are read, by the module that uses them.

What users may set is in `Tolerances`. Where no measurement is named, a number is a choice.
"""

from __future__ import annotations

LARGEST_NUMBER = 1e18
"""The largest magnitude of a stated number, coordinates of meshes included: sixth powers of it, in whatever unit, are
still finite, in our code and in FCL's. A thousand million kilometres in micrometres is no more."""
NAME_LENGTH = 255
"""Characters of a name, and of a key of a table: what a file system lets a file's name have."""
MANIFEST_BYTES = 2 << 20
"""Bytes of a manifest: 10,000 parts with poses. Values, places and complaints take 200 times that at worst, 400 MB."""
PARTS_MOST = 100_000
"""Parts of a design: twenty times what the largest measured design has."""
VALUE_LENGTH = 60
"""Characters of a wrong value that a message shows."""
SHEAR = 1e-5
"""Cosine between the axes of a scaled or placed mesh up to which they are at right angles: ten roundings of single
precision, times ten for chains of nodes; quaternions are often printed with six digits."""
STEP_TURN = 0.1
"""Largest angle (rad) between neighbouring facets of one surface: 63 facets round a circle, which are 0.12 % of its
radius from it; fits of such are exact to their vertices."""

"""Bounds on what is read, which several modules of `form` and `formats` share.

What users may set is in `Tolerances`.
"""

from __future__ import annotations

LARGEST_NUMBER = 1e18
"""The largest magnitude of a stated number, coordinates of meshes included: sixth powers of it, in whatever unit, are
still finite, in our code and in FCL's. A thousand million kilometres in micrometres is no more."""
NAME_LENGTH = 255
"""Characters of a name and of a key of a table, and bytes of the name of a file: what file systems take. Bare keys,
numbers and dates of TOML have no more: doubles take 25."""
VALUE_LENGTH = 60
"""Characters of a wrong value that a message shows: half a line of a terminal. Chosen, not measured."""
PARTS_MOST = 100_000
"""Parts of a design: twenty times what the largest measured design has."""
FILES_DEEP = 32
"""Files that a file includes, which include others, and so on: more are a circle that no check of names has seen.
Chosen, not measured."""
PROBLEMS_MOST = 1000
"""Problems of the input that are reported, and faults of one mesh file that are kept to find those of the first lines
among them: who has more repairs these first. Chosen, not measured."""
FAULTS_SHOWN = 10
"""Faults of one mesh file that are reported: a broken writer makes the same one on every line. Chosen, not measured."""
MANIFEST_BYTES = 2 << 20
"""Bytes of a manifest: 10,000 parts with poses. Values, places and complaints take 200 times that at worst, 400 MB."""
TEXT_BYTES = 64 << 20
"""Bytes of the XML of a robot description and of the JSON of a glTF: descriptions of robots with a thousand links, and
scenes of 10,000 nodes, have a tenth of it. What is parsed takes ten times as much memory."""
UNPACKED_TIMES = 100
"""Bytes of XML in one packed byte of a 3MF, at most: repeated lattices have thirty, and blanks a thousand. Chosen, not
measured."""
UNPACKED_FREELY = 16 << 20
"""Bytes of the XML of a 3MF that need no such ratio."""
TREE_TIMES = 250
"""Bytes of memory that parsed XML takes, by its elements and attributes, for one packed byte of a 3MF, at most:
vertices and triangles of meshes, five times packed, take a hundred. Chosen, not measured."""
TREE_FREELY = 200 << 20
"""Bytes of memory of parsed XML that need no such ratio."""
ELEMENT_BYTES, ATTRIBUTE_BYTES = 120, 220
"""Bytes of memory that an element and an attribute take in libxml2 2.9, their texts of a few characters included."""
UNPACKED_BYTES = 512 << 20
"""Bytes of the XML of a 3MF, unpacked, and of a DAE: ten million facets, which take ten times as much memory."""
FRAME_ROUNDING = 1e-5
"""Cosine between the axes of a scaled or placed mesh up to which they are at right angles, and relative difference up
to which a scale is 1: ten roundings of single precision, times ten for chains of nodes; quaternions are often printed
with six digits."""
STEP_TURN = 0.1
"""Largest angle (rad) between neighbouring facets of one surface: 63 facets round a circle, which are 0.12 % of its
radius from it; fits of such are exact to their vertices."""

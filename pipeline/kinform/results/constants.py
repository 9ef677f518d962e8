"""Every number of the results file that decides, with its reason."""

from __future__ import annotations

BLOCK = 512
"""Bytes before the HDF5: the least that HDF5 allows, and more than the digest needs."""

GROWTH = 1 << 20
"""Bytes by which the image of a file grows: with fewer it is copied often."""

MOST_OBJECTS = 10_000
"""Groups, datasets and attributes of a file: kinform writes some two hundred, whatever the design, and some for each
kind of thing that is in it. More would take long to look through, and are not of kinform."""

DEPTH = 6
"""Groups in groups: kinform writes three, and a group that contains itself has no end."""

READ_AT_ONCE = 1 << 16
"""Bytes of a table that are looked through at once: memory that is used again is cheaper than new memory."""

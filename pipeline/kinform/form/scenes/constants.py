"""Numbers that several modules of `form.scenes` share."""

from __future__ import annotations

SCENE_XML_BYTES = 1 << 29
"""Largest XML of a 3MF or DAE, unpacked: ten million facets, which take ten times as much memory."""

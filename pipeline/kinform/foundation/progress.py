"""How long work tells how far it is."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[int, int], None]
"""Called with the steps done and the steps in all."""
Say = Callable[[str], None]
"""Told what takes long besides the steps that are counted."""

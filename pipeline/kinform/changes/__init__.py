"""What changed in behaviour: between two designs, or since a designer accepted what was derived (a lock)."""

from __future__ import annotations

from kinform.changes.behaviours import Snapshot, snapshot
from kinform.changes.change import Change
from kinform.changes.comparison import Comparison, compare, compare_designs
from kinform.changes.lock import Lock, read_lock, with_lock, write_lock
from kinform.changes.page import diff_page
from kinform.changes.render import FORMATS, render
from kinform.changes.tolerance import Tolerance

__all__ = [
    "FORMATS",
    "Change",
    "Comparison",
    "Lock",
    "Snapshot",
    "Tolerance",
    "compare",
    "compare_designs",
    "diff_page",
    "read_lock",
    "render",
    "snapshot",
    "with_lock",
    "write_lock",
]

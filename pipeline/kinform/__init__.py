"""kinform: form, behaviour and function of mechanical assemblies, kept consistent.

`run` derives everything from a manifest, `open` reads a results file; both give objects with `joints`,
`mobility`, `contacts`, `mass`, `simulation` and `findings`. Nothing heavy is imported before it is used.
"""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kinform.errors import InputError, KinformError, Problem, ResultsError, StageError
from kinform.version import __version__

if TYPE_CHECKING:
    from kinform.api import Assembly, Named, Outcome, Results
    from kinform.method import run

__all__ = [
    "Assembly",
    "InputError",
    "KinformError",
    "Named",
    "Outcome",
    "Problem",
    "Results",
    "ResultsError",
    "StageError",
    "__version__",
    "open",
    "run",
]


def open(path: str | Path) -> Results:
    """The results file at `path`; see `kinform.Results`.

    Raises ResultsError when it is no results file, or of another schema.
    """
    from kinform import api

    return api.open_results(path)


_LAZY = {
    "run": "kinform.method",
    "Assembly": "kinform.api",
    "Named": "kinform.api",
    "Outcome": "kinform.api",
    "Results": "kinform.api",
}
"""Public names that are imported when they are first used, and where from."""


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        raise AttributeError(f"module 'kinform' has no attribute {name!r}")
    return globals().setdefault(name, getattr(importlib.import_module(_LAZY[name]), name))


def __dir__() -> list[str]:
    return sorted(__all__)

"""kinform: form, behaviour and function of mechanical assemblies, kept consistent.

`run` derives everything from a manifest, `open` reads a results file; both give objects with `joints`,
`mobility`, `contacts`, `mass`, `simulation` and `findings`. Nothing heavy is imported before it is used.
"""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kinform._version import __version__
from kinform.errors import InputError, KinformError, Problem, ResultsError, StageError

if TYPE_CHECKING:
    from kinform.api import Named, Outcome, Results
    from kinform.run import run

__all__ = [
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


def __getattr__(name: str) -> Any:
    if name == "run":
        # the module is callable, so that `kinform.run` is the function whoever imports it first
        return importlib.import_module("kinform.run")
    if name in ("Named", "Outcome", "Results"):
        return getattr(importlib.import_module("kinform.api"), name)
    raise AttributeError(f"module 'kinform' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)

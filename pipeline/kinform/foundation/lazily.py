"""Public names of a package that are imported when they are first used.

A command looks at a small part of what a package offers; what it does not look at costs nothing to start.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Mapping
from typing import Any


def first_used(package: str, where: Mapping[str, str]) -> Callable[[str], Any]:
    """The `__getattr__` of a package; `where` names the module below it, and with a colon the name there if it is
    another one."""

    def found(name: str) -> Any:
        if name not in where:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        module, _, attribute = where[name].partition(":")
        value = getattr(importlib.import_module(f"{package}.{module}"), attribute or name)
        return vars(sys.modules[package]).setdefault(name, value)

    return found

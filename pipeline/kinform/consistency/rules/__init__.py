"""All rules, one file each: its docstring is what `kinform explain` prints. A file here is registered by being here."""

from __future__ import annotations

from importlib import import_module
from pkgutil import iter_modules

from kinform.consistency.rule import Rule

__all__ = ["RULES"]

RULES: tuple[Rule, ...] = tuple(
    import_module(f"{__name__}.{name}").RULE for name in sorted(module.name for module in iter_modules(__path__))
)
"""Sorted by code, as the files are."""

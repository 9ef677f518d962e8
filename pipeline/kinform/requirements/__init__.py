"""Requirements: each kind in one module, with its table, its record, its judge and its words.

A module in `kinds` is registered by being there. It defines `KIND`: the table of `[[function.require]]` with what its
keys say about each other, the record of what is asked for in SI, and the judge that answers it. Judges see a design
through `evidence.Evidence` only; the geometry behind it is in `function` and `statics`. The rule that reports what is
violated is in `consistency/rules`.

Sub-packages:

- `kinds`: one kind a module
"""

from __future__ import annotations

from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kinform.requirements.kind import Kind

__all__ = ["CODE_VERSION", "KINDS", "all_kinds", "kind_of"]

CODE_VERSION: int = 2
"""Bumped when results of stages that use this package change for the same input."""

KINDS = frozenset(module.name for module in iter_modules([f"{path}/kinds" for path in __path__]))
"""Names of all kinds: those of the modules in `kinds`."""


@cache
def kind_of(name: str) -> Kind[Any, Any]:
    """The kind of that name; its module is imported when it is first asked for. KeyError where there is none."""
    if name not in KINDS:
        raise KeyError(name)
    kind: Kind[Any, Any] = import_module(f"{__name__}.kinds.{name}").KIND
    return kind


@cache
def all_kinds() -> tuple[Kind[Any, Any], ...]:
    """All kinds, in the order in which the schema lists them."""
    return tuple(sorted(map(kind_of, KINDS), key=lambda kind: kind.position))

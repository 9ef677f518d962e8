"""Form: manifests, units, mesh files, sub-assemblies, in SI and world axes, with every error at once.

Nothing of it is imported before it is used: a run that finds everything in earlier results parses no manifest.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kinform.form.from_python import from_meshes
    from kinform.form.manifest import json_schema as schema
    from kinform.form.readers.assembly import load
    from kinform.form.without_manifest import init_manifest, load_meshes

__all__ = ["CODE_VERSION", "from_meshes", "init_manifest", "load", "load_meshes", "schema"]

CODE_VERSION: int = 14
"""Bumped when results change."""

_LAZY = {
    "from_meshes": ("from_python", "from_meshes"),
    "load": ("readers.assembly", "load"),
    "load_meshes": ("without_manifest", "load_meshes"),
    "init_manifest": ("without_manifest", "init_manifest"),
    "schema": ("manifest", "json_schema"),
}
"""Module and name of what is imported when it is first used."""


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        raise AttributeError(f"module 'kinform.form' has no attribute {name!r}")
    module, attribute = _LAZY[name]
    return globals().setdefault(name, getattr(importlib.import_module(f"kinform.form.{module}"), attribute))

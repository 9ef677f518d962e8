"""Form: manifests, units, mesh files, sub-assemblies, in SI and world axes, with every error at once.

Nothing of it is imported before it is used: a run that finds everything in earlier results parses no manifest.

Sub-packages; each imports only those above it:

- `manifest`: tables of the manifest as pydantic types
- `meshes`: mesh files and primitives
- `readers`: from tables to the assembly
- `scenes`: CAD and scene files
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinform.foundation.lazy_imports import lazy_attributes

if TYPE_CHECKING:
    from kinform.form.from_python import from_meshes
    from kinform.form.manifest import json_schema as schema
    from kinform.form.readers.assembly import load
    from kinform.form.without_manifest import init_manifest, load_meshes

__all__ = ["CODE_VERSION", "from_meshes", "init_manifest", "load", "load_meshes", "schema"]

CODE_VERSION: int = 30
"""Bumped when results change."""

__getattr__ = lazy_attributes(
    __name__,
    {
        "from_meshes": "from_python",
        "load": "readers.assembly",
        "load_meshes": "without_manifest",
        "init_manifest": "without_manifest",
        "schema": "manifest:json_schema",
    },
)

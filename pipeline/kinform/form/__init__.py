"""Form: manifests, units, mesh files, sub-assemblies, in SI and world axes, with every error at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from kinform.model.assembly import Assembly

__all__ = ["CODE_VERSION", "init_manifest", "load", "load_meshes", "schema"]

CODE_VERSION: int = 3


def load(path: str | Path, *, allow_outside: bool = False) -> Assembly:
    """The assembly that a manifest describes; see `kinform.form.read.load`."""
    from kinform.form import read

    return read.load(path, allow_outside=allow_outside)


def load_meshes(
    paths: Sequence[str | Path], *, units: str, name: str | None = None, density: float | None = None
) -> Assembly:
    """An assembly of mesh files without a manifest; see `kinform.form.single.load_meshes`."""
    from kinform.form import single

    return single.load_meshes(paths, units=units, name=name, density=density)


def init_manifest(
    paths: Sequence[str | Path],
    *,
    units: str,
    name: str | None = None,
    relative_to: str | Path = ".",
    fastened: Callable[[Assembly], Sequence[tuple[Sequence[str], str]]] | None = None,
) -> str:
    """Text of a manifest for these meshes; see `kinform.form.single.init_manifest`."""
    from kinform.form import single

    return single.init_manifest(paths, units=units, name=name, relative_to=relative_to, fastened=fastened)


def schema() -> dict[str, Any]:
    """JSON Schema of the manifest."""
    from kinform.form.manifest import json_schema

    return json_schema()

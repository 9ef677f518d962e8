"""Designs as people write them: a manifest with its meshes in a folder."""

from __future__ import annotations

from pathlib import Path

from fixtures.generators.solids import Solid
from fixtures.generators.writers import binary_stl

__all__ = ["manifest"]


def manifest(folder: Path, parts: dict[str, Solid], rest: str, *, units: str = "mm", more: str = "") -> Path:
    """A manifest with the parts' meshes (mm, or the units given) beside it; `more` is said of every part."""
    text = f'schema = 1\n[assembly]\nname = "everyday"\nunits = "{units}"\n'
    for name, solid in parts.items():
        binary_stl(folder / f"{name}.stl", solid.arrays())
        text += f'[[part]]\nname = "{name}"\nmesh = "{name}.stl"\n{more}'
    path = folder / "everyday.toml"
    path.write_text(text + rest)
    return path

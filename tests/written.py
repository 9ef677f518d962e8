"""Designs as people write them: a manifest with its meshes in a folder."""

from __future__ import annotations

from pathlib import Path

from fixtures.generators.solids import Solid
from fixtures.generators.writers import binary_stl

__all__ = ["manifest"]


def manifest(folder: Path, parts: dict[str, Solid], rest: str, *, ground: str = "", more: str = "") -> Path:
    """A manifest in mm with the parts' meshes beside it; `more` is said of every part."""
    text = 'schema = 1\n[assembly]\nname = "everyday"\nunits = "mm"\n' + (f'ground = "{ground}"\n' if ground else "")
    for name, solid in parts.items():
        binary_stl(folder / f"{name}.stl", solid.arrays())
        text += f'[[part]]\nname = "{name}"\nmesh = "{name}.stl"\n{more}'
    path = folder / "everyday.toml"
    path.write_text(text + rest)
    return path

"""Designs as people write them: a manifest with its meshes in a folder."""

from __future__ import annotations

from pathlib import Path

from generators.solids import Solid
from generators.writers import binary_stl

__all__ = ["manifest", "stated_joint", "stated_part"]

Vector = tuple[float, float, float]


def stated_part(name: str, mass: float, centre: Vector = (0, 0, 0)) -> str:
    """A `[[part]]` without mesh, of 1e-4 kg·m² about every axis."""
    inertia = "[[1e-4, 0, 0], [0, 1e-4, 0], [0, 0, 1e-4]]"
    return f'[[part]]\nname = "{name}"\nmass = {mass}\ncentre_of_mass = {list(centre)}\ninertia = {inertia}\n'


def stated_joint(
    name: str, between: tuple[str, str], kind: str, axis: Vector = (0, 0, 1), point: Vector = (0, 0, 0)
) -> str:
    """A `[[function.joint]]`; a slide has no point."""
    where = "" if kind == "prismatic" else f"point = {list(point)}\n"
    first, second = between
    return (
        f'[[function.joint]]\nname = "{name}"\nbetween = ["{first}", "{second}"]\ntype = "{kind}"\n'
        f"axis = {list(axis)}\n{where}"
    )


def manifest(folder: Path, parts: dict[str, Solid], rest: str, *, ground: str = "", more: str = "") -> Path:
    """A manifest in mm with the parts' meshes beside it; `more` is said of every part."""
    text = 'schema = 1\n[assembly]\nname = "everyday"\nunits = "mm"\n' + (f'ground = "{ground}"\n' if ground else "")
    for name, solid in parts.items():
        binary_stl(folder / f"{name}.stl", solid.arrays())
        text += f'[[part]]\nname = "{name}"\nmesh = "{name}.stl"\n{more}'
    path = folder / "everyday.toml"
    path.write_text(text + rest)
    return path

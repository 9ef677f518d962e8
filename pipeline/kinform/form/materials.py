"""Built-in materials: typical densities at room temperature, rounded as in common engineering tables.

A `[materials.NAME]` of the manifest always wins over an entry of this table.
"""

from __future__ import annotations

BUILT_IN: dict[str, float] = {
    "abs": 1040.0,
    "acrylic": 1180.0,
    "aluminium": 2700.0,
    "aluminum": 2700.0,
    "brass": 8500.0,
    "bronze": 8800.0,
    "cast_iron": 7200.0,
    "copper": 8960.0,
    "cfrp": 1600.0,
    "glass": 2500.0,
    "lead": 11340.0,
    "magnesium": 1740.0,
    "nylon": 1140.0,
    "peek": 1310.0,
    "petg": 1270.0,
    "pla": 1240.0,
    "plywood": 650.0,
    "polycarbonate": 1200.0,
    "pom": 1410.0,
    "ptfe": 2200.0,
    "rubber": 1150.0,
    "stainless": 8000.0,
    "steel": 7850.0,
    "titanium": 4430.0,
    "tungsten": 19250.0,
    "zinc": 7140.0,
}
"""kg/m³."""


def density_of(name: str, stated: dict[str, float]) -> float | None:
    """Density (kg/m³) of a material: the manifest's own table first, then the built-in; None if unknown."""
    return stated.get(name, BUILT_IN.get(name))

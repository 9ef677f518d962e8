"""What can stand in place of a manifest, as its `from`, and as the `file` of a sub-assembly.

Formats are listed in `kinform.formats.registry`. `tables(source)` of a module, imported when a file of its suffix is
read, gives the tables of the manifest that says the same, and from there everything goes the way of manifests.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from dataclasses import field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

from kinform.formats.registry import ROBOT_FORMATS, SCENE_FORMATS
from kinform.foundation.boundary import Boundary
from kinform.frozen import dataclass

if TYPE_CHECKING:
    from kinform.form.problems import Problems
    from kinform.form.readers.places import Places
    from kinform.formats.description.facts import Facts

_TABLES: Mapping[str, str] = {
    **{suffix: "form.scenes.tables" for format in SCENE_FORMATS for suffix in format.suffixes},
    **{suffix: "formats.description.tables" for format in ROBOT_FORMATS for suffix in format.suffixes},
}
"""Module of `kinform` with `tables(source)`, by the suffix of the files that it reads."""

_UNITLESS = frozenset(suffix for format in SCENE_FORMATS if format.unitless for suffix in format.suffixes)
"""Suffixes of formats without a unit of length."""

_UNREAD: Mapping[str, str] = {
    ".igs": "IGES", ".iges": "IGES", ".brep": "BREP", ".fcstd": "FreeCAD", ".sldprt": "SolidWorks",
    ".sldasm": "SolidWorks", ".f3d": "Fusion", ".f3z": "Fusion", ".ipt": "Inventor", ".iam": "Inventor",
    ".catpart": "CATIA", ".catproduct": "CATIA", ".prt": "NX or Creo", ".asm": "NX or Creo", ".x_t": "Parasolid",
    ".x_b": "Parasolid", ".jt": "JT", ".3dm": "Rhino", ".blend": "Blender", ".fbx": "FBX", ".usd": "USD",
    ".usda": "USD", ".usdz": "USD", ".dxf": "DXF", ".dwg": "DWG", ".stpz": "zipped STEP", ".scad": "OpenSCAD",
}  # fmt: skip
"""Formats of designs that are not read, by suffix."""

Geometry = Literal["visual", "collision"]
"""Which geometry of a description its parts are."""
GEOMETRIES: tuple[Geometry, ...] = get_args(Geometry)


@dataclass(frozen=True)
class Reading:
    """What a user may say of how sources are read."""

    geometry: Geometry = "visual"
    packages: tuple[tuple[str, str], ...] = ()
    """Folders of `package://NAME`, by name."""
    deviation: float | None = None
    """Largest distance (m) of the facets of a STEP file from its surfaces; None: a share of its edges."""
    changes: tuple[tuple[tuple[str, ...], Any], ...] = ()
    """Other values for keys of the top manifest: paths as of `kinform.form.keys`, and values."""
    allow_xacro: bool = False
    """Whether xacro files are expanded by xacro itself, which runs what their expressions say."""
    boundary: Boundary | None = field(default=None, compare=False, repr=False)
    """What files that a scene names may be; without one, those of the design's folder of the scene."""

    @property
    def of_files(self) -> Reading:
        """The same, without changes: how files are read, the top manifest apart."""
        return replace(self, changes=())


AS_IT_IS = Reading()
"""Visual geometry, packages where they are found."""


@dataclass(frozen=True)
class Source:
    """A file to be read."""

    path: Path
    file: str
    """As messages show it."""
    folder: Path
    """Paths in the tables are to be relative to it."""
    units: str | None
    """Of the lengths in the tables; None: those of the source."""
    problems: Problems
    reading: Reading
    boundary: Boundary
    """What may be read."""


@dataclass(frozen=True)
class SourceTables:
    """The tables of a manifest, and where each of its keys was said."""

    raw: dict[str, Any]
    places: Places
    notes: tuple[str, ...] = ()
    files: tuple[Path, ...] = ()
    """Files that were read besides the source, meshes apart."""
    described: bool = True
    """Whether this is a robot description: what it says of links and joints is meant to be all."""
    facts: Facts | None = None
    """What a robot description says word for word."""
    unsettled: bool = False
    """Whether the answer hangs on more than what these files hold, as on which files fit a pattern."""


def is_source(path: Path) -> bool:
    """Whether the suffix is that of a description or an assembly file."""
    return path.suffix.lower() in _TABLES


def is_scene(path: Path) -> bool:
    """Whether the suffix is that of a CAD or scene file."""
    return _TABLES.get(path.suffix.lower()) == "form.scenes.tables"


def states_units(path: Path) -> bool:
    """Whether a description or an assembly file has its own unit of length; else it is a mesh as well."""
    return is_source(path) and path.suffix.lower() not in _UNITLESS


def unread(path: Path) -> tuple[str, str] | None:
    """What is wrong with a file of a format of designs that is not read, and the remedy; None for other files."""
    format = _UNREAD.get(path.suffix.lower())
    return None if format is None else (f"is {format}, which is not read", "export STEP, GLB or 3MF from its program")


def source_tables(source: Source) -> SourceTables | None:
    """What a source says, as tables; None where nothing can be made of it. Every problem is noted."""
    module = importlib.import_module(f"kinform.{_TABLES[source.path.suffix.lower()]}")
    tables: SourceTables | None = module.tables(source)
    return tables

"""The formats that are written, and the function that writes a design in any of them.

Formats of robot descriptions are listed in `kinform.formats.registry`, with their readers.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from importlib import import_module

from kinform.design import Design
from kinform.exports.exported import Exported, ExportError, LostError
from kinform.exports.model import ExportModel, export_model
from kinform.formats.registry import WRITTEN
from kinform.frozen import dataclass


@dataclass(frozen=True)
class Format:
    """A format: its name on the command line, the module that writes it, what for, and the function that does so."""

    name: str
    module: str
    purpose: str
    exporter: str = "export"

    @property
    def write(self) -> Callable[[ExportModel], Exported]:
        """Its exporter, imported when it is needed."""
        exporter: Callable[[ExportModel], Exported] = getattr(import_module(f"kinform.{self.module}"), self.exporter)
        return exporter


_FORMATS = (
    Format("csv", "exports.series", "the motion as tables of bodies and joints"),
    Format("dot", "exports.graph.formats", "the kinematic graph, for Graphviz", "export_dot"),
    Format("glb", "formats.gltf.writing.writer", "shapes in motion, for viewers of glTF"),
    Format("json", "exports.port_model", "the port model, with its schema"),
    Format("modelica", "exports.modelica.writer", "components and connectors, for solvers of equations"),
    Format("svg", "exports.graph.formats", "the kinematic graph, drawn", "export_svg"),
    Format("vhdl-ams", "exports.vhdl_ams.writer", "entities of the standard IEEE 1076.1"),
    *(Format(robot.name, robot.writer, robot.purpose) for robot in WRITTEN.values()),
)
FORMATS: dict[str, Format] = {format.name: format for format in sorted(_FORMATS, key=lambda format: format.name)}
"""By name, in the order of names."""

FIXES = ("inertia",)
"""What can be put right in a description."""


def export(
    design: Design, format: str, *, strict: bool = False, fix: Collection[str] = (), folder: str | None = None
) -> Exported:
    """The design in a format of FORMATS. One that was read from a description of that format is given as that
    description, with what was touched; `fix` and `folder` as of `write_back.export`.

    Raises StageError before joints are derived, ExportError when there is nothing to write, KeyError for
    an unknown format, and with `strict` LostError when the format cannot carry all of the model. ExportError too where
    there is no description to fix.
    """
    exported = _exported(design, format, fix, folder)
    if strict and exported.lost:
        raise LostError(format, exported.lost)
    return exported


def _exported(design: Design, format: str, fix: Collection[str], folder: str | None) -> Exported:
    written = FORMATS[format].write
    if any(not d.prefix and d.format == format and d.text for d in design.assembly.descriptions):
        from kinform.formats.description.writing import write_back

        if write_back.description_of(design, format) is not None:
            return write_back.export(design, format, inertia="inertia" in fix, folder=folder)
    if fix:
        raise ExportError(f"there is no description of the format {format} to fix: the design was not read from one")
    return written(export_model(design))

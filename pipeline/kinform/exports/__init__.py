"""Models that other tools run: one module or package per format, listed in `registry`.

Formats that are read as well (URDF, SDF, MJCF, glTF) have their writers in `kinform.formats`. Every exporter reads the
port model of `kinform.behaviour` and what belongs to it (`model.ExportModel`). What a format cannot carry is named in
`Exported.lost` and in the files themselves. Nothing written depends on clock, host or path.

Sub-packages; each imports only those above it:

- `graph`: the kinematic graph as a drawing
- `modelica`: Modelica
- `vhdl_ams`: VHDL-AMS
"""

from __future__ import annotations

from kinform.exports.exported import Exported, ExportError, LostError, write
from kinform.exports.registry import FIXES, FORMATS, Format, export

__all__ = ["FIXES", "FORMATS", "ExportError", "Exported", "Format", "LostError", "export", "write"]

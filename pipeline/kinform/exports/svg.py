"""svg: the kinematic graph as a drawing."""

from __future__ import annotations

from kinform.exports.exported import Exported
from kinform.exports.graph.drawing import graph_svg
from kinform.exports.model import ExportModel
from kinform.exports.names import FILES, identifiers

__all__ = ["export"]


def export(model: ExportModel) -> Exported:
    """One file: bodies, joints and loops."""
    return Exported({f"{identifiers([model.name], FILES)[model.name]}.svg": graph_svg(model.kinematics).encode()})

"""dot: the kinematic graph for Graphviz."""

from __future__ import annotations

from kinform.exports.exported import Exported
from kinform.exports.graph.drawing import graph_dot
from kinform.exports.model import ExportModel
from kinform.exports.names import FILES, identifiers

__all__ = ["export"]


def export(model: ExportModel) -> Exported:
    """One file: bodies, joints and loops."""
    return Exported({f"{identifiers([model.name], FILES)[model.name]}.dot": graph_dot(model.kinematics).encode()})

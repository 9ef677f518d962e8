"""dot and svg: the kinematic graph in a file, bodies, joints and loops."""

from __future__ import annotations

from kinform.exports.exported import Exported
from kinform.exports.graph.drawing import graph_dot, graph_svg
from kinform.exports.model import ExportModel
from kinform.exports.names import FILES, identifiers


def export_dot(model: ExportModel) -> Exported:
    """NAME.dot, for Graphviz."""
    return _export(model, "dot", graph_dot(model.kinematics))


def export_svg(model: ExportModel) -> Exported:
    """NAME.svg, drawn."""
    return _export(model, "svg", graph_svg(model.kinematics))


def _export(model: ExportModel, ending: str, text: str) -> Exported:
    return Exported({f"{identifiers([model.name], FILES)[model.name]}.{ending}": text.encode()})

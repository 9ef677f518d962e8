"""The kinematic graph as a drawing: bodies as boxes, joints as lines with their type, loops, and what is ground.

SVG is drawn here, with nothing from outside; DOT is for Graphviz and whatever reads its language.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import NDArray

from kinform.kinematics.cycles import short_cycles
from kinform.kinematics.graph import blocks
from kinform.model.kinematics import Joint, Kinematics
from kinform.reports._layout import placed
from kinform.reports.words import counted, one_line

__all__ = ["graph_dot", "graph_svg"]

Array = NDArray[np.float64]

SYMBOLS = {
    "fixed": "F", "revolute": "R", "prismatic": "P", "cylindrical": "C", "spherical": "S", "planar": "E",
    "screw": "H", "universal": "U", "general": "G",
}  # fmt: skip
DASHES = {"ambiguous": "7 5", "blocked": "2 4"}
LETTER, LINE = 7.3, 18.0
"""Width of a letter and height of a line of 13 px text (px)."""
MARGIN = 30.0
SPACING = 105.0
LOOPS = 40
"""Up to so many loops are numbered."""
RADIUS = 10.5
CLEARED = 600
"""Up to so many bodies the symbols keep clear of boxes."""


@dataclass(frozen=True)
class _Loop:
    """An independent loop: its bodies, and how many constraints it holds twice."""

    nodes: tuple[int, ...]
    rows: int


def graph_dot(kinematics: Kinematics) -> str:
    """The graph in the DOT language: ground filled, ambiguous joints dashed, blocked ones dotted."""
    lines = ["graph kinematics {", "  node [shape=box];"]
    for body in kinematics.bodies:
        ground = ' [style=filled, fillcolor="gray85", xlabel="ground"]' if body.ground else ""
        lines.append(f"  {_quoted(body.name)}{ground};")
    drivers = _drivers(kinematics)
    for joint in kinematics.joints:
        label = SYMBOLS[joint.type] + (" *" if joint.name in drivers else "")
        style = {"ambiguous": ", style=dashed", "blocked": ", style=dotted"}.get(joint.status, "")
        ends = " -- ".join(_quoted(name) for name in joint.bodies)
        lines.append(f"  {ends} [label={_quoted(label)}, tooltip={_quoted(_about(joint))}{style}];")
    return "\n".join([*lines, "}"]) + "\n"


def graph_svg(kinematics: Kinematics) -> str:
    """The graph as one SVG: ground hatched, ambiguous joints dashed, drivers of freedoms filled, loops numbered."""
    names = [one_line(body.name) for body in kinematics.bodies]
    index = {body.name: n for n, body in enumerate(kinematics.bodies)}
    edges = [(index[j.bodies[0]], index[j.bodies[1]]) for j in kinematics.joints]
    ground = next((n for n, body in enumerate(kinematics.bodies) if body.ground), 0)
    sizes = np.array([[LETTER * len(name) + 22.0, 30.0] for name in names]).reshape(-1, 2)
    at = placed(sizes, edges, ground, SPACING) + MARGIN
    loops = _loops(kinematics, edges)
    drawn = [_line(at, edge, joint, sizes) for edge, joint in zip(edges, kinematics.joints, strict=True)]
    drawn += [
        _box(name, centre, size, body.ground)
        for name, centre, size, body in zip(names, at, sizes, kinematics.bodies, strict=True)
    ]
    drivers = _drivers(kinematics)
    for edge, joint in zip(edges, kinematics.joints, strict=True):
        drawn.append(_symbol(_middle(at, sizes, edge), joint, joint.name in drivers))
    drawn += [_loop_mark(n, loop, at) for n, loop in enumerate(loops, 1)]
    extent = (at + sizes / 2).max(axis=0, initial=0.0) + MARGIN
    legend = list(_legend(kinematics, loops))
    width = max(float(extent[0]), LETTER * max(map(len, legend)) + 2 * MARGIN)
    height = float(extent[1]) + LINE * len(legend) + MARGIN
    texts = [
        f'<text x="{MARGIN:.0f}" y="{extent[1] + LINE * (n + 1):.1f}" class="legend">{escape(text)}</text>'
        for n, text in enumerate(legend)
    ]
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.1f} {height:.1f}" '
        f'width="{width:.0f}" height="{height:.0f}" font-family="sans-serif" font-size="13">'
    )
    return "\n".join([head, _STYLE, *drawn, *texts, "</svg>"]) + "\n"


_STYLE = """<style>
.joint { stroke: #445; stroke-width: 1.6; fill: none }
.body { fill: #fff; stroke: #223; stroke-width: 1.4 }
.ground { fill: url(#hatch); stroke: #223; stroke-width: 2.2 }
.plate { fill: #fff }
.legend { fill: #333; font-size: 12px }
.loop { fill: #1b6ca8; font-size: 12px }
.held { fill: #b3541e; font-size: 12px }
</style>
<defs><pattern id="hatch" width="7" height="7" patternUnits="userSpaceOnUse" patternTransform="rotate(45)">
<rect width="7" height="7" fill="#fff"/><line x1="0" y1="0" x2="0" y2="7" stroke="#889" stroke-width="2.4"/></pattern></defs>
<rect width="100%" height="100%" fill="#fff"/>"""


def _quoted(text: str) -> str:
    clean = one_line(text).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{clean}"'


def _about(joint: Joint) -> str:
    return f"{joint.name}: {joint.type}, {counted(joint.freedoms, 'freedom')}, {joint.status}"


def _drivers(kinematics: Kinematics) -> set[str]:
    return {str(freedom.driver) for freedom in kinematics.mobility.named if freedom.driver is not None}


def _loops(kinematics: Kinematics, edges: list[tuple[int, int]]) -> list[_Loop]:
    """Short loops, the redundant ones with their rows."""
    names = [joint.name for joint in kinematics.joints]
    held = {frozenset(r.joints): r.rows for r in kinematics.mobility.redundancies if r.kind == "loop"}
    out = []
    for block in blocks(len(kinematics.bodies), edges):
        nodes = sorted({n for k in block for n in edges[k]})
        local = {n: i for i, n in enumerate(nodes)}
        for cycle in short_cycles(len(nodes), [(local[edges[k][0]], local[edges[k][1]]) for k in block]):
            members = [block[k] for k, _ in cycle]
            around = tuple(sorted({n for k in members for n in edges[k]}))
            out.append(_Loop(around, held.get(frozenset(names[k] for k in members), 0)))
    return out if len(out) <= LOOPS else []


def _trimmed(start: Array, end: Array, size: Array) -> Array:
    """Where the line from `start` leaves the box of this size around it."""
    way = end - start
    share = np.abs(way) / np.maximum(size / 2, 1e-9)
    return np.asarray(start + way / max(float(share.max()), 1.0))


def _ends(at: Array, sizes: Array, edge: tuple[int, int]) -> tuple[Array, Array]:
    a, b = edge
    return _trimmed(at[a], at[b], sizes[a]), _trimmed(at[b], at[a], sizes[b])


def _middle(at: Array, sizes: Array, edge: tuple[int, int]) -> Array:
    """Where the symbol of the joint stands: half-way, or beside that where a box is in the way."""
    first, second = _ends(at, sizes, edge)
    if len(at) <= CLEARED:
        for share in (0.5, 0.6, 0.4, 0.7, 0.3, 0.8, 0.2):
            place = first + share * (second - first)
            if not (np.abs(at - place) < sizes / 2 + 0.8 * RADIUS).all(axis=1).any():
                return np.asarray(place)
    return np.asarray((first + second) / 2)


def _line(at: Array, edge: tuple[int, int], joint: Joint, sizes: Array) -> str:
    (x1, y1), (x2, y2) = _ends(at, sizes, edge)
    dash = f' stroke-dasharray="{DASHES[joint.status]}"' if joint.status in DASHES else ""
    return f'<line class="joint" x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"{dash}/>'


def _box(name: str, centre: Array, size: Array, ground: bool) -> str:
    x, y = centre - size / 2
    box = f'<rect class="{"ground" if ground else "body"}" x="{x:.1f}" y="{y:.1f}" width="{size[0]:.1f}" height="{size[1]:.1f}" rx="4"/>'
    wide = LETTER * len(name) + 6.0
    plate = (
        f'<rect class="plate" x="{centre[0] - wide / 2:.1f}" y="{centre[1] - 9:.1f}" width="{wide:.1f}" height="18"/>'
    )
    text = f'<text x="{centre[0]:.1f}" y="{centre[1] + 4.5:.1f}" text-anchor="middle">{escape(name)}</text>'
    return box + (plate if ground else "") + text


def _symbol(centre: Array, joint: Joint, drives: bool) -> str:
    x, y = centre
    doubtful = joint.status in DASHES
    fill, ink = ("#2f7d4f", "#fff") if drives else ("#fff", "#223")
    dash = f' stroke-dasharray="{DASHES[joint.status]}"' if doubtful else ""
    return (
        f'<g><title>{escape(one_line(_about(joint)))}</title><circle cx="{x:.1f}" cy="{y:.1f}" r="{RADIUS}" '
        f'fill="{fill}" stroke="#445" stroke-width="1.4"{dash}/><text x="{x:.1f}" y="{y + 4.3:.1f}" '
        f'text-anchor="middle" font-size="12" fill="{ink}">{SYMBOLS[joint.type]}</text></g>'
    )


def _loop_mark(number: int, loop: _Loop, at: Array) -> str:
    x, y = at[list(loop.nodes)].mean(axis=0)
    kind = "held" if loop.rows else "loop"
    return f'<text class="{kind}" x="{x:.1f}" y="{y + 4:.1f}" text-anchor="middle">↻ {number}</text>'


def _legend(kinematics: Kinematics, loops: list[_Loop]) -> Iterator[str]:
    mobility = kinematics.mobility
    used = sorted({joint.type for joint in kinematics.joints}, key=list(SYMBOLS).index)
    yield ", ".join(f"{SYMBOLS[kind]} {kind}" for kind in used) or "no joints"
    marks = ["hatched: ground"]
    marks += ["filled: drives a freedom"] if _drivers(kinematics) else []
    statuses = {joint.status for joint in kinematics.joints}
    marks += [
        text
        for status, text in (("ambiguous", "dashed: ambiguous"), ("blocked", "dotted: blocked"))
        if status in statuses
    ]
    yield ", ".join(marks)
    yield (
        f"{counted(len(kinematics.joints), 'joint')}, mobility {mobility.instantaneous} "
        f"({mobility.idle} idle), Grübler {mobility.gruebler}, {mobility.redundant} redundant"
    )
    for number, loop in enumerate(loops, 1):
        if loop.rows:
            yield f"↻ {number}: {counted(loop.rows, 'row')} too many"

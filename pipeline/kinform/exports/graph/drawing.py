"""The kinematic graph as a drawing: bodies as boxes, joints as lines with their type, loops, and what is ground.

SVG is drawn here, with nothing from outside: as a picture of its own, or as a part of a page that can be pressed. DOT
is for Graphviz and whatever reads its language.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from kinform.exports.graph.layout import box_centres
from kinform.foundation.escapes import html, one_line, quoted
from kinform.foundation.graphs.cycles import short_cycles
from kinform.foundation.graphs.graph import blocks
from kinform.foundation.rounding import SOLVED
from kinform.foundation.words import counted
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.kinematics import Joint, Kinematics

LETTER_WIDTH = 7.3
"""px, of a letter on average: of 13 px sans serif, wide ones included."""
LINE_HEIGHT = 18.0
"""px, of a line of the legend: 1.4 times the size of its letters."""
MARGIN = 30.0
"""px, around the drawing: the radius of a symbol, three times. Chosen by eye."""
EDGE_LENGTH = 105.0
"""px, of a joint between two bodies: its symbol stands clear of both. Chosen by eye."""
SYMBOL_RADIUS = 10.5
"""px, of the circle with the letter of a joint: the letter fits in it. Chosen by eye."""
SYMBOL_PLACES = (0.5, 0.6, 0.4, 0.7, 0.3, 0.8, 0.2)
"""Shares of a joint's line at which its symbol may stand, the best first: from the middle outwards."""
CLEARANCE = 0.8
"""Share of its radius by which a symbol keeps clear of boxes. Chosen by eye."""
MOST_CLEARED = 600
"""Bodies up to which the symbols keep clear of boxes: the search takes bodies times joints. Chosen, not measured."""
MOST_LOOPS = 40
"""Loops up to which they are numbered: more marks cannot be told apart. Chosen by eye."""
MOST_BODIES = 150
"""Bodies of the largest graph in a page: a larger one cannot be read there. Chosen by eye."""
LONGEST_NAME = 30
"""Letters of a name in a page: two thirds of the width of the panel."""
PANEL = (320.0, 470.0)
"""px, width and height of the graph in a page: a column of its layout."""


SYMBOLS = {
    "fixed": "F", "revolute": "R", "prismatic": "P", "cylindrical": "C", "spherical": "S", "planar": "E",
    "screw": "H", "universal": "U", "general": "G",
}  # fmt: skip
DASHES = {"ambiguous": "7 5", "blocked": "2 4", "inferred": "12 3"}


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
        lines.append(f"  {quoted(body.name)}{ground};")
    drivers = _drivers(kinematics)
    for joint in kinematics.joints:
        label = SYMBOLS[joint.type] + (" *" if joint.name in drivers else "")
        style = {"ambiguous": ", style=dashed", "blocked": ", style=dotted"}.get(joint.status, "")
        ends = " -- ".join(quoted(name) for name in joint.bodies)
        lines.append(f"  {ends} [label={quoted(label)}, tooltip={quoted(_about(joint))}{style}];")
    return "\n".join([*lines, "}"]) + "\n"


@dataclass(frozen=True, eq=False)
class _Drawing:
    """Where everything stands: centres and sizes of boxes (n, 2) px, ends of joints, loops."""

    kinematics: Kinematics
    names: list[str]
    sizes: Array
    at: Array
    edges: list[tuple[int, int]]
    loops: list[_Loop]

    @property
    def extent(self) -> Array:
        """(2,) px."""
        return np.asarray((self.at + self.sizes / 2).max(axis=0, initial=0.0) + MARGIN)


def _drawing(kinematics: Kinematics, names: list[str], extra: float, *, upright: bool = False) -> _Drawing:
    """The drawing, with so much room (px) in each box beside its name; `upright`: it grows downwards."""
    index = {body.name: n for n, body in enumerate(kinematics.bodies)}
    edges = [(index[j.bodies[0]], index[j.bodies[1]]) for j in kinematics.joints]
    ground = next((n for n, body in enumerate(kinematics.bodies) if body.ground), 0)
    sizes = np.array([[LETTER_WIDTH * len(name) + extra, 30.0] for name in names]).reshape(-1, 2)
    at = (
        box_centres(sizes[:, ::-1], edges, ground, EDGE_LENGTH)[:, ::-1]
        if upright
        else box_centres(sizes, edges, ground, EDGE_LENGTH)
    )
    return _Drawing(kinematics, names, sizes, at + MARGIN, edges, _loops(kinematics, edges))


def graph_svg(kinematics: Kinematics) -> str:
    """The graph as one SVG: ground hatched, ambiguous joints dashed, drivers of freedoms filled, loops numbered."""
    drawing = _drawing(kinematics, [one_line(body.name) for body in kinematics.bodies], 22.0)
    extent, legend = drawing.extent, graph_legend(kinematics)
    width = max(float(extent[0]), LETTER_WIDTH * max(map(len, legend)) + 2 * MARGIN)
    height = float(extent[1]) + LINE_HEIGHT * len(legend) + MARGIN
    texts = [
        f'<text x="{MARGIN:.0f}" y="{extent[1] + LINE_HEIGHT * (n + 1):.1f}" class="legend">{html(text)}</text>'
        for n, text in enumerate(legend)
    ]
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.1f} {height:.1f}" '
        f'width="{width:.0f}" height="{height:.0f}" font-family="sans-serif" font-size="13">'
    )
    return (
        "\n".join(
            [
                head,
                _STYLE + _HATCH,
                '<rect width="100%" height="100%" fill="#fff"/>',
                *_lines(drawing),
                *texts,
                "</svg>",
            ]
        )
        + "\n"
    )


def graph_panel(kinematics: Kinematics, colours: Sequence[str]) -> str:
    """The graph for a page, whose style it takes: bodies with their colours, each body and joint to be pressed.

    They carry their numbers as data-body and data-joint. Empty where the graph is too large to be read.
    """
    if not 0 < len(kinematics.bodies) <= MOST_BODIES:
        return ""
    names = [one_line(body.name) for body in kinematics.bodies]
    names = [name if len(name) <= LONGEST_NAME else name[: LONGEST_NAME - 1] + "…" for name in names]
    both = [_drawing(kinematics, names, 36.0, upright=upright) for upright in (True, False)]
    drawing = min(both, key=lambda d: float((d.extent / PANEL).max()))
    width, height = drawing.extent
    return (
        f'<svg class="graph" viewBox="0 0 {width:.0f} {height:.0f}" width="{width:.0f}" height="{height:.0f}" '
        f'role="group" aria-label="Kinematic graph">{_HATCH}{"".join(_lines(drawing, colours))}</svg>'
    )


def _lines(drawing: _Drawing, colours: Sequence[str] | None = None) -> list[str]:
    """Joints, bodies over them, then the symbols of joints; with colours each is a button."""
    kinematics, at, sizes = drawing.kinematics, drawing.at, drawing.sizes
    linked, drivers = colours is not None, _drivers(kinematics)
    pairs = list(zip(drawing.edges, kinematics.joints, strict=True))
    lines = [_line(at, edge, joint, sizes) for edge, joint in pairs]
    symbols = [_symbol(_middle(at, sizes, edge), joint, joint.name in drivers) for edge, joint in pairs]
    marks = [_loop_mark(n, loop, at) for n, loop in enumerate(drawing.loops, 1)]
    boxes = []
    for k, body in enumerate(kinematics.bodies):
        box = _box(drawing.names[k], at[k], sizes[k], body.ground, "" if colours is None else colours[k])
        about = f"Body {body.name}{', ground' if body.ground else ''}: {', '.join(body.parts)}"
        boxes.append(_button("node", "body", k, about, box) if linked else box)
    if not linked:
        return [*lines, *boxes, *symbols, *marks]
    joints = [
        _button("link", "joint", k, f"Joint {_about(joint)}", lines[k] + symbols[k])
        for k, joint in enumerate(kinematics.joints)
    ]
    return [*joints, *boxes, *marks]


def _button(kind: str, data: str, number: int, about: str, drawn: str) -> str:
    label = html(about)
    return f'<g class="{kind}" role="button" tabindex="0" data-{data}="{number}" aria-label="{label}">{drawn}</g>'


_STYLE = """<style>
.joint { stroke: #445; stroke-width: 1.6; fill: none }
.body { fill: #fff; stroke: #223; stroke-width: 1.4 }
.ground { fill: url(#hatch); stroke: #223; stroke-width: 2.2 }
.plate { fill: #fff }
.legend { fill: #333; font-size: 12px }
.loop { fill: #1b6ca8; font-size: 12px }
.held { fill: #b3541e; font-size: 12px }
.symbol { fill: #fff; stroke: #445; stroke-width: 1.4 }
.symbol.drives { fill: #2f7d4f }
.letter { fill: #223; font-size: 12px }
.drives + .letter { fill: #fff }
</style>
"""
_HATCH = (
    '<defs><pattern id="hatch" width="7" height="7" patternUnits="userSpaceOnUse" patternTransform="rotate(45)">'
    '<line x1="0" y1="0" x2="0" y2="7" stroke="#889" stroke-width="2.4"/></pattern></defs>'
)


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
    return out if len(out) <= MOST_LOOPS else []


def _trimmed(start: Array, end: Array, size: Array) -> Array:
    """Where the line from `start` leaves the box of this size around it."""
    way = end - start
    share = np.abs(way) / np.maximum(size / 2, SOLVED)
    return np.asarray(start + way / max(float(share.max()), 1.0))


def _ends(at: Array, sizes: Array, edge: tuple[int, int]) -> tuple[Array, Array]:
    a, b = edge
    return _trimmed(at[a], at[b], sizes[a]), _trimmed(at[b], at[a], sizes[b])


def _middle(at: Array, sizes: Array, edge: tuple[int, int]) -> Array:
    """Where the symbol of the joint stands: half-way, or beside that where a box is in the way."""
    first, second = _ends(at, sizes, edge)
    if len(at) <= MOST_CLEARED:
        for share in SYMBOL_PLACES:
            place = first + share * (second - first)
            if not (np.abs(at - place) < sizes / 2 + CLEARANCE * SYMBOL_RADIUS).all(axis=1).any():
                return np.asarray(place)
    return np.asarray((first + second) / 2)


def _line(at: Array, edge: tuple[int, int], joint: Joint, sizes: Array) -> str:
    (x1, y1), (x2, y2) = _ends(at, sizes, edge)
    dash = f' stroke-dasharray="{DASHES[joint.status]}"' if joint.status in DASHES else ""
    return f'<line class="joint" x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"{dash}/>'


def _box(name: str, centre: Array, size: Array, ground: bool, colour: str = "") -> str:
    x, y = centre - size / 2
    frame = f'x="{x:.1f}" y="{y:.1f}" width="{size[0]:.1f}" height="{size[1]:.1f}" rx="4"'
    box = f'<rect class="body" {frame}/>'
    wide = LETTER_WIDTH * len(name) + 6.0
    if ground:
        plate = f'x="{centre[0] - wide / 2:.1f}" y="{centre[1] - 9:.1f}" width="{wide:.1f}" height="18"'
        box += f'<rect class="ground" {frame}/><rect class="plate" {plate}/>'
    shift = 7.0 if colour else 0.0
    if colour:
        corner = f'x="{x + 8:.1f}" y="{centre[1] - 5:.1f}"'
        box += f'<rect class="swatch" fill="{colour}" {corner} width="10" height="10" rx="2"/>'
    return box + f'<text x="{centre[0] + shift:.1f}" y="{centre[1] + 4.5:.1f}" text-anchor="middle">{html(name)}</text>'


def _symbol(centre: Array, joint: Joint, drives: bool) -> str:
    x, y = centre
    dash = f' stroke-dasharray="{DASHES[joint.status]}"' if joint.status in DASHES else ""
    return (
        f'<g><title>{html(_about(joint))}</title><circle class="symbol{" drives" if drives else ""}" '
        f'cx="{x:.1f}" cy="{y:.1f}" r="{SYMBOL_RADIUS}"{dash}/>'
        f'<text class="letter" x="{x:.1f}" y="{y + 4.3:.1f}" text-anchor="middle">{SYMBOLS[joint.type]}</text></g>'
    )


def _loop_mark(number: int, loop: _Loop, at: Array) -> str:
    x, y = at[list(loop.nodes)].mean(axis=0)
    kind = "held" if loop.rows else "loop"
    return f'<text class="{kind}" x="{x:.1f}" y="{y + 4:.1f}" text-anchor="middle">↻ {number}</text>'


def graph_legend(kinematics: Kinematics) -> list[str]:
    """What the letters and strokes of a drawing mean, and its counts, in lines."""
    index = {body.name: n for n, body in enumerate(kinematics.bodies)}
    edges = [(index[j.bodies[0]], index[j.bodies[1]]) for j in kinematics.joints]
    return list(_legend(kinematics, _loops(kinematics, edges)))


def _legend(kinematics: Kinematics, loops: list[_Loop]) -> Iterator[str]:
    mobility = kinematics.mobility
    types = sorted({joint.type for joint in kinematics.joints}, key=list(SYMBOLS).index)
    yield ", ".join(f"{SYMBOLS[kind]} {kind}" for kind in types) or "no joints"
    marks = ["hatched: ground"]
    marks += ["filled: drives a freedom"] if _drivers(kinematics) else []
    statuses = {joint.status for joint in kinematics.joints}
    strokes = {"ambiguous": "dashed: ambiguous", "blocked": "dotted: blocked", "inferred": "long dashes: inferred"}
    marks += [text for status, text in strokes.items() if status in statuses]
    yield ", ".join(marks)
    yield (
        f"{counted(len(kinematics.joints), 'joint')}, mobility {mobility.instantaneous} "
        f"({mobility.idle} idle), Grübler {mobility.gruebler}, {mobility.redundant} redundant"
    )
    for number, loop in enumerate(loops, 1):
        if loop.rows:
            yield f"↻ {number}: {counted(loop.rows, 'row')} too many"

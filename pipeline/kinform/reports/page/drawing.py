"""The kinematic graph as SVG: bodies in rows by their distance from ground, joints as lines with a letter.

Bodies and joints carry their numbers, by which the viewer links them to what it shows.
"""

from __future__ import annotations

from html import escape

from kinform.kinematics.graph import forest
from kinform.model.kinematics import Joint, Kinematics

__all__ = ["LETTERS", "MOST", "graph_drawing"]

LETTERS = {
    "fixed": "F", "revolute": "R", "prismatic": "P", "cylindrical": "C", "spherical": "S", "planar": "E",
    "screw": "H", "universal": "U", "general": "G",
}  # fmt: skip
MOST = 150
"""Bodies of the largest graph that is drawn."""
LETTER, BOX, ROW, GAP, LONGEST = 7.0, 30.0, 82.0, 26.0, 26
"""Width of a letter, height of a box, of a row, space between boxes (px); letters of a name."""
DASHES = {"ambiguous": "6 4", "blocked": "2 4", "inferred": "10 3"}


def graph_drawing(kinematics: Kinematics, colours: list[str]) -> str:
    """The SVG; empty where the graph is too large to be read."""
    bodies = kinematics.bodies
    if not bodies or len(bodies) > MOST:
        return ""
    number = {body.name: k for k, body in enumerate(bodies)}
    edges = [(number[j.bodies[0]], number[j.bodies[1]]) for j in kinematics.joints]
    ground = next((k for k, body in enumerate(bodies) if body.ground), 0)
    rows = _rows(len(bodies), edges, ground)
    names = [name if len(name) <= LONGEST else name[: LONGEST - 1] + "…" for name in (b.name for b in bodies)]
    wide = [LETTER * len(name) + 30.0 for name in names]
    spans = [sum(wide[k] + GAP for k in row) - GAP for row in rows]
    width = max(max(spans), 200.0) + 24.0
    at: dict[int, tuple[float, float]] = {}
    for level, (row, span) in enumerate(zip(rows, spans, strict=True)):
        x = (width - span) / 2
        for k in row:
            at[k] = (x + wide[k] / 2, 26.0 + ROW * level)
            x += wide[k] + GAP
    height = 26.0 + ROW * (len(rows) - 1) + 34.0
    drawn = [
        _joint(k, joint, at[edges[k][0]], at[edges[k][1]], _twins(edges, k))
        for k, joint in enumerate(kinematics.joints)
    ]
    for k, body in enumerate(bodies):
        x, y = at[k]
        ground_mark = f'<path class="earth" d="{_earth(x, y + BOX / 2, wide[k])}"/>' if body.ground else ""
        about = f"Body {body.name}{', ground' if body.ground else ''}: {', '.join(body.parts)}"
        drawn.append(
            f'<g class="node" role="button" tabindex="0" data-body="{k}" aria-label="{escape(about)}"><title>{escape(about)}</title>'
            f'<rect x="{x - wide[k] / 2:.1f}" y="{y - BOX / 2:.1f}" width="{wide[k]:.1f}" height="{BOX}" rx="5"/>'
            f'<rect class="swatch" fill="{colours[k]}" x="{x - wide[k] / 2 + 7:.1f}" y="{y - 5:.1f}" width="10" height="10" rx="2"/>'
            f'{ground_mark}<text x="{x + 8:.1f}" y="{y + 4.5:.1f}" text-anchor="middle">{escape(names[k])}</text></g>'
        )
    return (
        f'<svg class="graph" viewBox="0 0 {width:.0f} {height:.0f}" width="{width:.0f}" height="{height:.0f}" '
        f'role="group" aria-label="Kinematic graph">{"".join(drawn)}</svg>'
    )


def _rows(count: int, edges: list[tuple[int, int]], ground: int) -> list[list[int]]:
    """Bodies by their distance from the root of their tree, each row in the order of its parents."""
    tree = forest(count, edges, ground)
    level: dict[int, int] = {}
    rows: list[list[int]] = []
    for node in tree.order:
        level[node] = level[tree.parent[node]] + 1 if tree.parent[node] >= 0 else 0
        if level[node] == len(rows):
            rows.append([])
        rows[level[node]].append(node)
    return rows


def _twins(edges: list[tuple[int, int]], k: int) -> int:
    return sum(set(edge) == set(edges[k]) for edge in edges[:k])


def _joint(k: int, joint: Joint, a: tuple[float, float], b: tuple[float, float], twin: int) -> str:
    flat = abs(a[1] - b[1]) < 1.0
    far = abs(a[1] - b[1]) > 1.5 * ROW
    bend = 30.0 * twin + (34.0 if flat else 0.0)
    x, y = (a[0] + b[0]) / 2, (a[1] + b[1]) / 2
    cx, cy = (x + (90.0 if far else 0.0) + (0.0 if flat else bend), y + (bend if flat else 0.0))
    mx, my = (x + cx) / 2, (y + cy) / 2
    dash = f' stroke-dasharray="{DASHES[joint.status]}"' if joint.status in DASHES else ""
    about = f"Joint {joint.name}: {joint.type}, {joint.status}"
    return (
        f'<g class="link" role="button" tabindex="0" data-joint="{k}" aria-label="{escape(about)}"><title>{escape(about)}</title>'
        f'<path d="M{a[0]:.1f} {a[1]:.1f}Q{cx:.1f} {cy:.1f} {b[0]:.1f} {b[1]:.1f}"{dash}/>'
        f'<circle cx="{mx:.1f}" cy="{my:.1f}" r="11"{dash}/>'
        f'<text x="{mx:.1f}" y="{my + 4:.1f}" text-anchor="middle">{LETTERS[joint.type]}</text></g>'
    )


def _earth(x: float, y: float, width: float) -> str:
    """Short strokes under a box, as fixed parts are drawn."""
    left, count = x - width / 2 + 8, int((width - 8) // 9)
    return "".join(f"M{left + 9 * k:.1f} {y:.1f}l-5 6" for k in range(count))

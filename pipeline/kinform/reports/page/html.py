"""The page: one HTML file with everything in it, opened from disk, printable, light and dark.

Whatever a user named is escaped: by jinja2 in the text, by `escape` in drawings, and in JSON by writing < as an
escape. The page's own program is the only one that a browser may run in it (content security policy).
"""

from __future__ import annotations

import base64
import hashlib
import json
from functools import cache
from importlib.resources import files

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from kinform.design import Design
from kinform.exports.graph.drawing import graph_legend, graph_panel
from kinform.reports.constants import FIT_COLOURS, MOST_PICTURES
from kinform.reports.page import agreement, facts
from kinform.reports.page.pictures import Artist
from kinform.reports.page.plots import plot_groups
from kinform.reports.page.scene import Scene
from kinform.reports.page.scene_data import embedded_scene
from kinform.version import __version__


def page_html(design: Design, scene: Scene | None = None) -> str:
    """The report of a design as HTML; `scene` where it was made already."""
    scene = scene or Scene(design)
    embedded, blob = embedded_scene(scene)
    program = _asset_program()
    digest = base64.b64encode(hashlib.sha256(program.encode()).digest()).decode("ascii")
    findings = facts.findings(design)
    artist = Artist(scene)
    pictures = {f.index: _data(artist.finding(f.index)) for f in findings[:MOST_PICTURES]}
    template = _environment().from_string(_asset("page.html.j2"))
    return template.render(
        version=__version__,
        design=design,
        name=design.assembly.name,
        verdict=facts.verdict_of(design),
        agreement=agreement.rows(design),
        findings=findings,
        pictures={k: Markup(url) for k, url in pictures.items()},
        joints=facts.joints(design),
        assumed=facts.assumptions(design),
        rules=facts.rules(design),
        bodies=[
            (k, body, colour, [(n, p.name) for n, p in enumerate(design.assembly.parts) if p.name in body.parts])
            for k, (body, colour) in enumerate(zip(scene.bodies, scene.colours, strict=True))
        ],
        facets=sum(len(p.mesh.faces) for p in design.assembly.parts if p.mesh is not None),
        fits=FIT_COLOURS,
        has_overlaps=bool(embedded["overlaps"]),
        motions=embedded["motions"],
        graph=Markup("" if design.kinematics is None else graph_panel(design.kinematics, scene.colours)),
        legend=[] if design.kinematics is None else graph_legend(design.kinematics),
        plots=[(heading, [Markup(svg) for svg in drawn], left) for heading, drawn, left in plot_groups(design)],
        overview=Markup(_data(artist.overview(800, 500))),
        style=Markup(_asset("page.css")),
        program=Markup(program),
        digest=digest,
        scene=Markup(json.dumps(embedded, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")),
        blob=Markup(blob),
    )


@cache
def _environment() -> Environment:
    return Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)


def _asset(name: str) -> str:
    return files("kinform.reports.page").joinpath("assets", name).read_text(encoding="utf-8")


@cache
def _asset_program() -> str:
    """The viewer's files in their order, as one program of its own."""
    folder = files("kinform.reports.page").joinpath("assets", "viewer")
    names = sorted((f.name for f in folder.iterdir() if f.name.endswith(".js")), key=lambda n: int(n.split("-")[0]))
    texts = [folder.joinpath(name).read_text(encoding="utf-8").strip() for name in names]
    return "\n(() => {\n'use strict';\n\n" + "\n\n".join(texts) + "\n})();\n"


def _data(png: bytes) -> str:
    return "data:image/png;base64," + base64.b64encode(png).decode("ascii")

"""The page: one HTML file with everything in it, opened from disk, printable, light and dark.

Whatever a user named is escaped: by jinja2 in the text, by `escape` in drawings, and in JSON by writing < as an
escape. The page's own program is the only one that a browser may run in it (content security policy).
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from importlib.resources import files
from typing import Any

from jinja2 import Environment, FunctionLoader, StrictUndefined
from markupsafe import Markup, escape

from kinform.design import Design
from kinform.exports.graph.drawing import graph_legend, graph_panel
from kinform.foundation.escapes import harmless
from kinform.model.kinematics import Body
from kinform.reports.page import agreement, facts, intended
from kinform.reports.page.pictures import MOST_PICTURES, Artist
from kinform.reports.page.plots import plot_groups
from kinform.reports.page.scene import Scene
from kinform.reports.page.scene_data import FIT_COLOURS, embedded_scene
from kinform.version import __version__


def page_html(design: Design, artist: Artist | None = None, live: str = "") -> str:
    """The report of a design as HTML; `artist` where one has drawn of it already.

    A page with a `live` number asks the server that it came from whether there is a newer one.
    """
    artist = artist or Artist(Scene(design))
    scene = artist.scene
    embedded, blob = embedded_scene(scene)
    findings = facts.findings(design)
    worst = [finding for finding in findings[:MOST_PICTURES] if finding.severity != "note"]
    pictures = {f.index: image_url(artist.finding(f.index)) for f in worst}
    table = sorted(agreement.rows(design), key=lambda row: agreement.ORDER.index(row.mark))
    answered = intended.answer_rows(design)
    rules = facts.rules(design)
    template = environment().get_template("page.html.j2")
    return template.render(
        **frame(embedded, blob),
        design=design,
        name=design.assembly.name,
        verdict=facts.verdict_of(design),
        live=live,
        agreement=table,
        agreement_counts=_counts((row.mark for row in table), agreement.ORDER),
        answers=answered,
        answer_counts=_counts((row.answer for row in answered), intended.ORDER),
        findings=findings,
        pictures=pictures,
        joints=facts.joints(design),
        proposed=list(enumerate(scene.proposed, len(scene.movements))),
        assumed=facts.assumptions(design),
        rules=rules,
        undecided=[rule for rule in rules if rule.outcome == "inconclusive"],
        bodies=_bodies(design, scene),
        titles={str(body.name): scene.titles.get(body.name, "") for body in scene.bodies},
        facets=sum(len(p.mesh.faces) for p in design.assembly.parts if p.mesh is not None),
        graph=Markup("" if design.kinematics is None else graph_panel(design.kinematics, scene.colours)),
        legend=[] if design.kinematics is None else graph_legend(design.kinematics),
        plots=[(heading, [Markup(svg) for svg in drawn], left) for heading, drawn, left in plot_groups(design)],
        overview=image_url(artist.overview()),
    )


def _bodies(design: Design, scene: Scene) -> list[tuple[int, Body, str, list[tuple[int, str, str]]]]:
    """Number, body, colour and parts of each body; a part with its number, its name, and where else it could be."""
    members = () if design.kinematics is None else design.kinematics.membership
    doubts = {m.part: f"or of {m.other}" if m.other else "or elsewhere" for m in members if m.either}
    numbers = {part.name: n for n, part in enumerate(design.assembly.parts)}
    return [
        (k, body, colour, [(n, str(p), doubts.get(p, "")) for n, p in sorted((numbers[p], p) for p in body.parts)])
        for k, (body, colour) in enumerate(zip(scene.bodies, scene.colours, strict=True))
    ]


def _counts(kinds: Iterable[str], order: Sequence[str]) -> str:
    """ "1 disagrees, 12 agree", in this order."""
    found = Counter(kinds)
    told = ((found[kind], MANY.get(kind, kind) if found[kind] > 1 else kind) for kind in order if found[kind])
    return ", ".join(f"{count} {words}" for count, words in told)


MANY = {"agrees": "agree", "disagrees": "disagree", "contradicts": "contradict"}
"""What several rows do."""


@cache
def environment() -> Environment:
    """The templates among the assets; `ticks` sets what stands between backticks as code."""
    made = Environment(
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        loader=FunctionLoader(_asset),
        finalize=_shown,
    )
    made.filters["ticks"] = _ticks
    return made


def frame(drawn: Mapping[str, Any], blob: str) -> dict[str, Any]:
    """What every page with a view holds: style, program with its hash, the scene as JSON, and its numbers."""
    program = _asset_program()
    return {
        "version": __version__,
        "style": Markup(_asset("page.css")),
        "program": Markup(program),
        "digest": base64.b64encode(hashlib.sha256(program.encode()).digest()).decode("ascii"),
        "scene": Markup(json.dumps(drawn, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")),
        "blob": Markup(blob),
        "fits": FIT_COLOURS,
        "has_overlaps": bool(drawn["overlaps"]),
        "has_colours": any(part.get("colour") for part in drawn["parts"]),
        "motions": drawn["motions"],
    }


def image_url(png: bytes) -> Markup:
    """The picture as an address that holds it."""
    return Markup("data:image/png;base64," + base64.b64encode(png).decode("ascii"))


def _shown(value: Any) -> Any:
    """What a template writes: of texts of strangers control characters and direction marks are escaped."""
    return harmless(value) if type(value) is str else value


def _ticks(text: str) -> Markup:
    """The text, escaped, with what stands between backticks set as code."""
    return Markup(re.sub(r"`([^`]+)`", r"<code>\1</code>", str(escape(harmless(text)))))


def _asset(name: str) -> str:
    return files("kinform.reports.page").joinpath("assets", name).read_text(encoding="utf-8")


@cache
def _asset_program() -> str:
    """The viewer's files in their order, as one program of its own."""
    folder = files("kinform.reports.page").joinpath("assets", "viewer")
    names = sorted((f.name for f in folder.iterdir() if f.name.endswith(".js")), key=lambda n: int(n.split("-")[0]))
    texts = [folder.joinpath(name).read_text(encoding="utf-8").strip() for name in names]
    return "\n(() => {\n'use strict';\n\n" + "\n\n".join(texts) + "\n})();\n"

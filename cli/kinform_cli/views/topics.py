"""What `kinform show` prints for people: the topics, one module each, in the order of the pipeline, and all in short.

The JSON is `kinform.reports.summary_json`.
"""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

from rich.console import RenderableType
from rich.text import Text

from kinform.design import Design
from kinform.foundation.words import counted
from kinform.model.findings import SEVERITIES
from kinform.reports.values.topics import TOPICS, require
from kinform_cli.shortened import Shortened
from kinform_cli.tables import stacked
from kinform_cli.text import command


def _view(topic: str) -> Any:
    """The module that shows a topic, imported now: few are needed in one command."""
    return importlib.import_module(f"kinform_cli.views.{topic}")


def render(design: Design, topic: str | None, source: str | Path) -> RenderableType:
    """The topic for people, or all in short; raises StageError where its stage has not run.

    `source` is the file of the design, for commands that are suggested.
    """
    if topic is None:
        return _overview(design, source)
    require(design, topic)
    view: RenderableType = _view(topic).render(design)
    return view


def render_joint(design: Design, name: str) -> RenderableType:
    """All the evidence of one joint; raises StageError, or KeyError for a name that no joint has."""
    require(design, "joints")
    view: RenderableType = _view("evidence").render(design, name)
    return view


def _overview(design: Design, source: str | Path) -> RenderableType:
    """Tree, joints, mobility, masses of the bodies, the beginning of each where it is long, one line each for the rest,
    and what has not been computed yet."""

    def short(item: RenderableType, topic: str) -> RenderableType:
        return Shortened(item, f"`{command('kinform', 'show', source, topic)}`")

    items: list[RenderableType] = [short(_view("assembly").render(design, short=True), "assembly"), ""]
    if design.contact_counts is not None:
        patches, overlaps = design.contact_counts
        items += [f"{counted(patches, 'contact patch', 'contact patches')}, {counted(overlaps, 'overlap')}", ""]
    if design.kinematics is not None:
        items += [
            short(_view("joints").render(design, short=True), "joints"),
            "",
            short(_view("mobility").render(design, short=True), "mobility"),
            "",
        ]
    if design.mass is not None:
        items += [short(_view("mass").bodies(design, short=True), "mass"), ""]
    if design.simulation is not None:
        items.append(_view("simulation").headline(design.simulation))
    if design.report is not None:
        severities = [finding.severity for finding in design.report.findings]
        numbers = [counted(severities.count(severity), severity) for severity in reversed(SEVERITIES)]
        undecided = (
            f", {counted(design.report.inconclusive, 'rule')} inconclusive" if design.report.inconclusive else ""
        )
        items.append(f"Findings: {', '.join(numbers)}{undecided}")
    missing = dict.fromkeys(topic.command for topic in TOPICS.values() if not topic.computed(design))
    if missing:
        items.append(Text(f"Not computed yet: kinform {', '.join(missing)}", style="yellow"))
    return stacked(*items)

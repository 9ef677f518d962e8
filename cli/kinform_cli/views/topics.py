"""What `kinform show` prints for people: the topics, one module each, in the order of the pipeline, and all in short.

The JSON is `kinform.reports.summary_json`.
"""

from __future__ import annotations

from pathlib import Path

from rich.console import RenderableType
from rich.text import Text

from kinform.design import Design
from kinform.foundation.words import counted
from kinform.model.findings import SEVERITIES
from kinform.reports.values.topics import TOPICS, require
from kinform_cli.shortened import Shortened
from kinform_cli.tables import stacked
from kinform_cli.text import command
from kinform_cli.views import (
    assembly,
    behaviour,
    bodies,
    contacts,
    evidence,
    findings,
    joints,
    mass,
    mobility,
    simulation,
)

VIEWS = {
    "assembly": assembly, "contacts": contacts, "joints": joints, "bodies": bodies, "mobility": mobility, "mass": mass,
    "behaviour": behaviour, "simulation": simulation, "findings": findings,
}  # fmt: skip
"""The module that shows a topic."""


def render(design: Design, topic: str | None, source: str | Path) -> RenderableType:
    """The topic for people, or all in short; raises StageError where its stage has not run.

    `source` is the file of the design, for commands that are suggested.
    """
    if topic is None:
        return _overview(design, source)
    require(design, topic)
    view: RenderableType = VIEWS[topic].render(design)
    return view


def render_joint(design: Design, name: str) -> RenderableType:
    """All the evidence of one joint; raises StageError, or KeyError for a name that no joint has."""
    require(design, "joints")
    return evidence.render(design, name)


def _overview(design: Design, source: str | Path) -> RenderableType:
    """Tree, joints, mobility, masses of the bodies, the beginning of each where it is long, one line each for the rest,
    and what has not been computed yet."""

    def short(item: RenderableType, topic: str) -> RenderableType:
        return Shortened(item, f"`{command('kinform', 'show', source, topic)}`")

    items: list[RenderableType] = [short(assembly.render(design), "assembly"), ""]
    if design.contacts is not None:
        patches = counted(len(design.contacts.patches), "contact patch", "contact patches")
        items += [f"{patches}, {counted(len(design.contacts.interferences), 'overlap')}", ""]
    if design.kinematics is not None:
        items += [short(joints.render(design), "joints"), "", short(mobility.render(design), "mobility"), ""]
    if design.mass is not None:
        items += [short(mass.bodies(design), "mass"), ""]
    if design.simulation is not None:
        items.append(simulation.headline(design.simulation))
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

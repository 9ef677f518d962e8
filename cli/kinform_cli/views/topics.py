"""What `kinform show` prints for people: the topics, one module each, in the order of the pipeline, and all in short.

The JSON is `kinform.reports.summary_json`.
"""

from __future__ import annotations

from rich.console import RenderableType
from rich.text import Text

from kinform.design import Design
from kinform.foundation.words import counted
from kinform.model.findings import SEVERITIES
from kinform.reports.values.topics import TOPICS, require
from kinform_cli.tables import stacked
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


def render(design: Design, topic: str | None) -> RenderableType:
    """The topic for people, or all in short; raises StageError where its stage has not run."""
    if topic is None:
        return _overview(design)
    require(design, topic)
    view: RenderableType = VIEWS[topic].render(design)
    return view


def render_joint(design: Design, name: str) -> RenderableType:
    """All the evidence of one joint; raises StageError, or KeyError for a name that no joint has."""
    require(design, "joints")
    return evidence.render(design, name)


def _overview(design: Design) -> RenderableType:
    """Tree, joints, mobility, masses of the bodies, one line each for the rest, and what has not been computed yet."""
    items: list[RenderableType] = [assembly.render(design), ""]
    if design.contacts is not None:
        patches = counted(len(design.contacts.patches), "contact patch", "contact patches")
        items += [f"{patches}, {counted(len(design.contacts.interferences), 'overlap')}", ""]
    if design.kinematics is not None:
        items += [joints.render(design), "", mobility.render(design), ""]
    if design.mass is not None:
        items += [mass.bodies(design), ""]
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

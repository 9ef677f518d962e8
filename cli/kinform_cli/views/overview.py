"""Everything in short: the assembly, its joints, mobility and mass, and what has not been computed yet."""

from __future__ import annotations

from rich.console import RenderableType
from rich.text import Text

from kinform.design import Design
from kinform.model.findings import SEVERITIES
from kinform_cli.tables import stacked
from kinform_cli.text import count
from kinform_cli.views import assembly, joints, mass, mobility, simulation
from kinform_cli.views.topics import TOPICS

__all__ = ["render"]


def render(design: Design) -> RenderableType:
    """Tree, joints, mobility, masses of the bodies, and one line each for the rest."""
    items: list[RenderableType] = [assembly.render(design), ""]
    if design.contacts is not None:
        patches = count(len(design.contacts.patches), "contact patch", "contact patches")
        items += [f"{patches}, {count(len(design.contacts.interferences), 'overlap')}", ""]
    if design.kinematics is not None:
        items += [joints.render(design), "", mobility.render(design), ""]
    if design.mass is not None:
        items += [mass.bodies(design), ""]
    if design.simulation is not None:
        items.append(simulation.headline(design.simulation))
    if design.report is not None:
        severities = [finding.severity for finding in design.report.findings]
        numbers = [count(severities.count(severity), severity) for severity in reversed(SEVERITIES)]
        undecided = f", {count(design.report.inconclusive, 'rule')} inconclusive" if design.report.inconclusive else ""
        items.append(f"Findings: {', '.join(numbers)}{undecided}")
    missing = dict.fromkeys(topic.command for topic in TOPICS.values() if not topic.known(design))
    if missing:
        items.append(Text(f"Not computed yet: kinform {', '.join(missing)}", style="yellow"))
    return stacked(*items)

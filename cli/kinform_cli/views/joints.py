"""Bodies and joints, and why a joint is not plainly determined."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.text import Text

from kinform.model.design import Design
from kinform.model.kinematics import Joint, Kinematics
from kinform_cli.tables import Rows
from kinform_cli.text import Lengths, count, number, vector

__all__ = ["ground_note", "render"]


def _known(design: Design) -> Kinematics:
    assert design.kinematics is not None
    return design.kinematics


def render(design: Design) -> RenderableType:
    """One row a joint, then why a joint is not plainly determined, then the bodies of several parts."""
    kinematics, lengths = _known(design), Lengths.of(design.assembly)
    title = f"{count(len(kinematics.joints), 'joint')} between {count(len(kinematics.bodies), 'body', 'bodies')}"
    rows = Rows(
        "name",
        "type",
        "axis",
        f"point {lengths.unit}",
        "free",
        "status",
        "evidence",
        title=title,
        right=["free"],
    )
    for joint in kinematics.joints:
        rows.add(
            joint.name,
            joint.type if joint.pitch is None else f"{joint.type} ({lengths.length(joint.pitch)} {lengths.unit}/turn)",
            vector(joint.axis) if joint.axis2 is None else f"{vector(joint.axis)}; {vector(joint.axis2)}",
            lengths.point(joint.point),
            str(joint.freedoms),
            joint.status,
            ", ".join(joint.evidence),
        )
    items: list[RenderableType] = [rows]
    for joint in kinematics.joints:
        if joint.status != "determined":
            items += _doubt(joint, lengths)
    items += _bodies(kinematics)
    note = ground_note(design)
    if note is not None:
        items.append(note)
    return Group(*items)


def ground_note(design: Design) -> str | None:
    """Which body was taken as the ground, where the manifest does not say."""
    if design.assembly.ground is not None:
        return None
    chosen = [body.name for body in _known(design).bodies if body.ground]
    return f"note: no ground is stated: {', '.join(chosen)} is taken, as the heaviest (else the largest) body"


def _doubt(joint: Joint, lengths: Lengths) -> list[RenderableType]:
    lines: list[RenderableType] = [Text(f"\n{joint.name} is {joint.status}: {joint.reason}")]
    if joint.status == "ambiguous":
        lines.append(f"  singular values: {', '.join(number(float(value)) for value in joint.singular_values)}")
    for blocker in joint.blockers:
        extent = f"{lengths.area(blocker.area)} {lengths.unit}², {100 * blocker.share:.2g} % of the contact"
        lines.append(
            f"  {' and '.join(blocker.parts)}, patch {blocker.patch} ({extent}) at "
            f"({lengths.point(blocker.place)}) {lengths.unit}: forbids {blocker.forbids}"
        )
    return lines


def _bodies(kinematics: Kinematics) -> list[RenderableType]:
    bodies = [body for body in kinematics.bodies if body.ground or len(body.parts) > 1]
    if not bodies:
        return []
    lines: list[RenderableType] = [Text("\nBodies", style="bold")]
    for body in bodies:
        ground = " (ground)" if body.ground else ""
        merged = f"  [{'; '.join(body.merged)}]" if body.merged else ""
        lines.append(f"  {body.name}{ground}: {', '.join(body.parts)}{merged}")
    return lines

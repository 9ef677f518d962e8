"""Bodies and joints, and why a joint is not plainly determined."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.console import RenderableType
from rich.text import Text

from kinform.design import Design
from kinform.foundation.words import counted
from kinform.frozen import dataclass
from kinform.function import Resolution, joint_as_stated, range_as_stated, resolve_joint
from kinform.function.body_titles import body_titles
from kinform.model.collisions import JointRange
from kinform.model.kinematics import Joint, Kinematics, Release
from kinform.reports.phrases import answers_line
from kinform_cli.shortened import beginning
from kinform_cli.tables import Rows, stacked
from kinform_cli.text import NONE, Lengths, degrees, ground_note, singular, vector

if TYPE_CHECKING:
    from kinform.consistency.comparisons.answers import Answer


def render(design: Design, *, short: bool = False) -> RenderableType:
    """One row a joint, then why a joint is not plainly determined, then the bodies of several parts; with `short` no
    more rows than can be shown of it."""
    kinematics, lengths = design.kinematics, Lengths.of(design.assembly)
    assert kinematics is not None
    title = f"{counted(len(kinematics.joints), 'joint')} between {counted(len(kinematics.bodies), 'body', 'bodies')}"
    ranged = design.simulation is not None and bool(design.simulation.ranges)
    given = _answers(design) if design.assembly.function.joints else ()
    meant: dict[str, list[str]] = {}
    for one in sorted(given, key=lambda one: one.name.count("/")):
        if one.joint is not None:
            meant.setdefault(one.joint, []).append(one.name)
    headings = ("type", "axis", f"point {lengths.unit}", "free", "status")
    rows = Rows(
        "name",
        *(["intended"] if meant else []),
        *headings,
        *(["range"] if ranged else []),
        "evidence",
        title=title,
        right=["free"],
        names=["name"],
        texts=["evidence"],
    )
    others: list[str] = []
    for joint in beginning(kinematics.joints, short):
        names = meant.get(joint.name, [])
        seen = [*named(design, joint, names, lengths), Seen.of(design, Resolution.own(joint), lengths)]
        shown = seen[0]
        rows.add(
            joint.name,
            *([", ".join(names) or NONE] if meant else []),
            joint.type if joint.pitch is None else f"{joint.type} ({lengths.length(joint.pitch)} {lengths.small}/turn)",
            shown.axis,
            lengths.point(joint.point),
            str(joint.freedoms),
            joint.status,
            *([shown.range] if ranged else []),
            ", ".join(joint.evidence),
        )
        others += [f"  {one.name}: {one.words}" for one in seen if one.sense != shown.sense]
    items: list[RenderableType] = [rows]
    items += [Text("\nThe same joints by their other names", style="bold"), *others] if others else []
    items += _intended(design, given, lengths)
    items += _leaving(kinematics, short)
    for joint in beginning([joint for joint in kinematics.joints if joint.status != "determined"], short):
        items += _doubt(joint, lengths)
    items += [Text(f"\n{j.name}: {j.motion}") for j in kinematics.joints if j.type == "general" and j.motion]
    items += _bodies(design)
    note = ground_note(design)
    if note is not None:
        items.append(note)
    return stacked(*items)


def _answers(design: Design) -> Sequence[Answer]:
    from kinform.consistency.comparisons.answers import answers

    return answers(design)


def _intended(design: Design, given: Sequence[Answer], lengths: Lengths) -> list[RenderableType]:
    """The answer to each intended joint."""
    if not given:
        return []
    from kinform.consistency.comparisons.answers import answer_counts

    title = f"\nIntended joints: {answers_line(answer_counts(one.answer for one in given))}"
    rows = Rows("intended", "type", "answer", "because", title=title, names=["intended"], texts=["because"])
    for one in given:
        gap = "" if one.gap is None else f"gap {lengths.length(one.gap)} {lengths.small}"
        rows.add(one.name, one.type, one.answer, one.free or one.blocked_by or gap)
    sides = () if design.kinematics is None else design.kinematics.sides
    found = [f"  {one.joint}: '{one.parts[0]}' and '{one.parts[1]}': {one.evidence}" for one in sides]
    return [rows, Text("\nSides that contact told", style="bold"), *found] if found else [rows]


@dataclass(frozen=True)
class Seen:
    """A joint in the order and sense of one of its names: the bodies, the axis, and how far it goes."""

    name: str
    bodies: tuple[str, str]
    axis: str
    range: str

    @staticmethod
    def of(design: Design, found: Resolution, lengths: Lengths) -> Seen:
        """By the name that stands for it."""
        joint = joint_as_stated(found)
        assert joint is not None
        run = design.simulation
        item = next((item for item in (run.ranges if run else None) or () if item.joint == joint.name), None)
        axis = vector(joint.axis) if joint.axis2 is None else f"{vector(joint.axis)}; {vector(joint.axis2)}"
        return Seen(
            found.name, joint.bodies, axis, _range(None if item is None else range_as_stated(item, found), lengths)
        )

    @property
    def sense(self) -> tuple[tuple[str, str], str, str]:
        """All of it but the name."""
        return self.bodies, self.axis, self.range

    @property
    def words(self) -> str:
        """ "lever relative to frame, axis z, range -40° to 70°"."""
        axis, reach = f", axis {self.axis}", f", range {self.range}" if self.range else ""
        return f"{self.bodies[1]} relative to {self.bodies[0]}{axis}{reach}"


def named(design: Design, joint: Joint, names: Sequence[str], lengths: Lengths) -> list[Seen]:
    """The joint by those of the names of the function that stand for it."""
    assert design.kinematics is not None
    found = [resolve_joint(design.assembly, design.kinematics, name) for name in names]
    return [Seen.of(design, one, lengths) for one in found if one.joint is joint]


def _range(item: JointRange | None, lengths: Lengths) -> str:
    """How far a joint goes from the pose of the meshes; `show … simulation` says what stops it."""
    if item is None:
        return ""
    if item.lower.status == item.upper.status != "found":
        return item.status
    say = lengths.place if item.slides else degrees
    unit = f" {lengths.unit}" if item.slides else ""
    return " to ".join(e.status if e.value is None else say(e.value) + unit for e in (item.lower, item.upper))


def sentence(joint: Joint) -> str:
    """The joint and how it comes apart: "revolute about z; can also lift off along +z"."""
    about = "" if joint.axis is None else f" {_SENSES.get(joint.type, 'along')} {vector(joint.axis)}"
    if joint.type == "planar":
        about = f" on {vector(joint.axis)}"
    return f"{joint.type}{about}; {leaves(joint)}"


_SENSES = {"revolute": "about", "screw": "about", "universal": "about"}


def leaves(joint: Joint) -> str:
    """Whether contact holds the bodies together, and else how the second leaves the first."""
    if joint.held:
        return "held: no motion breaks the contact"
    if joint.held is None:
        return f"not known whether they can come apart: {joint.held_reason or 'computed by an older version'}"
    return f"can also {_ways(joint.releases, many=joint.extremes is None or joint.extremes > len(joint.releases))}"


def _ways(releases: Sequence[Release], *, many: bool = False) -> str:
    """The slides among the ways to leave, else the first turns, in words."""
    slides = [way for way in releases if way.kind == "slide"]
    # Ways to leave that are listed for each joint; `--joint` lists all. A choice.
    shown = (slides or list(releases))[:3]
    words = ", ".join(way.words for way in shown)
    if many or not all(way.extreme for way in shown):
        return f"{words}, and many ways beside"
    more = len(releases) - len(shown)
    return words + (f", and {counted(more, 'more way')}" if more else "")


def _leaving(kinematics: Kinematics, short: bool) -> list[RenderableType]:
    """How each joint comes apart that does, and what leaves the assembly; with `short` no more than can be shown."""
    lines: list[RenderableType] = []
    loose = [joint for joint in kinematics.joints if joint.held is False]
    if loose:
        lines.append(Text("\nContact that can be broken, by the second body relative to the first", style="bold"))
        lines += [f"  {joint.name}: {sentence(joint)}" for joint in beginning(loose, short)]
    held = sum(joint.held is True for joint in kinematics.joints)
    if held:
        lines.append(f"{'' if loose else chr(10)}held by contact: {held} of {counted(len(kinematics.joints), 'joint')}")
    if kinematics.separations:
        lines.append(Text("\nNo contact holds these in these directions, the rest at rest", style="bold"))
        leaving = beginning(kinematics.separations, short)
        lines += [f"  {', '.join(item.bodies)}: {_ways(item.releases)}" for item in leaving]
    if kinematics.separations_reason:
        lines.append(f"\n{kinematics.separations_reason}")
    return lines


def _doubt(joint: Joint, lengths: Lengths) -> list[RenderableType]:
    lines: list[RenderableType] = [Text(f"\n{joint.name} is {joint.status}: {joint.reason}")]
    if joint.status == "ambiguous":
        lines.append(f"  singular values: {', '.join(singular(float(value)) for value in joint.singular_values)}")
    return [*lines, *blockers(joint, lengths)]


def blockers(joint: Joint, lengths: Lengths) -> list[RenderableType]:
    """A line for each patch that blocks the joint."""
    lines: list[RenderableType] = []
    for blocker in joint.blockers:
        extent = f"{lengths.area(blocker.area)} {lengths.small}², {100 * blocker.share:.2g} % of the contact"
        lines.append(
            f"  {' and '.join(blocker.parts)}, patch {blocker.patch} ({extent}) at "
            f"({lengths.point(blocker.place)}) {lengths.unit}: forbids {blocker.forbids}"
        )
    return lines


def _bodies(design: Design) -> list[RenderableType]:
    kinematics = design.kinematics
    assert kinematics is not None
    titles = body_titles(design.assembly, kinematics)
    bodies = [body for body in kinematics.bodies if body.ground or len(body.parts) > 1]
    if not bodies:
        return []
    lines: list[RenderableType] = [Text("\nBodies", style="bold")]
    for body in bodies:
        ground = " (ground)" if body.ground else ""
        merged = f"  [{'; '.join(body.merged)}]" if body.merged else ""
        title = f", the {titles[body.name]}" if body.name in titles else ""
        lines.append(f"  {body.name}{title}{ground}: {', '.join(body.parts)}{merged}")
    return lines

"""One joint with all of its evidence: patches, singular values, what blocks it, how it comes apart, what would
make it another."""

from __future__ import annotations

from rich.console import RenderableType
from rich.text import Text

from kinform.design import Design
from kinform.foundation.rounding import SINGLE
from kinform.foundation.words import angle, counted, length
from kinform.kinematics import Insight, insight
from kinform.model.kinematics import Joint, Release
from kinform_cli.tables import Rows, stacked
from kinform_cli.text import Lengths, singular, vector
from kinform_cli.views.joints import blockers, named, sentence


def render(design: Design, name: str) -> RenderableType:
    """The joint of this name; raises KeyError where there is none."""
    evidence, lengths = insight(design, name), Lengths.of(design.assembly)
    joint = evidence.joint
    items: list[RenderableType] = [
        Text(f"{joint.name}: {sentence(joint)}", style="bold"),
        f"{joint.status}: {joint.reason}",
        f"values and motions are those of {joint.bodies[1]} relative to {joint.bodies[0]}",
    ]
    items += _as_stated(design, joint, lengths)
    if joint.point is not None:
        items.append(f"through ({lengths.point(joint.point)}) {lengths.unit}")
    items += [*_uncertainty(joint, lengths), *(f"may be read as {reading.words}" for reading in joint.readings)]
    items += [_patches(evidence, lengths), *_values(evidence)]
    if joint.blockers:
        items += [Text("\nLeft out of the decision: they block it", style="bold"), *blockers(joint, lengths)]
    if joint.releases:
        many = "" if joint.extremes is not None else ", of very many"
        items.append(Text(f"\nWays out of contact{many}", style="bold"))
        items += [f"  {_way(release, lengths)}" for release in joint.releases]
    items += _alternatives(evidence)
    return stacked(*items)


def _as_stated(design: Design, joint: Joint, lengths: Lengths) -> list[str]:
    """What each intended joint that it stands for is called, of which bodies and about which axis its values are."""
    names = [intended.name for intended in design.assembly.function.joints]
    return [f"{one.name} in the function: {one.words}" for one in named(design, joint, names, lengths)]


def _uncertainty(joint: Joint, lengths: Lengths) -> list[str]:
    """How well the fits know its axis and place."""
    known = [
        *([f"axis known to {angle(joint.axis_uncertainty, 2)}"] if joint.axis_uncertainty > SINGLE else []),
        *([f"place to {length(joint.point_uncertainty, lengths.unit, 2)}"] if _tells(joint, lengths) else []),
    ]
    if known:
        return [f"{', '.join(known)} (standard uncertainty, by the fits)"]
    exact = joint.axis_uncertainty or joint.point_uncertainty
    return ["axis and place are known as well as the meshes tell them"] if exact else []


def _tells(joint: Joint, lengths: Lengths) -> bool:
    """Whether the uncertainty of its place is more than rounding."""
    return bool(joint.point_uncertainty and joint.point_uncertainty > lengths.nothing)


def _patches(evidence: Insight, lengths: Lengths) -> Rows:
    """A row for each patch of the joint, with its weight in the decision."""
    unit = lengths.small
    title = f"\n{counted(len(evidence.patches), 'patch', 'patches')}"
    numeric = (f"gap {unit}", f"area {unit}²", "weight", "rows")
    headings = ("patch", "kind", "part", "part", "surfaces", "fit", *numeric, "role")
    rows = Rows(*headings, title=title, right=(*numeric, "patch"), keys=4, names=["part"])
    for item in evidence.patches:
        patch = item.patch
        kind = f"{patch.kind} (one side)" if patch.one_sided else patch.kind
        surfaces = f"{patch.surfaces[0]}, {patch.surfaces[1]}"
        rows.add(
            str(item.index), kind, *patch.parts, surfaces, patch.fit, lengths.length(patch.gap),
            lengths.area(patch.area), f"{100 * item.share:.3g} %", str(item.rows), item.role,
        )  # fmt: skip
    return rows


def _values(evidence: Insight) -> list[RenderableType]:
    joint = evidence.joint
    lines: list[RenderableType] = [Text("\nSingular values", style="bold")]
    if not evidence.samples or not all(value == value for value in joint.singular_values):
        return [*lines, "  none: contact does not decide this joint"]
    lines.append(f"  {', '.join(singular(float(value)) for value in joint.singular_values)}")
    lines.append(f"  from {counted(evidence.samples, 'sample')}; {counted(evidence.rows, 'row')} in J")
    last = "none is free" if evidence.last_free is None else f"last free {singular(evidence.last_free)}"
    first = "none is held" if evidence.first_held is None else f"first held {singular(evidence.first_held)}"
    lines.append(f"  {last}, {first}; free is below {evidence.free:g}, held above {evidence.held:g}, ambiguous between")
    return lines


def _way(release: Release, lengths: Lengths) -> str:
    place = "" if release.point is None else f", axis through ({lengths.point(release.point)}) {lengths.unit}"
    middle = "" if release.extreme else " (in the middle of very many directions)"
    return f"{release.words}{place}{middle}"


def _alternatives(evidence: Insight) -> list[RenderableType]:
    lines: list[RenderableType] = [Text("\nWhat would make it another", style="bold")]
    for item in evidence.alternatives:
        names = f"{'patch' if len(item.without) == 1 else 'patches'} {', '.join(map(str, item.without))}"
        axis = "" if item.axis is None else f" ({vector(item.axis)})"
        why = f", which forbid{'s' if len(item.without) == 1 else ''} {item.frees}" if item.frees else ""
        lines.append(f"  without {names}{why}: {item.type}{axis}, {counted(item.freedoms, 'freedom')}, {item.status}")
    if not evidence.alternatives and evidence.tried:
        lines.append(f"  nothing found: the same without each of {counted(evidence.tried, 'set')} of patches")
    if not evidence.alternatives and not evidence.tried and not evidence.remark:
        lines.append("  nothing: a single patch carries it")
    if evidence.remark:
        lines.append(f"  {evidence.remark}")
    return lines

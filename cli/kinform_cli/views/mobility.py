"""Mobility: how many freedoms, counted in each of the ways that `_MEANINGS` defines."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from rich.console import RenderableType

from kinform.design import Design
from kinform.foundation.rounding import ARITHMETIC, SINGLE
from kinform.foundation.words import counted, length, rate
from kinform.function.body_titles import body_titles
from kinform.kinematics import Motions, disconnected_bodies, disconnected_in_words
from kinform.model.kinematics import Coupling, Mobility
from kinform.reports.freedom_phrases import follower_rates, freedom_text
from kinform.reports.values.kinematics import mobility_counts
from kinform_cli.shortened import beginning
from kinform_cli.tables import Rows, stacked
from kinform_cli.text import NONE, Lengths

MOST_NAMES = 8
"""Bodies or joints that are listed for a freedom; the JSON has them all. A choice."""
SHOWN_TURN = 1e-5
"""Radians from which on the turn of a joint is listed: ten times what the rounding of mesh files turns an axis by.
Chosen, not measured."""
MOST_MOVES = 12
"""Joints that were moved that are listed; the JSON has them all. A choice."""


_MEANINGS = (
    ("effective", "without idle freedoms: `mobility` states these, and idle ones or not"),
    ("low_mobility", "effective, with all contact kept as it is drawn"),
    ("high_mobility", "effective, without contact that only pushes and that no stated joint names"),
    ("instantaneous", "velocities that the bilateral constraints leave"),
    ("finite", "of these, motions that go on over a distance"),
    ("idle", "turns of single bodies that nobody sees, as of a pin"),
    ("redundant", "constraints more than are needed"),
    ("gruebler", "6(N−1) − Σ(6−f): the count that knows no geometry"),
    ("blocked_mobility", "instantaneous, with everything that blocks"),
)


def render(design: Design, *, short: bool = False) -> RenderableType:
    """The counts with their meaning, the freedoms by name, and what is held more than once; with `short` no more of
    each than can be shown."""
    assert design.kinematics is not None
    mobility = design.kinematics.mobility
    grid = Rows("count", "", "meaning", title="Mobility relative to ground", right=["count"], keys=2)
    values = mobility_counts(mobility) | {"gruebler": mobility.gruebler}
    low, high = mobility.ends
    for name, meaning in _MEANINGS:
        value = values[name]
        if low == high and name in ("low_mobility", "high_mobility"):
            continue
        grid.add(
            NONE if value is None else str(value),
            name.replace("_", " "),
            "not known, see below" if value is None else meaning,
        )
    items: list[RenderableType] = [grid]
    if mobility.finite_reason:
        items.append(mobility.finite_reason)
    elif mobility.certificates:
        items.append(_certificate(mobility))
    named = _first_names if short else ", ".join
    if mobility.idle_bodies:
        items.append(f"idle: {named(mobility.idle_bodies)}")
    if mobility.uncertain:
        items.append(f"the counts depend on joints that are not certain: {named(mobility.uncertain)}")
    if design.contacts is not None and (loose := disconnected_bodies(design.kinematics, design.contacts)):
        items.append(f"the counts take for free what may not be: {disconnected_in_words(loose)}")
    items += [_coupling(coupling, design) for coupling in design.kinematics.couplings]
    items += _misfit(design)
    if mobility.named:
        items += ["", _freedoms(design, short)]
    if mobility.redundancies:
        items += ["", _redundancies(design)]
    return stacked(*items)


def _certificate(mobility: Mobility) -> str:
    """Why all freedoms of the loops are motions."""
    step = min(certificate.step for certificate in mobility.certificates)
    kept = min(certificate.kept for certificate in mobility.certificates)
    residual = max(certificate.residual for certificate in mobility.certificates)
    return (
        f"loops close again after steps of {step:g} in every freedom: {100.0 * kept:.3g} % of the step kept, "
        f"residual below {residual:.0e}"
    )


def _coupling(coupling: Coupling, design: Design) -> str:
    """One coupling: "gear: a = -1.5 · b through c", values in degrees and lengths."""
    assert design.kinematics is not None
    first, second = coupling.joints
    types = {joint.name: joint.type for joint in design.kinematics.joints}
    slides = [types.get(name) == "prismatic" for name in coupling.joints]
    ratio = rate(coupling.ratio, slides[0], slides[1], Lengths.of(design.assembly).unit)
    share = coupling.uncertainty / abs(coupling.ratio) if coupling.ratio else math.inf
    spread = f" ± {100.0 * share:.1g} %" if math.isfinite(share) else ""
    pose = ", at this pose" if coupling.kind == "cam" else ""
    sure = "" if coupling.status == "determined" else f" ({coupling.status})"
    text = f"{coupling.kind}: {first} = {ratio}{spread} · {second} through {coupling.through}{pose}{sure}"
    if coupling.meshing is not None:
        first_teeth, second_teeth = coupling.meshing.teeth
        whole = rate(coupling.meshing.ratio, slides[0], slides[1], Lengths.of(design.assembly).unit)
        return f"{text}; {whole} over whole teeth, of {first_teeth} and {second_teeth}"
    return f"{text}; {coupling.reason}" if coupling.reason else text


def _freedoms(design: Design, short: bool) -> Rows:
    """Each freedom with the bodies that it moves and the joints that follow."""
    kinematics = design.kinematics
    assert kinematics is not None
    lengths, motions = Lengths.of(design.assembly), Motions.of(kinematics)
    joints = {str(joint.name): joint for joint in kinematics.joints}
    titles = body_titles(design.assembly, kinematics)
    texts = ("freedom", "moves", "follow")
    grid = Rows("freedom", "driven at", "moves", "follow", title="Freedoms", names=["driven at"], texts=texts)
    for freedom in beginning(kinematics.mobility.named, short):
        rates = follower_rates(freedom, joints, lengths.unit, lengths.metres)
        grid.add(
            freedom_text(
                replace(freedom, body=type(freedom.body)(titles.get(freedom.body, freedom.body))),
                lambda point: f"({lengths.point(point)}) {lengths.unit}",
                lambda lead: f"{lengths.length(lead)} {lengths.small}",
            ),
            freedom.driver or NONE,
            _first_names(
                [titles.get(str(name), str(name)).removeprefix("body of ") for name in motions.twists(freedom)]
            ),
            _first_names([f"{name} {rate}" for name, rate in rates]) or NONE,
        )
    return grid


def _redundancies(design: Design) -> Rows:
    """Where constraints hold nothing more."""
    assert design.kinematics is not None
    where = "too many, and where"
    grid = Rows("rows", where, title="Redundant constraints", right=["rows"], keys=2, texts=[where])
    for redundancy in design.kinematics.mobility.redundancies:
        within = " (contacts of one joint: not counted above)" if redundancy.kind == "pair" else ""
        grid.add(str(redundancy.rows), redundancy.text + within)
    return grid


def _first_names(items: Sequence[str]) -> str:
    """All of a few, the first of many."""
    return (
        ", ".join(items)
        if len(items) <= MOST_NAMES
        else ", ".join(items[:MOST_NAMES]) + f" and {len(items) - MOST_NAMES} more"
    )


def _misfit(design: Design) -> list[str]:
    """What was moved to make axes agree that agree within their uncertainty: the most, and each joint that shows."""
    kinematics, units = design.kinematics, design.assembly.units
    assert kinematics is not None
    misfit = kinematics.misfit
    size = design.assembly.largest or 1.0
    most = []
    if misfit.distance > ARITHMETIC * size:
        most.append(f"{length(misfit.distance, units, 2)} at {misfit.distance_at}")
    if misfit.angle >= SINGLE:
        most.append(f"{math.degrees(misfit.angle):.2g}° at {misfit.angle_at}")
    lines = [f"misfit of axes that were made to agree: {', '.join(most) or 'none'}"]
    shown = [m for m in kinematics.moves if m.distance > SINGLE * size or m.angle > SHOWN_TURN]
    for move in shown[:MOST_MOVES]:
        lines.append(
            f"  {move.joint} was moved by {length(move.distance, units, 2)} and {math.degrees(move.angle):.2g}°"
        )
    if len(shown) > MOST_MOVES:
        lines.append(f"  and {counted(len(shown) - MOST_MOVES, 'more joint')}")
    return lines

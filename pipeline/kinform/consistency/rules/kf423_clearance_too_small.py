"""Two parts collide, or come nearer than the required distance, along the simulated motion or over the ranges.

Distances are those of the surfaces, by FCL. Surfaces by which a pair mates do not count against each other, nor against
what borders on their mates or touches beside them; they count against all the rest. Messages name such pairs. Along the
motion steps are as long as the distance allows, so that nothing is passed over; between output times poses are
interpolated. Over the ranges every combination of joint values between the two is covered, cell by cell.
Distances are certain up to 1e-4 of the size of the smaller part, 1e-3 where several joints move at once. A simulation
that did not run, a range that is not known, a loop between the two (over ranges), too many cells, or parts of which it
is not known whether they overlap as drawn (KF210) make the requirement inconclusive (KF902).

Why it matters: what collides does not move there, and breaks.

What to do: see the place and the time. Cut material away, or narrow the motion or the range.

Example: `kind = "clear"`, `between = ["camera", "housing"]`, `distance = 1` for a camera that passes a rib by 0.4 mm.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from kinform.consistency.context import Context, Need
from kinform.consistency.outcome import Answer, met, undecided, violated
from kinform.consistency.requirements import (
    JOINTS,
    requirement_rule,
    shared_parts,
    shown_value,
    simulated,
    stated_as,
    worst_of,
)
from kinform.foundation.algebra.displacements import poses
from kinform.foundation.words import counted, length, number, quoted, telling
from kinform.function.clearances import Apart
from kinform.function.configurations import Chain, chain_between
from kinform.function.requirement_kinds import Clear
from kinform.function.sweeps import Swept, along, over
from kinform.model.arrays import Array
from kinform.model.kinematics import Body, Joint, Kinematics
from kinform.model.simulation import Simulation

REMEDY = "Cut material away, or narrow the motion or the range."
Pair = tuple[Body, Sequence[str], Body, Sequence[str]]


def judge(context: Context, requirement: Clear) -> Answer:
    """Every pair of the two groups of parts, or of all bodies."""
    simulation = simulated(context) if requirement.over == "motion" else None
    if isinstance(simulation, Answer):
        return simulation
    between = requirement.between
    if between is not None and (shared := shared_parts(context, between)):
        return undecided(f"{quoted(shared)} would be on both sides", "Name two that share no part.")
    pairs = _pairs(context, context.kinematics, between)
    of_pairs = (_of_pair(context, requirement, pair, simulation) for pair in pairs)
    answers = [answer for answer in of_pairs if answer is not None]
    if not answers:
        return undecided("none of the parts have meshes", "Give the parts meshes.")
    worst, violations = worst_of(answers), sum(answer.state == "violated" for answer in answers)
    if worst is not None:
        more = f"; {counted(violations - 1, 'more pair')} of bodies too" if violations > 1 else ""
        return replace(worst, message=worst.message + more)
    if simulation is not None and simulation.status != "done":
        return undecided(f"the simulation stopped: {simulation.reason}", "See KF502.")
    # no margin: poses are measured until the distance is certain, not until the nearest is found
    return answers[0] if len(answers) == 1 else met(f"{counted(len(answers), 'pair')} clear; {answers[0].message}")


def _pairs(context: Context, kinematics: Kinematics, between: Sequence[str] | None) -> list[Pair]:
    """Bodies with those of their parts that count."""
    if between is None:
        bodies = sorted(kinematics.bodies, key=lambda b: b.name)
        return [(a, a.parts, b, b.parts) for k, a in enumerate(bodies) for b in bodies[k + 1 :]]
    sides = []
    for name in between:
        parts = context.assembly.parts_of(name)
        bodies = sorted(
            {kinematics.body_of(p).name: kinematics.body_of(p) for p in parts}.values(), key=lambda b: b.name
        )
        sides.append([(body, [p for p in parts if p in body.parts]) for body in bodies])
    return [(a, parts, b, others) for a, parts in sides[0] for b, others in sides[1]]


def _of_pair(context: Context, requirement: Clear, pair: Pair, simulation: Simulation | None) -> Answer | None:
    """The answer for one pair, over the ranges where there is no simulation; None where one of the two has no mesh."""
    from kinform.function.clearances import apart

    a, parts, b, others = pair
    groups = apart(context.assembly, context.contacts, context.design.surfaces, parts, others)
    if groups is None:
        return None
    names = quoted([*parts[:2], *others[:2]])
    if not any(p.tests for p in groups.pairs):
        return undecided(f"all surfaces of {names} mate: nothing else can come near", "None.")
    required = float(requirement.distance)
    if simulation is not None:
        swept = along(groups, _displacements(simulation, a), _displacements(simulation, b), required)
        return _answer(context, groups, swept, required, names, _time(simulation, swept))
    if a.name == b.name:
        still = np.eye(4)[None]
        swept = along(groups, still, still, required)
        return _answer(context, groups, swept, required, names, "")
    chain = chain_between(context.assembly, context.kinematics, a.name, b.name, "stated")
    if isinstance(chain, str):
        return undecided(chain, "See KF401 and KF901.")
    box = _ranges(context, chain)
    if isinstance(box, Answer):
        return box
    swept = over(groups, chain, a.name, b.name, *box, required)
    values = _values(context, chain, swept)
    return _answer(context, groups, swept, required, names, values)


def _ranges(context: Context, chain: Chain) -> tuple[Array, Array] | Answer:
    """Least and greatest coordinates of a chain without loops; free turns take a full turn."""
    if chain.looped:
        return undecided(
            "loops connect the two: their joint values depend on each other", 'Check it over = "motion", by simulation.'
        )
    if chain.unknown:
        names = [stated_as(context, name)[0] for name in chain.unknown]
        return undecided(f"the range of {quoted(names)} is not known", "State the `range` of the joint.")
    low, high = chain.lower, chain.upper
    for k, coordinate in enumerate(chain.coordinates):
        if coordinate.turns:
            low[k], high[k] = max(low[k], -math.pi), min(high[k], math.pi)
        elif not math.isfinite(high[k] - low[k]):
            name, _ = stated_as(context, coordinate.joint)
            return undecided(f"joint '{name}' slides without an end", "State a finite `range`.")
    return low, high


def _displacements(simulation: Simulation, body: Body) -> Array:
    """(T, 4, 4) displacements; bodies that the simulation does not have stay."""
    if body.name not in simulation.body_names:
        return np.tile(np.eye(4), (len(simulation.time), 1, 1))
    b = simulation.body_names.index(body.name)
    return poses(simulation.p_WB[:, b], simulation.q_WB[:, b])


def _answer(context: Context, groups: Apart, swept: Swept, required: float, names: str, where: str) -> Answer:
    """What the sweep of a pair says; `where` is the time or the joint values of its worst pose, in words."""
    units, near = context.units, swept.worst
    in_words = telling(lambda value, digits: length(value, units, digits), near.distance, required)
    shown = in_words(near.distance)
    parts = quoted(near.parts) if near.parts[0] else names
    if near.distance < required or near.distance <= 0.0:
        what = f"{parts} collide" if near.distance <= 0.0 else f"{parts} come within {shown}"
        return violated(
            f"{what}{where}", found="collision" if near.distance <= 0.0 else shown,
            intended=f"at least {in_words(required)}" if required > 0.0 else "no collision",
            place=near.place, remedy=REMEDY,
        )  # fmt: skip
    perhaps = {overlap.parts for overlap in context.contacts.possible_overlaps}
    unknown = sorted(
        perhaps & {(min(pair), max(pair)) for p in groups.pairs for pair in [(p.first.name, p.second.name)]}
    )
    if unknown:
        return undecided(
            f"whether {quoted(unknown[0])} overlap as they are drawn is not known", "See KF210.",
        )  # fmt: skip
    if not swept.complete:
        return undecided(
            f"{names} pass each other so closely that {swept.poses} measured poses do not certify them",
            "Lower the distance, or check it by other means.", found=f"nearest measured {shown}",
        )  # fmt: skip
    text = f"{names} stay clear, certain within {length(swept.floor, units)} by {counted(swept.poses, 'measured pose')}"
    return met(f"{text}; not counted: surfaces by which {_mating(groups)} mate" if groups.left_out else text)


def _mating(groups: Apart) -> str:
    """The pairs of parts whose mating surfaces do not count against each other."""
    shown = [" and ".join(quoted([name]) for name in pair) for pair in groups.left_out[:3]]
    more = len(groups.left_out) - len(shown)
    return "; ".join([*shown, counted(more, "more pair")] if more else shown)


def _time(simulation: Simulation, swept: Swept) -> str:
    time = np.interp(swept.where, np.arange(len(simulation.time)), simulation.time)
    return f" at t = {number(float(time))} s"


def _values(context: Context, chain: Chain, swept: Swept) -> str:
    joints: dict[str, Joint] = {joint.name: joint for joint in context.kinematics.joints}
    shown = []
    for coordinate, value in zip(chain.coordinates, swept.values, strict=True):
        name, sign = stated_as(context, coordinate.joint)
        shown.append(f"{name} = {shown_value(sign * value, joints[coordinate.joint], context.units)}")
    return f" at {', '.join(shown)}"


SUPPLIED_BY: Mapping[Need, str] = {**JOINTS, "contacts": "Give the parts meshes."}
RULE = requirement_rule("KF423", "clearance-too-small", Clear, __doc__, judge, SUPPLIED_BY)

"""`clear`: no collision over the ranges or the motion, with a least distance."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from kinform.form.tables import NonNegative, Reference
from kinform.foundation.algebra.displacements import poses, twist_of
from kinform.foundation.words import counted, length, number, quoted, telling
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.findings import Witness, between
from kinform.model.kinematics import Body, Joint, Kinematics
from kinform.model.simulation import Simulation
from kinform.requirements.answer import Answer, met, undecided, violated, worst_of
from kinform.requirements.bounds import shared_parts
from kinform.requirements.evidence import Chain, Evidence, PairOfGroups, Swept
from kinform.requirements.joints import shown_value
from kinform.requirements.kind import Kind, Record
from kinform.requirements.quantity import LENGTH, PLACE
from kinform.requirements.runs import simulated
from kinform.requirements.table import RequirementTable, side_faults

Over = Literal["ranges", "motion"]
Pair = tuple[Body, Sequence[str], Body, Sequence[str]]
REMEDY = "Cut material away, or narrow the motion or the range."


class Clear(RequirementTable):
    """No collision over the ranges or the motion, with a least distance."""

    kind: Literal["clear"]
    between: Annotated[list[Reference] | None, Field(min_length=2, max_length=2), PLACE] = Field(
        None, description="two parts or groups; default all"
    )
    over: Over = Field("motion", description="the ranges of the joints, or the simulation")
    distance: Annotated[NonNegative, LENGTH] = Field(0.0, description="least distance")


@dataclass(frozen=True, eq=False)
class ClearRecord(Record):
    """Two parts or groups, or all bodies, keep a distance (m) over the motion or the ranges."""

    between: Sequence[str] | None = None
    over: Over = "motion"
    distance: float = 0.0


def judge(evidence: Evidence, wanted: ClearRecord) -> Answer:
    """Every pair of the two groups of parts, or of all bodies."""
    simulation = simulated(evidence) if wanted.over == "motion" else None
    if isinstance(simulation, Answer):
        return simulation
    between = wanted.between
    if between is not None and (shared := shared_parts(evidence, between)):
        return undecided(f"{quoted(shared)} would be on both sides", "Name two that share no part.")
    pairs = _pairs(evidence, evidence.kinematics, between)
    of_pairs = (_of_pair(evidence, wanted, pair, simulation) for pair in pairs)
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


def _pairs(evidence: Evidence, kinematics: Kinematics, between: Sequence[str] | None) -> list[Pair]:
    """Bodies with those of their parts that count."""
    if between is None:
        bodies = sorted(kinematics.bodies, key=lambda b: b.name)
        return [(a, a.parts, b, b.parts) for k, a in enumerate(bodies) for b in bodies[k + 1 :]]
    sides = []
    for name in between:
        parts = evidence.assembly.parts_of(name)
        bodies = sorted(
            {kinematics.body_of(p).name: kinematics.body_of(p) for p in parts}.values(), key=lambda b: b.name
        )
        sides.append([(body, [p for p in parts if p in body.parts]) for body in bodies])
    return [(a, parts, b, others) for a, parts in sides[0] for b, others in sides[1]]


def _of_pair(evidence: Evidence, wanted: ClearRecord, pair: Pair, simulation: Simulation | None) -> Answer | None:
    """The answer for one pair, over the ranges where there is no simulation; None where one of the two has no mesh."""
    a, parts, b, others = pair
    groups = evidence.groups(a, parts, b, others)
    if groups is None:
        return None
    names = quoted([*parts[:2], *others[:2]])
    if not groups.comparable:
        return undecided(f"all surfaces of {names} mate: nothing else can come near", "None.")
    required = float(wanted.distance)
    if simulation is not None:
        swept = groups.along(_displacements(simulation, a), _displacements(simulation, b), required)
        return _answer(evidence, groups, swept, required, names, _time(simulation, swept))
    if a.name == b.name:
        still = np.eye(4)[None]
        swept = groups.along(still, still, required)
        return _answer(evidence, groups, swept, required, names, "")
    chain = groups.chain()
    if isinstance(chain, str):
        return undecided(chain, "See KF401 and KF901.")
    box = _ranges(evidence, chain)
    if isinstance(box, Answer):
        return box
    swept = groups.over(*box, required)
    values = _values(evidence, chain, swept)
    return _answer(evidence, groups, swept, required, names, values)


def _ranges(evidence: Evidence, chain: Chain) -> tuple[Array, Array] | Answer:
    """Least and greatest coordinates of a chain without loops; free turns take a full turn."""
    if chain.looped:
        return undecided(
            "loops connect the two: their joint values depend on each other", 'Check it over = "motion", by simulation.'
        )
    if chain.unknown:
        names = [evidence.stated_as(name)[0] for name in chain.unknown]
        return undecided(f"the range of {quoted(names)} is not known", "State the `range` of the joint.")
    low, high = chain.lower, chain.upper
    for k, coordinate in enumerate(chain.coordinates):
        if coordinate.turns:
            low[k], high[k] = max(low[k], -math.pi), min(high[k], math.pi)
        elif not math.isfinite(high[k] - low[k]):
            name, _ = evidence.stated_as(coordinate.joint)
            return undecided(f"joint '{name}' slides without an end", "State a finite `range`.")
    return low, high


def _displacements(simulation: Simulation, body: Body) -> Array:
    """(T, 4, 4) displacements; bodies that the simulation does not have stay."""
    if body.name not in simulation.body_names:
        return np.tile(np.eye(4), (len(simulation.time), 1, 1))
    b = simulation.body_names.index(body.name)
    return poses(simulation.p_WB[:, b], simulation.q_WB[:, b])


def _answer(evidence: Evidence, groups: PairOfGroups, swept: Swept, required: float, names: str, where: str) -> Answer:
    """What the sweep of a pair says; `where` is the time or the joint values of its worst pose, in words."""
    units, near = evidence.units, swept.worst
    in_words = telling(lambda value, digits: length(value, units, digits), near.distance, required)
    shown = in_words(near.distance)
    parts = quoted(near.parts) if near.parts[0] else names
    if near.distance < required or near.distance <= 0.0:
        what = f"{parts} collide" if near.distance <= 0.0 else f"{parts} come within {shown}"
        return violated(
            f"{what}{where}", found="collision" if near.distance <= 0.0 else shown,
            intended=f"at least {in_words(required)}" if required > 0.0 else "no collision",
            place=near.place, remedy=REMEDY,
            witness=_witness(evidence, groups, swept),
        )  # fmt: skip
    perhaps = {overlap.parts for overlap in evidence.contacts.possible_overlaps}
    unknown = sorted(perhaps & {*groups.parts})
    if unknown:
        return undecided(f"whether {quoted(unknown[0])} overlap as they are drawn is not known", "See KF210.")
    if not swept.complete:
        return undecided(
            f"{names} pass each other so closely that {swept.poses} measured poses do not certify them",
            "Lower the distance, or check it by other means.", found=f"nearest measured {shown}",
        )  # fmt: skip
    text = f"{names} stay clear, certain within {length(swept.floor, units)} by {counted(swept.poses, 'measured pose')}"
    return met(f"{text}; not counted: surfaces by which {_mating(groups)} mate" if groups.mating else text)


def _witness(evidence: Evidence, groups: PairOfGroups, swept: Swept) -> Witness | None:
    """How far the two parts are apart at the pose that falls short; of parts that mate, that they are in each other."""
    near = swept.worst
    if swept.relative is None or not near.parts[0]:
        return None
    if (min(near.parts), max(near.parts)) in groups.mating:
        return evidence.in_each_other(near.parts, swept.beyond)
    return between(near.parts[:1], near.parts[1:], near.distance, moved=twist_of(swept.relative))


def _mating(groups: PairOfGroups) -> str:
    """The pairs of parts whose mating surfaces do not count against each other."""
    shown = [" and ".join(quoted([name]) for name in pair) for pair in groups.mating[:3]]
    more = len(groups.mating) - len(shown)
    return "; ".join([*shown, counted(more, "more pair")] if more else shown)


def _time(simulation: Simulation, swept: Swept) -> str:
    time = np.interp(swept.where, np.arange(len(simulation.time)), simulation.time)
    return f" at t = {number(float(time))} s"


def _values(evidence: Evidence, chain: Chain, swept: Swept) -> str:
    joints: dict[str, Joint] = {joint.name: joint for joint in evidence.kinematics.joints}
    shown = []
    for coordinate, value in zip(chain.coordinates, swept.values, strict=True):
        name, sign = evidence.stated_as(coordinate.joint)
        shown.append(f"{name} = {shown_value(sign * value, joints[coordinate.joint], evidence.units)}")
    return f" at {', '.join(shown)}"


KIND = Kind(
    "clear", 30, Clear, ClearRecord, judge,
    faults=lambda table: iter(()) if table.between is None else side_faults(table.between),
    needs={"kinematics": "Run `kinform joints`.", "contacts": "Give the parts meshes."},
)  # fmt: skip

"""The rules of requirements: one for each kind, which reports what is violated; KF902 reports what is undecided.

A judge gives the answer to one requirement; what judges share is here: the simulation that they read, the joint that a
name stands for, values in words.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeVar

from kinform.consistency.context import Context, Need
from kinform.consistency.outcome import Answer, Outcome, decided, skipped, undecided
from kinform.consistency.rule import Rule
from kinform.foundation.words import angle, counted, length, number
from kinform.frozen import dataclass
from kinform.function import resolve_joint
from kinform.function.requirement_kinds import Kind
from kinform.model.function import Requirement
from kinform.model.kinematics import Joint
from kinform.model.simulation import Simulation

NO_EFFORT = 1e-12
"""N·m or N below which an effort is shown as nothing: rounding."""


SIMULATE = "Ask for a simulation that runs to its end: [simulation], and a [[function.drive]] that moves the joints."
DYNAMIC = 'Ask for `level = "dynamic"`, with the mass of every moving part known.'
JOINTS: Mapping[Need, str] = {"kinematics": "Run `kinform joints`."}
"""What a judge of bodies and joints needs, and what supplies it."""
SINGLE: Mapping[Need, str] = {"kinematics": "Run the stages before."}
"""The same for a judge of one value of a joint."""
MASSES: Mapping[Need, str] = {"mass": "Run `kinform mass`."}
"""What a judge of masses needs, and what supplies it."""

K = TypeVar("K", bound=Kind)


@dataclass(frozen=True, kw_only=True)
class RequirementRule(Rule):
    """The rule of one kind of requirement, with what answers them."""

    kind: str
    judge: Callable[[Context, Requirement], Answer]


def requirement_rule(
    code: str,
    name: str,
    kind: type[K],
    documentation: str | None,
    judge: Callable[[Context, K], Answer],
    supplied_by: Mapping[Need, str] | None = None,
) -> RequirementRule:
    """The rule of one kind of requirement: an error for each that is violated.

    `supplied_by`: what the judge needs, and what supplies it where it is lacking: the requirement is then undecided.
    """

    def answer(context: Context, requirement: Requirement) -> Answer:
        for need, remedy in (supplied_by or {}).items():
            lacking = context.lacks(need)
            if lacking is not None:
                return undecided(lacking.reason, remedy)
        return judge(context, kind.read(requirement.values))

    def check(context: Context) -> Outcome:
        answers = {r: answer for r, answer in context.answers.items() if r.kind == kind.kind}
        if not answers:
            asleep = sum(r.kind == kind.kind for r in context.dormant)
            quiet = f"{counted(asleep, 'limit')} of joints not checked: nothing drives them in a simulation"
            return skipped(quiet if asleep else "the function states no requirement of this kind")
        if all(answer.state == "undecided" for answer in answers.values()):
            return skipped(f"{counted(len(answers), 'requirement')} could not be decided: see KF902")
        findings = [
            rule.finding(
                [requirement.name],
                f"requirement '{requirement.name}' ({kind.kind}): {answer.message}",
                found=answer.found,
                intended=answer.intended,
                place=answer.place,
                declared=requirement,
                remedy=answer.remedy,
            )
            for requirement, answer in answers.items()
            if answer.state == "violated"
        ]
        return decided(findings, "; ".join(f"'{r.name}': {a.message}" for r, a in answers.items() if a.state == "met"))

    rule = RequirementRule(code, name, "error", documentation, check, kind=kind.kind, judge=answer)
    return rule


def worst_of(answers: Sequence[Answer]) -> Answer | None:
    """The first that is violated, else the first that is undecided; None where all are met."""
    by_state = {answer.state: answer for answer in reversed(answers)}
    return by_state.get("violated") or by_state.get("undecided")


def simulated(context: Context, *, dynamic: bool = False) -> Simulation | Answer:
    """The simulation, or why it says nothing. One that stopped early is given: what it shows has happened."""
    lacking = context.lacks("simulation")
    if lacking is not None:
        return undecided(lacking.reason, SIMULATE)
    simulation = context.simulation
    if simulation.status == "refused" or len(simulation.time) == 0:
        return undecided(f"the simulation was refused: {simulation.reason}", "See KF501.")
    if dynamic and simulation.level != "dynamic":
        return undecided(f"the simulation is {simulation.level}: it has no forces", DYNAMIC)
    unseen = (context.lacks("forces") if dynamic else context.lacks("motion")) if simulation.dampings else None
    if unseen is not None:
        return undecided(unseen.reason, "See KF508.")
    return simulation


def single_joint(context: Context, name: str) -> Joint | Answer:
    """The derived joint that a name stands for, where it has one freedom; else why not. Needs kinematics."""
    resolution = resolve_joint(context.assembly, context.kinematics, name)
    joint = resolution.joint
    if joint is None:
        why = f"joint '{name}' is not found: {resolution.reason}"
        return undecided(why, "Name a joint that geometry has: see KF401.")
    if joint.status == "ambiguous":
        return undecided(f"joint '{name}' is ambiguous: {joint.reason}", "See KF901.")
    if joint.freedoms != 1 or joint.type == "general":
        freedoms = counted(joint.freedoms, "freedom")
        return undecided(
            f"joint '{name}' is {joint.type}, with {freedoms}: one value does not describe it",
            "Require it of a joint with one freedom.",
        )
    return joint


def stated_as(context: Context, joint: str) -> tuple[str, int]:
    """The name that the designer gave a joint, else kinform's, and the sign of the designer's values against kinform's.
    Needs kinematics."""
    for intended in context.function.joints:
        resolution = resolve_joint(context.assembly, context.kinematics, intended.name)
        if resolution.joint is not None and resolution.joint.name == joint:
            return intended.name, resolution.sign
    return joint, 1


def shared_parts(context: Context, between: Sequence[str]) -> list[str]:
    """Parts that are on both of two sides, sorted."""
    first, second = (context.assembly.parts_of(name) for name in between)
    return sorted(set(first) & set(second))


def kind_of_value(joint: Joint) -> str:
    """angle or length."""
    return "length" if joint.type == "prismatic" else "angle"


def shown_value(value: float, joint: Joint, units: str, digits: int = 4) -> str:
    """A joint value (rad or m)."""
    return length(value, units, digits) if kind_of_value(joint) == "length" else angle(value, digits)


def effort(value: float, joint: Joint, digits: int = 4) -> str:
    """A joint's effort; rounding is shown as nothing."""
    value = 0.0 if abs(value) < NO_EFFORT else value
    return f"{number(value, digits)} {unit_of_effort(joint)}"


def unit_of_effort(joint: Joint) -> str:
    """Of a joint's effort."""
    return "N" if kind_of_value(joint) == "length" else "N·m"


def unit_of(joint: Joint) -> str:
    """Of a joint's value."""
    return "m" if kind_of_value(joint) == "length" else "rad"

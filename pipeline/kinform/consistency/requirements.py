"""Requirements and their answers: met, violated, or undecided with the reason and what would decide it.

Each kind has a rule of its own, which reports what is violated; KF902 reports what is undecided.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from kinform.consistency.context import Context
from kinform.consistency.rule import Outcome, Rule, decided, skipped
from kinform.foundation.words import angle, counted, length, number
from kinform.function import Resolution, resolve
from kinform.model.function import Requirement
from kinform.model.kinematics import Joint
from kinform.model.simulation import Simulation

__all__ = [
    "Answer", "Judge", "bounds", "common", "effort", "kind_of_value", "met", "requirement_rule", "resolved", "shown_value",
    "simulated", "stated_as", "undecided", "violated",
]  # fmt: skip

SIMULATE = "Ask for a simulation that runs to its end: [simulation], and a [[function.drive]] that moves the joints."
DYNAMIC = 'Ask for `level = "dynamic"`, with the mass of every moving part known.'


@dataclass(frozen=True)
class Answer:
    """What became of one requirement. `message` ends the sentence "requirement 'name': …"."""

    state: str
    """met, violated or undecided."""
    message: str
    found: str | None = None
    intended: str | None = None
    place: tuple[float, float, float] | None = None
    remedy: str | None = None


Judge = Callable[[Context, Requirement], Answer]


def met(message: str, *, found: str | None = None, intended: str | None = None) -> Answer:
    """The requirement holds; the message says how this is known."""
    return Answer("met", message, found, intended)


def violated(message: str, *, found: str, intended: str, remedy: str, place: Iterable[float] | None = None) -> Answer:
    """The requirement does not hold."""
    return Answer("violated", message, found, intended, _triple(place), remedy)


def undecided(message: str, remedy: str, *, found: str | None = None, intended: str | None = None) -> Answer:
    """What is missing, and what would decide it."""
    return Answer("undecided", message, found, intended, None, remedy)


def requirement_rule(code: str, name: str, kind: str, documentation: str | None, judge: Judge) -> Rule:
    """The rule of one kind of requirement: an error for each that is violated."""

    def check(context: Context) -> Outcome:
        own = [r for r in context.function.requirements if r.kind == kind]
        if not own:
            return skipped("the function states no requirement of this kind")
        answers = [(requirement, answer(context, requirement, judge)) for requirement in own]
        known = [pair for pair in answers if pair[1].state != "undecided"]
        if not known:
            return skipped(f"{counted(len(own), 'requirement')} could not be decided: see KF902")
        findings = [
            rule.finding(
                [requirement.name],
                f"requirement '{requirement.name}' ({kind}): {found.message}",
                found=found.found,
                intended=found.intended,
                place=found.place,
                declared=requirement,
                remedy=found.remedy,
            )
            for requirement, found in known
            if found.state == "violated"
        ]
        return decided(findings, "; ".join(f"'{r.name}': {a.message}" for r, a in known if a.state == "met"))

    rule = Rule(code, name, "error", documentation, check)
    return rule


def answer(context: Context, requirement: Requirement, judge: Judge) -> Answer:
    """The answer to one requirement, worked out once."""
    known: dict[int, Answer] = context.answers
    if id(requirement) not in known:
        known[id(requirement)] = judge(context, requirement)
    return known[id(requirement)]


def simulated(context: Context, *, dynamic: bool = False) -> Simulation | Answer:
    """The simulation, or why it says nothing. One that stopped early is given: what it shows has happened."""
    simulation = context.simulation
    if isinstance(simulation, Outcome):
        return undecided(simulation.reason, SIMULATE)
    if simulation.status == "refused" or len(simulation.time) == 0:
        return undecided(f"the simulation was refused: {simulation.reason}", "See KF501.")
    if dynamic and simulation.level != "dynamic":
        return undecided(f"the simulation is {simulation.level}: it has no forces", DYNAMIC)
    return simulation


def resolved(context: Context, name: str) -> tuple[Joint, Resolution] | Answer:
    """The derived joint that a name stands for, where it has one freedom; else why not."""
    kinematics = context.kinematics
    if isinstance(kinematics, Outcome):
        return undecided(kinematics.reason, "Run the stages before.")
    found = resolve(context.assembly, kinematics, name)
    if found.joint is None:
        return undecided(f"joint '{name}' is not found: {found.reason}", "Name a joint that geometry has: see KF401.")
    joint = found.joint
    if joint.status == "ambiguous":
        return undecided(f"joint '{name}' is ambiguous: {joint.reason}", "See KF901.")
    if joint.freedoms != 1 or joint.type == "general":
        freedoms = counted(joint.freedoms, "freedom")
        return undecided(
            f"joint '{name}' is {joint.type}, with {freedoms}: one value does not describe it",
            "Require it of a joint with one freedom.",
        )
    return joint, found


def stated_as(context: Context, joint: str) -> tuple[str, int]:
    """The name that the designer gave a joint, else kinform's, and the sign of the designer's values against kinform's."""
    kinematics = context.kinematics
    if isinstance(kinematics, Outcome):
        return joint, 1
    for intended in context.function.joints:
        found = resolve(context.assembly, kinematics, intended.name)
        if found.joint is not None and found.joint.name == joint:
            return intended.name, found.sign
    return joint, 1


def common(context: Context, between: Sequence[str]) -> list[str]:
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
    value = 0.0 if abs(value) < 1e-12 else value
    return f"{number(value, digits)} {'N' if kind_of_value(joint) == 'length' else 'N·m'}"


def bounds(low: float | None, high: float | None, shown: Callable[[float], str]) -> str:
    """The interval that is required, in words."""
    if low is None and high is None:
        return "no bound"
    if low is None or high is None:
        return f"at least {shown(low)}" if low is not None else f"at most {shown(high or 0.0)}"
    return f"{shown(low)} to {shown(high)}"


def _triple(place: Iterable[float] | None) -> tuple[float, float, float] | None:
    if place is None:
        return None
    values: Sequence[float] = [float(v) for v in place]
    return (values[0], values[1], values[2])

"""Whether contact that gives a joint of another type forbids the intended one: what proves it, or why that is open."""

from __future__ import annotations

from kinform.consistency.comparisons.comparison import Comparison, leaves_more
from kinform.consistency.questions.blocked_joints import BlockedJoints
from kinform.foundation.words import counted, quoted
from kinform.frozen import dataclass
from kinform.kinematics.joints.bodies.stated_joints import joint_twists
from kinform.model.assembly import Assembly
from kinform.model.findings import Witness
from kinform.model.kinematics import Kinematics

AT_HUB = (
    "the two links interlock at the hub about the axis of the joint: likely the output of the actuator is drawn in the "
    "mesh of its housing"
)
"""Of a description whose joint is blocked there."""


@dataclass(frozen=True, eq=False)
class Forbidden:
    """An intended joint beside contact that seems to forbid it."""

    witness: Witness | None = None
    """What proves it; None: nothing does."""
    words: str = ""
    """The witness in words; "" of one that the manifest states."""
    doubt: str = ""
    """Why it is not known whether contact forbids it; "" where that is proven."""
    at_hub: bool = False
    """Whether what blocks it may be the actuator of a description."""


def forbidden(
    assembly: Assembly, kinematics: Kinematics, blocked: BlockedJoints | None, c: Comparison
) -> Forbidden | None:
    """What proves that contact forbids an intended joint, or why that is open; None where contact gives the joint, or
    more, or is not decided itself. `blocked` is None without contacts."""
    if c.state not in ("found", "one body") or c.loose or c.right_type or leaves_more(c):
        return None
    derived, motions = derived_type(c), joint_twists(c.intended)
    if blocked is None:
        return Forbidden(doubt=f"contact gives {derived}, and steps need contacts")
    first, second, between = _sides(assembly, kinematics, c)
    stated = blocked.rigid_by_text(first, second)
    if stated is not None:
        return Forbidden(Witness("textual", source_file=stated.file, source_line=stated.line))
    if motions is None:
        return Forbidden(doubt=f"contact gives {derived}, and the joint does not state where its motions are")
    answer = blocked.of(first, second, motions, between, c.intended)
    if answer.witness is not None:
        return Forbidden(answer.witness.record, answer.witness.words(assembly.units))
    if answer.at_hub:
        return Forbidden(doubt=AT_HUB, at_hub=True)
    why = f": {answer.nearest.doubt(assembly.units)}" if answer.nearest is not None else ""
    proof = "no step proves that it forbids the intended motion in both senses"
    return Forbidden(doubt=f"contact gives {derived}, but {proof}{why}")


def derived_type(c: Comparison) -> str:
    """What contact gives instead: "planar (through 'pin')"."""
    if c.state == "one body":
        why = f" ({c.reason})" if c.reason else ""
        return f"fixed: {quoted(c.intended.between)} are parts of one body{why}"
    text = c.type if c.type != "general" else f"general with {counted(c.freedoms, 'freedom')}"
    return text + (f" (through {quoted(c.through)})" if c.through else "")


def _sides(
    assembly: Assembly, kinematics: Kinematics, c: Comparison
) -> tuple[frozenset[str], frozenset[str], frozenset[str]]:
    """Parts of both sides, and of what may go with either."""
    if c.state == "one body":
        first, second = (frozenset(map(str, assembly.parts_of(name))) for name in c.intended.between)
        return first, second, frozenset(map(str, c.bodies[0].parts)) - first - second
    first, second = (frozenset(map(str, body.parts)) for body in c.bodies)
    loose = [kinematics.named_bodies[name] for name in c.through]
    return first, second, frozenset(str(part) for body in loose for part in body.parts)

"""`reaction`: force and torque in a joint during the simulation stay below limits."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from kinform.form.tables import Positive, Reference
from kinform.foundation.words import number
from kinform.frozen import dataclass
from kinform.model.findings import Witness, computed
from kinform.model.kinematics import Joint
from kinform.requirements.answer import Answer, met, undecided, worst_of
from kinform.requirements.bounds import Compared
from kinform.requirements.evidence import Evidence
from kinform.requirements.kind import Fault, Kind, Record
from kinform.requirements.quantity import JOINT, Quantity
from kinform.requirements.runs import PeakProof, peak_beside_limit, simulated
from kinform.requirements.table import RequirementTable

REMEDY = "Lighten or slow what moves, support it better, or take a larger bearing."
COMPUTE = "Run the simulation with a version of kinform that computes reactions."


class Reaction(RequirementTable):
    """The peak reaction in a joint during the simulation stays below a limit."""

    kind: Literal["reaction"]
    joint: Annotated[Reference, JOINT] = Field(description="a [[function.joint]]")
    force: Annotated[Positive | None, Quantity("number", "N")] = Field(None, description="N")
    torque: Annotated[Positive | None, Quantity("number", "N·m")] = Field(None, description="N·m")


@dataclass(frozen=True, eq=False)
class ReactionRecord(Record):
    """A joint carries at most a force (N), at most a torque (N·m), in the simulation."""

    joint: str
    force: float | None = None
    torque: float | None = None


def faults(table: Reaction) -> Iterator[Fault]:
    """No limit."""
    if table.force is None and table.torque is None:
        yield "it limits neither force nor torque", "add force, in N, or torque, in N·m", None


def judge(evidence: Evidence, wanted: ReactionRecord) -> Answer:
    """Peak force and torque beside their limits."""
    name = wanted.joint
    limits = (("torque", "N·m", wanted.torque, slice(0, 3)), ("force", "N", wanted.force, slice(3, 6)))
    if all(limit is None for _, _, limit, _ in limits):
        return undecided("it limits neither force nor torque", "State force, in N, or torque, in N·m.")
    joint = evidence.resolve(name).joint
    if joint is None:
        return undecided(f"joint '{name}' is not found", "See KF401.")
    simulation = simulated(evidence, dynamic=True)
    if isinstance(simulation, Answer):
        return simulation
    if len(simulation.F_A) != len(simulation.time):
        return undecided("the simulation has no reactions", COMPUTE)
    if joint.name not in simulation.joint_names:
        return undecided(f"the simulation does not have the joint '{joint.name}'", COMPUTE)
    index = simulation.joint_names.index(joint.name)
    answers = []
    for key, unit, limit, part in limits:
        if limit is None:
            continue
        if len(simulation.undetermined) > index and simulation.undetermined[index, part].any():
            return undecided(
                f"redundant constraints leave the {key} in joint '{name}' undetermined",
                "Remove the redundant constraints: see KF303.",
            )
        compared = Compared(f"the {key} in joint '{name}'", _shown_in(unit), REMEDY, unit, joint.point)
        sizes = np.linalg.norm(simulation.F_A[:, index, part], axis=1)
        answers.append(
            peak_beside_limit(compared, simulation, sizes, limit, _proof(evidence, joint, limit, key, index))
        )
    margin = answers[0].margin if len(answers) == 1 else None
    return worst_of(answers) or met("; ".join(answer.message for answer in answers), margin=margin)


def _proof(evidence: Evidence, joint: Joint, limit: float, key: str, index: int) -> PeakProof:
    quantity = {"force": 1.0, "torque": 2.0}[key]

    def proof(k: int, value: float) -> Witness | None:
        carried = evidence.carried(joint, k)
        if carried is None:
            return computed("record of a run", value, limit, output=k, column=index, quantity=quantity)
        return computed("effort of motion", value, limit, quantity=quantity, **carried)

    return proof


def _shown_in(unit: str) -> Callable[[float, int], str]:
    return lambda value, digits: f"{number(value, digits)} {unit}"


KIND = Kind(
    "reaction", 100, Reaction, ReactionRecord, judge, faults=faults, needs={"kinematics": "Run `kinform joints`."}
)

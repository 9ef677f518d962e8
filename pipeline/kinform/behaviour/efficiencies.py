"""Efficiencies that the function states of couplings whose ratio geometry gives: which pair of teeth loses them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from kinform.behaviour.components import Gear
from kinform.behaviour.couplings import Imposed
from kinform.frozen import dataclass
from kinform.function import resolve_joint
from kinform.model.assembly import Assembly
from kinform.model.function import Coupling
from kinform.model.kinematics import Coupling as Found
from kinform.model.kinematics import Kinematics
from kinform.model.quantities import Reason


@dataclass(frozen=True)
class Losing:
    """A coupling that loses work, and is not imposed as it is stated."""

    stated: Coupling
    joints: tuple[str, ...]
    """The derived joints that its names stand for, in its order; fewer where one stands for none."""


def stated_losses(assembly: Assembly, kinematics: Kinematics, imposed: Imposed) -> tuple[Losing, ...]:
    """Those that geometry ties already."""
    taken = {number for number, _ in imposed.couplings}
    out = []
    for number, stated in enumerate(assembly.function.couplings, start=1):
        if stated.lossy and number not in taken:
            ends = [resolve_joint(assembly, kinematics, name).joint for name in stated.joints]
            out.append(Losing(stated, tuple(str(joint.name) for joint in ends if joint is not None)))
    return tuple(out)


def lossy(gear: Gear, coupling: Found, losing: Sequence[Losing]) -> Gear:
    """The gear of a pair of teeth with what is stated of its two joints."""
    for one in losing:
        shares = one.stated.efficiency, one.stated.efficiency_back
        if one.joints == coupling.joints:
            return replace(gear, efficiency=shares[0], efficiency_back=shares[1])
        if one.joints == coupling.joints[::-1]:
            return replace(gear, efficiency=shares[1], efficiency_back=shares[0])
    return gear


def lost_nowhere(losing: Sequence[Losing], ties: Iterable[Found]) -> list[Reason]:
    """(subject, why) of efficiencies that no pair of teeth takes."""
    pairs = [set(coupling.joints) for coupling in ties]
    why = (
        "its efficiency is that of no single pair of teeth: state it of the two joints of each pair, and what a thread "
        'loses as friction of its joint (kind = "friction")'
    )
    return [("coupling of " + " and ".join(one.stated.every), why) for one in losing if set(one.joints) not in pairs]

"""Whether the friction of a model is determined: what is said before a run where it is not."""

from __future__ import annotations

from kinform.model.arrays import Array
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.settings import SolverSettings
from kinform.simulation.solver.friction_forces import undetermined
from kinform.simulation.solver.sticking import grouped, ways
from kinform.simulation.subject import Failures


def friction_not_determined(
    dynamics: Dynamics, q: Array, settings: SolverSettings, *, at_rest: bool = False
) -> Failures:
    """(joint, why) of frictions that rigid bodies do not determine at positions q (nq,), or that are not simulated;
    `at_rest`: a single motion is looked at, so that how several stick together plays no part."""
    frictions = dynamics.actuation.frictions
    if not frictions:
        return ()
    kinds = {slot.name: slot.kind.name for slot in dynamics.mechanism.slots}
    for joint in dict.fromkeys(one.joint for one in frictions):
        freedoms = len({one.v for one in frictions if one.joint == joint})
        if freedoms > 1 and kinds[joint] in ("planar", "cylindrical"):
            why = "friction opposes the way in which a surface slides: one for each of its directions is not that"
            return ((joint, f"{why}, and is not simulated"),)
    open_ = undetermined(dynamics, q, settings.free)
    if open_:
        why = (
            "redundant constraints share the load that presses here in ways that rigid bodies do not tell: remove a "
            "redundancy (KF303 names them), say which surfaces rub, give the friction as an effort, or take the least "
            "reactions that balance (least_reactions = true)"
        )
        return tuple((joint, why) for joint in open_)
    dependent = [] if at_rest else grouped(ways(dynamics, dynamics.actuation, q, settings.free))[2]
    if dependent:
        names = ", ".join(dict.fromkeys(frictions[k].joint for k in dependent))
        why = "they move by fewer free motions than there are of them, and by none alone: which stick is not determined"
        return ((names, why),)
    return ()

"""What a joint's drive must give at rest, or in slow motion, with Coulomb friction in the joints.

The joint is held in a pose, as are the other drives and what closes no loop; gravity, loads and springs act. What
holds the joint is then the effort that its drive must give. Friction acts against the motion that is about to begin,
or goes on slowly, and presses on what it follows from: the same problem as in a run
(`simulation.solver.friction_forces`), without motion. Of a power screw these are the formulas of the handbooks.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from kinform.behaviour import RigidBody
from kinform.behaviour.signals import Constant
from kinform.design import Design
from kinform.foundation.rounding import ARITHMETIC, SINGLE
from kinform.frozen import dataclass
from kinform.mechanism.rank import factor, rank_of
from kinform.model.arrays import Array
from kinform.model.function import SimulationRequest
from kinform.simulation import SolverSettings, port_model
from kinform.simulation.mechanism.actuation import Actuation, Stop
from kinform.simulation.mechanism.construction import assemble
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.mechanism.mechanism import Mechanism
from kinform.simulation.solver.friction_determinacy import friction_not_determined
from kinform.simulation.solver.friction_forces import NotDeterminedError, Rub, friction_efforts
from kinform.simulation.solver.run_state import Run
from kinform.simulation.solver.start import Start, Stated, begin


@dataclass(frozen=True)
class Driving:
    """Efforts (N·m or N) along a joint in one pose, in kinform's sense; None: friction allows no such motion, whatever
    the drive gives."""

    without: float
    """That holds it without friction."""
    rest: tuple[float | None, float | None]
    """Between which it stays at rest: below the first it goes backwards, above the second forwards."""
    moving: tuple[float | None, float | None]
    """That move it slowly backwards, and forwards."""

    @property
    def locked(self) -> bool:
        """Whether it stays without any drive."""
        (lower, upper), nothing = self.rest, ARITHMETIC * abs(self.without)
        return (lower is None or lower <= nothing) and (upper is None or upper >= -nothing)

    @property
    def least(self) -> float:
        """N·m or N that a drive must give at least to hold it."""
        ends = [abs(end) for end in self.rest if end is not None]
        return 0.0 if self.locked else min(ends)

    @property
    def efficiency(self) -> float | None:
        """Share of the work of the drive that comes out as it moves against the load; 0 where it cannot. None: there is
        no load."""
        if self.without == 0.0:
            return None
        needed = self.moving[1] if self.without > 0.0 else self.moving[0]
        return 0.0 if needed is None else self.without / needed


def driving(design: Design, joint: str, pose: Mapping[str, float], drives: Sequence[str]) -> Driving | str:
    """The efforts of the derived joint, which has one freedom, or why they are not determined. `pose`: values (rad or
    m) of derived joints; `drives`: derived joints whose drives stand still."""
    assembly, kinematics = design.assembly, design.kinematics
    assert kinematics is not None
    model = port_model(assembly, kinematics, design.mass, contacts=design.contacts, surfaces=design.surfaces)
    for subject, why in (*model.failures, *model.forces_missing):
        return f"{subject}: {why}"
    mechanism, _ = assemble(model.system)
    link_of = dict(zip(mechanism.bodies, mechanism.link_of, strict=True))
    for body in model.system.bodies:
        if isinstance(body, RigidBody) and link_of[body.subject] > 0 and body.mass is None:
            return f"the mass of '{body.subject}' is not known"
    actuation = Actuation(mechanism, model.system, with_mass=False).passive()
    settings = SolverSettings(free=assembly.tolerances.free)
    slots = {slot.name: slot for slot in mechanism.slots}
    stated = [Stated(name, slots[name].q.start, slots[name].v.start, value, 0.0) for name, value in pose.items()]
    start = begin(mechanism, actuation, tuple(stated), settings, coasting=False)
    if start.problem is not None:
        return f"{start.problem[0]}: {start.problem[1]}"
    own = slots[joint].v.start
    still = _still(mechanism, start.q, {own, *(slots[name].v.start for name in drives if name in slots)})
    gravity = np.asarray((assembly.simulation or SimulationRequest()).gravity, dtype=np.float64)
    rows = mechanism.closure_at(start.q)
    loose = _held(mechanism, actuation, start.q, still - {own})
    motion = _motion(mechanism, rows, loose, own, settings.free)
    if motion is None:
        return f"joint '{joint}' cannot move while the other drives stand still: it shares the load with them"
    held = _held(mechanism, actuation, start.q, still)
    rank = rank_of(rows[:, held.free], mechanism.scale[held.free], settings.free)
    dynamics = Dynamics(mechanism, model.system, gravity, held, rank)
    unclear = friction_not_determined(dynamics, start.q, settings, at_rest=True)
    moved = {one.joint for one in actuation.frictions if motion[one.v] != 0.0}
    for subject, why in unclear:
        if subject in moved:
            return f"friction in {subject}: {why}"
    return _efforts(dynamics, start, settings, own, motion)


def _efforts(dynamics: Dynamics, start: Start, settings: SolverSettings, own: int, motion: Array) -> Driving | str:
    """The efforts along the rate `own` for motions both ways, `motion` (n,) being the one forwards."""
    mechanism = dynamics.mechanism
    run = Run(dynamics, Start(start.q, np.zeros(mechanism.rates)), np.zeros(1), settings)
    senses = {
        k: int(np.sign(motion[one.v]))
        for k, one in enumerate(dynamics.actuation.frictions)
        if abs(motion[one.v]) > SINGLE * mechanism.scale[one.v] * abs(motion[own]) / mechanism.scale[own]
    }
    if run.derivative(0.0, run.y.copy(), np.zeros_like(run.y)) < 0.0:
        return "a free motion moves no mass"
    plain = friction_efforts(run, 0.0, run.y, {})
    size = float(np.abs(plain.accelerations / mechanism.scale).max(initial=0.0))
    if size > SINGLE * max(float(np.linalg.norm(dynamics.gravity)) / mechanism.length, SINGLE):
        return "gravity moves more than the drives hold: which joint holds the rest is not stated"

    def effort(way: int, *, at_rest: bool) -> float | None:
        try:
            answer = friction_efforts(run, 0.0, run.y, {k: Rub(way * sense, at_rest) for k, sense in senses.items()})
        except NotDeterminedError:
            return None
        return float(answer.needed[own])

    rest = (effort(-1, at_rest=True), effort(1, at_rest=True))
    return Driving(float(plain.needed[own]), rest, (effort(-1, at_rest=False), effort(1, at_rest=False)))


def _still(mechanism: Mechanism, q: Array, driven: set[int]) -> set[int]:
    """Rates that are held: those of drives, and of what closes no loop."""
    rows = mechanism.closure_at(q)
    looped = np.abs(rows).max(axis=0, initial=0.0) > 0.0 if len(rows) else np.zeros(mechanism.rates, dtype=bool)
    balls = {v for slot in mechanism.slots if slot.has_ball for v in range(slot.v.start, slot.v.stop)}
    return (driven | {v for v in range(mechanism.rates) if not looped[v]}) - balls


def _held(mechanism: Mechanism, actuation: Actuation, q: Array, rates: set[int]) -> Actuation:
    """With these rates held where they are."""
    places = {
        slot.v.start + k: (slot.name, slot.q.start + k)
        for slot in mechanism.slots
        for k in range(slot.v.stop - slot.v.start)
    }
    for v in sorted(rates):
        name, at = places[v]
        actuation = actuation.held(Stop(name, at, v, 1, float(q[at])), Constant(float(q[at])))
    return actuation


def _motion(mechanism: Mechanism, rows: Array, loose: Actuation, own: int, free: float) -> Array | None:
    """(n,) the least motion with the rate `own` at 1; None where there is none."""
    scale = mechanism.scale[loose.free]
    rank = rank_of(rows[:, loose.free], scale, free)
    null = np.zeros((mechanism.rates, len(loose.free) - rank))
    null[loose.free] = factor(rows[:, loose.free], scale, rank).null if rows.size else np.diag(scale)
    part = null[own] / mechanism.scale[own]
    size = float(part @ part)
    return None if size < SINGLE**2 else np.asarray(null @ part / size / mechanism.scale[own])

"""Friction in one state: the efforts that rub, where the loads that press depend on accelerations, and these on them.

Accelerations, what holds need, and with them the wrenches in all joints, are affine in the efforts x of the frictions.
With u ≥ 0 the sizes of those that act in known directions, u = c(u), where
c_i(u) = coefficient · grip(W₀ + Σ u_j W_j) + effort. A grip is a sum of lengths of linear maps (`mechanism.rubbing`),
so that c_i is convex and grows with u_j by no more than L_ij = coefficient · grip_i(W_j). With the spectral radius of L
below 1 there is exactly one answer, which u ← c(u) finds. For a single friction the converse holds too: with L ≥ 1 a
convex function as steep as the diagonal meets it twice or never (Painlevé; Dupont, The effect of Coulomb friction on
the existence and uniqueness of the forward dynamics problem, 1992).
Such a state is refused, not guessed at.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np

from kinform.model.arrays import Array
from kinform.simulation.constants import SLIP_ROUNDS, SLIP_SETTLED, SLIP_STEEPEST, UNDETERMINED_SHARE
from kinform.simulation.kernel import layout
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.mechanism.rubbing import Rubbing
from kinform.simulation.mechanism.states import states_at
from kinform.simulation.outcome.reactions import Network, reactions
from kinform.simulation.solver.run_state import Run

_NETWORKS: WeakKeyDictionary[Dynamics, Network] = WeakKeyDictionary()
"""Of the modes that are run."""


class NotDeterminedError(Exception):
    """Friction has no answer in a state, or several; the text says which joints."""

    def __init__(self, message: str, joints: Sequence[str] = ()):
        super().__init__(message)
        self.joints = tuple(dict.fromkeys(joints))


@dataclass(frozen=True)
class Rub:
    """How one friction acts: against which direction, and by which coefficient."""

    against: int
    """Of the rate: 1 or −1."""
    at_rest: bool = False


@dataclass(frozen=True, eq=False)
class Answer:
    """What the frictions do in one state."""

    efforts: Array
    """(m,) of all of them on their rates; zero for those that stick."""
    grips: Array
    """(m,)."""
    needed: Array
    """(n,) effort that holds and prescribed motions need."""
    accelerations: Array
    """(n,)."""


def dry(run: Run, t: float, y: Array, acting: Mapping[int, Rub]) -> Answer:
    """The frictions `acting`, by their number, in the state y (kernel's order) at t; the others give no effort. Leaves
    the efforts in the tables. Raises NotDeterminedError."""
    dynamics = run.dynamics
    rubbings = dynamics.actuation.frictions
    columns = sorted(acting)
    signs = np.array([-acting[k].against for k in columns], dtype=np.float64)
    trials = np.zeros((1 + len(columns), len(rubbings)))
    for row, (k, sign) in enumerate(zip(columns, signs, strict=True), start=1):
        trials[row, k] = sign
    q, v = dynamics.tables.unpack(y)
    accelerations, given, needed = _respond(run, t, y, trials)
    states = states_at(
        dynamics.mechanism, np.repeat(q[None], len(trials), axis=0), np.repeat(v[None], len(trials), axis=0),
        accelerations,
    )  # fmt: skip
    network = _NETWORKS.get(dynamics)
    if network is None:
        network = _NETWORKS[dynamics] = Network(dynamics)
    times = np.full(len(trials), t)
    wrenches = reactions(dynamics, states, times, given + needed, run.settings.free, network).on_second

    maps = [one.maps(states.poses[0, one.link, :3, :3], q) for one in rubbings]
    owner = np.repeat(np.arange(len(rubbings)), [len(each) for each in maps])
    seen = np.concatenate([each @ wrenches[:, one.number].T for each, one in zip(maps, rubbings, strict=True)])
    base, slopes = seen[:, :, 0], seen[:, :, 1:] - seen[:, :, :1]

    def grips(vectors: Array) -> Array:
        return np.asarray(np.bincount(owner, np.linalg.norm(vectors, axis=1), len(rubbings)), dtype=np.float64)

    u = np.zeros(len(columns))
    if columns:
        pairs = [(rubbings[k], acting[k]) for k in columns]
        least = np.array([_limit(one, rub, 0.0) for one, rub in pairs])
        rates = np.array([_limit(one, rub, 1.0) for one, rub in pairs]) - least
        steep = np.array([rates * grips(slopes[:, :, j])[columns] for j in range(len(columns))]).T
        if float(np.abs(np.linalg.eigvals(steep)).max()) >= SLIP_STEEPEST:
            joints = [one.joint for one, _ in pairs]
            raise NotDeterminedError(_doubt(joints, t), joints)
        for _ in range(SLIP_ROUNDS):
            after = least + rates * grips(base + slopes @ u)[columns]
            moved = float(np.abs(after - u).max())
            u = after
            if moved <= SLIP_SETTLED * float(np.abs(u).max()):
                break
    efforts = np.zeros(len(rubbings))
    efforts[columns] = signs * u
    set_efforts(dynamics, efforts)

    def added(of: Array) -> Array:
        return np.asarray(of[0] + np.tensordot(u, of[1:] - of[0], axes=1))

    return Answer(efforts, grips(base + slopes @ u), added(needed), added(accelerations))


def _limit(one: Rubbing, rub: Rub, grip: float) -> float:
    return float(one.limit(grip, at_rest=rub.at_rest))


def _doubt(joints: list[str], t: float) -> str:
    names = ", ".join(joints)
    return (
        f"at t = {t:.6g} s the friction in {names} presses on what causes it so strongly that the motion is not "
        "determined: there are two, or none (Painlevé). Rigid bodies do not say what happens; less friction, more "
        "inertia on the driven side, or elasticity in the load would"
    )


def _respond(run: Run, t: float, y: Array, trials: Array) -> tuple[Array, Array, Array]:
    """(k, n) accelerations, efforts given and efforts needed for the efforts of the frictions (k, m)."""
    tables, out = run.dynamics.tables, []
    for efforts in trials:
        set_efforts(run.dynamics, efforts)
        run.derivative(t, y.copy(), np.zeros_like(y))
        rows = tables.work[layout.VECTORS][[layout.ACC, layout.GIVEN, layout.NEED], : run.dynamics.mechanism.rates]
        out.append(tables.rates(rows.copy()))
    whole = np.array(out)
    return whole[:, 0], whole[:, 1], whole[:, 2]


def set_efforts(dynamics: Dynamics, efforts: Array) -> None:
    """Write the efforts (m,) of the frictions where the kernel, compiled or not, reads them."""
    tables = dynamics.tables
    for one, effort in zip(dynamics.actuation.frictions, efforts, strict=True):
        row = int(tables.ints[layout.ACTORS][one.actor, layout.LAW])
        tables.nums[layout.SIGNALS][row, 0] = effort
        tables.constants[layout.SIGNALS - 1][row][0] = float(effort)


def undetermined(dynamics: Dynamics, q: Array, free: float) -> tuple[str, ...]:
    """Joints whose friction needs loads that redundant loops share in ways that rigid bodies do not tell."""
    mechanism, still = dynamics.mechanism, np.zeros((1, dynamics.mechanism.rates))
    states = states_at(mechanism, q[None], still, still)
    stresses = reactions(dynamics, states, np.zeros(1), still, free).stresses
    if not len(stresses):
        return ()
    out = []
    for one in dynamics.actuation.frictions:
        friction = one.friction
        size = max(friction.radial, abs(friction.axial), abs(friction.torsion) * mechanism.length)
        grips = one.grip(stresses[:, one.number], states.poses[0, one.link, :3, :3], q)
        if friction.static and not friction.least and grips.max() > UNDETERMINED_SHARE * size:
            out.append(one.joint)
    return tuple(dict.fromkeys(out))

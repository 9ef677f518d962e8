"""Friction in one state: the efforts that rub, where the loads that press depend on accelerations, and these on them.

Accelerations, what holds need, and with them the wrenches in all joints, are affine in the efforts x of the frictions.
With u ≥ 0 the sizes of those that act in known directions, u = c(u), where
c_i(u) = coefficient · grip(W₀ + Σ u_j W_j) + effort. A grip is a sum of lengths of linear maps (`mechanism.rubbing`),
so that c_i is convex and grows with u_j by no more than L_ij = coefficient · grip_i(W_j). With the spectral radius of L
below 1 there is exactly one answer, which u ← c(u) finds. For a single friction the converse holds too: with L ≥ 1 a
convex function as steep as the diagonal meets it twice or never (Painlevé; Dupont, The effect of Coulomb friction on
the existence and uniqueness of the forward dynamics problem, 1992).
Such a state is refused, not guessed at. What gears lose (`mechanism.losses`) is coefficient · (|y| + lean · y sign ω):
its linear part A u goes to the left side, and u ← (1 − A)⁻¹ (c(u) − A u) is as sharp for one of them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from weakref import WeakKeyDictionary

import numpy as np

from kinform.model.arrays import Array, Flags, Ints
from kinform.simulation.constants import (
    DEPENDENT_GEARS,
    SLIP_ROUNDS,
    SLIP_SETTLED,
    SLIP_STEEPEST,
    UNDETERMINED_SHARE,
)
from kinform.simulation.kernel import layout
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.mechanism.efforts import effort_of
from kinform.simulation.mechanism.losses import multipliers
from kinform.simulation.mechanism.rubbing import Rubbing
from kinform.simulation.mechanism.states import States, states_at
from kinform.simulation.outcome.reactions import Network, Reactions, along_rates, reactions
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
    leans: Array
    """(m,) what motion along their rates adds to their grips, and motion against them takes: zero but for what gears
    lose."""
    needed: Array
    """(n,) effort that holds and prescribed motions need."""
    accelerations: Array
    """(n,)."""


def dry(run: Run, t: float, y: Array, acting: Mapping[int, Rub], held: Sequence[int] = ()) -> Answer:
    """The frictions `acting`, by their number, in the state y (kernel's order) at t; the others give no effort, but for
    those `held`, which give what is needed on their rates. Leaves the efforts in the tables. Raises
    NotDeterminedError."""
    dynamics = run.dynamics
    rubbings = dynamics.actuation.frictions
    columns = sorted(acting)
    signs = np.array([-acting[k].against for k in columns], dtype=np.float64)
    trials = np.zeros((1 + len(columns), len(rubbings)))
    for row, (k, sign) in enumerate(zip(columns, signs, strict=True), start=1):
        trials[row, k] = sign
    accelerations, given, needed = _respond(run, t, y, trials)
    seen, owner, passed = _pressing(run, t, y, Responses(trials, accelerations, given, needed), held)
    base, slopes = seen[:, :, 0], seen[:, :, 1:] - seen[:, :, :1]
    lean = np.array([one.lean for one in rubbings])

    def grips(vectors: Array) -> Array:
        return np.asarray(np.bincount(owner, np.linalg.norm(vectors, axis=1), len(rubbings)), dtype=np.float64)

    u = np.zeros(len(columns))
    if columns:
        pairs = [(rubbings[k], acting[k]) for k in columns]
        least = np.array([_limit(one, rub, 0.0) for one, rub in pairs])
        rates = np.array([_limit(one, rub, 1.0) for one, rub in pairs]) - least
        steep = np.array([rates * grips(slopes[:, :, j])[columns] for j in range(len(columns))]).T
        share: Array | None = None
        if lean[columns].any():
            leaning = -signs * rates * lean[columns]
            left = np.eye(len(columns)) - leaning[:, None] * (passed[columns, 1:] - passed[columns, :1])
            least = least + leaning * passed[columns, 0]
            share = np.linalg.inv(left) if np.linalg.det(left) > 0.0 else np.full(left.shape, np.inf)
            steep = np.abs(share) @ steep if np.all(np.isfinite(share)) else np.full(left.shape, 2.0)
        if float(np.abs(np.linalg.eigvals(steep)).max()) >= SLIP_STEEPEST:
            joints = [one.joint for one, _ in pairs]
            raise NotDeterminedError(_doubt(joints, t), joints)
        for _ in range(SLIP_ROUNDS):
            after = least + rates * grips(base + slopes @ u)[columns]
            after = after if share is None else share @ after
            moved = float(np.abs(after - u).max())
            u = after
            if moved <= SLIP_SETTLED * float(np.abs(u).max()):
                break
    efforts = np.zeros(len(rubbings))
    efforts[columns] = signs * u
    set_efforts(dynamics, efforts)

    def added(of: Array) -> Array:
        return np.asarray(of[0] + np.tensordot(u, of[1:] - of[0], axes=1))

    leans = lean * (passed[:, 0] + (passed[:, 1:] - passed[:, :1]) @ u)
    return Answer(efforts, grips(base + slopes @ u), leans, added(needed), added(accelerations))


@dataclass(frozen=True, eq=False)
class Responses:
    """To k trials of efforts (k, m) of the frictions: (k, n) accelerations, efforts given, efforts needed."""

    trials: Array
    accelerations: Array
    given: Array
    needed: Array


def _pressing(run: Run, t: float, y: Array, to: Responses, held: Sequence[int]) -> tuple[Array, Ints, Array]:
    """(b, 3, k) vectors whose lengths are grips, (b,) the friction of each, and (m, k) what lossy gears pass on: for
    the trials of `to`. `held`: frictions that stand for what is needed on their rates."""
    dynamics, rubbings = run.dynamics, run.dynamics.actuation.frictions
    q, v = dynamics.tables.unpack(y)
    count = len(to.trials)
    passed = np.zeros((len(rubbings), count))
    wrenches = np.zeros((count, len(dynamics.system.joints), 6))
    R = np.broadcast_to(np.eye(3), (len(dynamics.mechanism.parent), 3, 3))
    if any(one.loaded for one in rubbings):
        states = states_at(
            dynamics.mechanism, np.repeat(q[None], count, axis=0), np.repeat(v[None], count, axis=0), to.accelerations
        )
        network = _NETWORKS.get(dynamics)
        if network is None:
            network = _NETWORKS[dynamics] = Network(dynamics)
        effort = dynamics.on_bodies(to.given + to.needed, to.accelerations)
        found = reactions(dynamics, states, np.full(count, t), effort, run.settings.free, network)
        wrenches, R = found.on_second, states.poses[0, :, :3, :3]
        for k, one in enumerate(rubbings):
            if one.lost is not None and one.lost.gear >= 0 and found.gears is not None:
                passed[k] = found.gears.efforts[:, one.lost.gear, one.lost.side]
    for k, one in enumerate(rubbings):
        if one.lost is not None and one.lost.gear < 0:
            passed[k] = -_through_motor(run, t, y, to, k, held)
    none = np.zeros((1, 2, count))
    each = [
        one.maps(R[one.link], q) @ wrenches[:, one.number].T
        if one.lost is None
        else np.concatenate([passed[k][None, None], none], axis=1)
        for k, one in enumerate(rubbings)
    ]
    return np.concatenate(each), np.repeat(np.arange(len(rubbings)), [len(rows) for rows in each]), passed


def _through_motor(run: Run, t: float, y: Array, to: Responses, number: int, held: Sequence[int]) -> Array:
    """(k,) what the gear of a motor, whose loss is the friction `number`, gives its joint: what comes from the rotor,
    less what the gear loses."""
    dynamics, one = run.dynamics, run.dynamics.actuation.frictions[number]
    assert one.lost is not None
    own = [number, *([one.lost.brush] if one.lost.brush >= 0 else [])]
    out = to.trials[:, own].sum(axis=1) - dynamics.actuation.armature[one.v] * to.accelerations[:, one.v]
    if one.lost.motor >= 0:
        motor, row = dynamics.actuation.actors[one.lost.motor], dynamics.tables.ints[layout.ACTORS][one.lost.motor]
        q, v = dynamics.tables.unpack(y)
        states = [y[[at]] if at >= 0 else None for at in row[[layout.FIRST_STATE, layout.SECOND_STATE]].tolist()]
        out = out + effort_of(motor, np.array([t]), q[[motor.q]], v[[motor.v]], states)
    others = [k for k in held if dynamics.actuation.frictions[k].v == one.v and k not in own]
    return np.asarray(out if others else out + to.needed[:, one.v])


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
    network = Network(dynamics)
    found = reactions(dynamics, states, np.zeros(1), still, free, network)
    stresses = found.stresses
    shared = _shared_gears(dynamics, states, network, found)
    out = []
    for one in dynamics.actuation.frictions:
        friction = one.friction
        if one.lost is not None:
            if one.lost.gear >= 0 and shared[one.lost.gear]:
                out.append(one.joint)
            continue
        if not len(stresses):
            continue
        size = max(friction.radial, abs(friction.axial), abs(friction.torsion) * mechanism.length)
        grips = one.grip(stresses[:, one.number], states.poses[0, one.link, :3, :3], q)
        if friction.static and not friction.least and grips.max() > UNDETERMINED_SHARE * size:
            out.append(one.joint)
    return tuple(dict.fromkeys(out))


def _shared_gears(dynamics: Dynamics, states: States, network: Network, found: Reactions) -> Flags:
    """(G,) gears of which rigid bodies do not tell what each passes on: redundant with each other, or with loops."""
    mechanism = dynamics.mechanism
    rows = mechanism.gear_v * mechanism.scale
    if not len(rows):
        return np.zeros(0, dtype=np.bool_)
    left, values, _ = np.linalg.svd(rows)
    rank = int(np.count_nonzero(values > DEPENDENT_GEARS * values[0]))
    out = np.abs(left[:, rank:]).max(axis=1, initial=0.0) > UNDETERMINED_SHARE
    if len(found.stresses):
        rest = along_rates(network, states, replace(found, on_second=found.stresses))
        passed = np.abs(multipliers(mechanism, rest)) * np.abs(rows).max(axis=1)
        out |= (passed > UNDETERMINED_SHARE * mechanism.length).any(axis=0)
    return np.asarray(out, dtype=np.bool_)

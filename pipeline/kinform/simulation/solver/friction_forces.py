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

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from weakref import WeakKeyDictionary

import numpy as np

from kinform.foundation.algebra.vectors import norm
from kinform.foundation.rounding import ARITHMETIC, SINGLE, SOLVED
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags
from kinform.simulation.kernel import layout
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.mechanism.losses import multipliers
from kinform.simulation.mechanism.rubbing import Rubbing
from kinform.simulation.mechanism.states import States, states_at
from kinform.simulation.outcome.reactions import Network, Reactions, along_rates, reactions
from kinform.simulation.solver.constants import CONVERGED, MOST_ROUNDS
from kinform.simulation.solver.normal_loads import Responses, Sight, normal_loads, pressing_teeth
from kinform.simulation.solver.run_state import Run

_FLANKS: WeakKeyDictionary[Dynamics, list[int]] = WeakKeyDictionary()
"""With which sides the teeth of their gears pushed last: where to begin."""


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


def friction_efforts(run: Run, t: float, y: Array, acting: Mapping[int, Rub], held: Sequence[int] = ()) -> Answer:
    """The frictions `acting`, by their number, in the state y (kernel's order) at t; the others give no effort, but for
    those `held`, which give what is needed on their rates. Leaves the efforts in the tables. Raises
    NotDeterminedError."""
    dynamics = run.dynamics
    rubbings = dynamics.actuation.frictions
    columns = sorted(acting)
    signs = np.array([-acting[k].against for k in columns], dtype=np.float64)
    trials, size = np.zeros((1 + len(columns), len(rubbings))), _size(dynamics)
    for row, (k, sign) in enumerate(zip(columns, signs, strict=True), start=1):
        trials[row, k] = sign * size
    to = Responses(trials, *_respond(run, t, y, trials), size)
    toothed = pressing_teeth(dynamics)
    flanks = _FLANKS.get(dynamics, [0] * len(dynamics.system.gears))
    for _ in range(2 + 2 * len(toothed)):
        sight = normal_loads(run, t, y, to, held, flanks)
        # The teeth of each gear may push with the other side after all, and press more than these.
        others = [normal_loads(run, t, y, to, held, _flipped(flanks, k)).slopes - sight.slopes for k in toothed]
        u = _settled(t, sight, others, [(rubbings[k], acting[k]) for k in columns], columns)
        pushing = sight.flanks(u, flanks)
        if pushing == flanks or not toothed:
            break
        flanks = pushing
    else:
        names = ", ".join(dynamics.system.gears[k].subject for k in toothed)
        raise NotDeterminedError(f"at t = {t:.6g} s it is not determined which side of the teeth of {names} pushes")
    _FLANKS[dynamics] = flanks
    efforts = np.zeros(len(rubbings))
    efforts[columns] = signs * u
    set_efforts(dynamics, efforts)

    def added(of: Array) -> Array:
        return np.asarray(of[0] + np.tensordot(u, (of[1:] - of[0]) / size, axes=1))

    leans = np.array([one.lean for one in rubbings]) * added(sight.passed.T)
    return Answer(efforts, sight.grips(sight.base + sight.slopes @ u), leans, added(to.needed), added(to.accelerations))


def _size(dynamics: Dynamics) -> float:
    """N·m or N: a power of two near the moment of all weights, one at least."""
    moment = float(dynamics.mass.sum()) * norm(dynamics.gravity) * dynamics.mechanism.length
    return 2.0 ** max(round(math.log2(max(moment, 1.0))), 0)


def _settled(
    t: float, sight: Sight, others: Sequence[Array], pairs: Sequence[tuple[Rubbing, Rub]], columns: Sequence[int]
) -> Array:
    """(k,) the sizes of the frictions that act, `columns` of all. Raises NotDeterminedError."""
    u = np.zeros(len(columns))
    if not pairs:
        return u
    least = np.array([_limit(one, rub, 0.0) for one, rub in pairs])
    rates = np.array([_limit(one, rub, 1.0) for one, rub in pairs]) - least
    grown = [sum(sight.grips(part[:, :, j])[columns] for part in (sight.slopes, *others)) for j in range(len(columns))]
    steep = np.array([rates * grown[j] for j in range(len(columns))]).T
    lean, passed, share = np.array([one.lean for one, _ in pairs]), sight.passed[columns], None
    if lean.any():
        leaning = np.array([rub.against for _, rub in pairs]) * rates * lean
        left = np.eye(len(columns)) - leaning[:, None] * sight.carried[columns]
        least = least + leaning * passed[:, 0]
        share = np.linalg.inv(left) if np.linalg.det(left) > 0.0 else np.full(left.shape, np.inf)
        steep = np.abs(share) @ steep if np.all(np.isfinite(share)) else np.full(left.shape, 2.0)
    # Growth of friction with itself, by the loads that it causes, from which on its answer is not unique: 1, but for
    # rounding of what is solved for (`rounding.SOLVED`).
    if float(np.abs(np.linalg.eigvals(steep)).max()) >= 1.0 - SOLVED:
        joints = [one.joint for one, _ in pairs]
        raise NotDeterminedError(_doubt(joints, t), joints)
    for _ in range(MOST_ROUNDS):  # below `SLIP_STEEPEST` there is one answer; they reach it at up to 0.98 a round
        after = least + rates * sight.grips(sight.base + sight.slopes @ u)[columns]
        after = after if share is None else share @ after
        moved = float(np.abs(after - u).max())
        u = after
        if moved <= CONVERGED * float(np.abs(u).max()):
            break
    return u


def _flipped(flanks: Sequence[int], k: int) -> list[int]:
    return [1 - side if number == k else side for number, side in enumerate(flanks)]


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
        if friction.static and not friction.least and grips.max() > SINGLE * size:
            out.append(one.joint)
    return tuple(dict.fromkeys(out))


def _shared_gears(dynamics: Dynamics, states: States, network: Network, found: Reactions) -> Flags:
    """(G,) gears of which rigid bodies do not tell what each passes on: redundant with each other, or with loops."""
    mechanism = dynamics.mechanism
    rows = mechanism.gear_v * mechanism.scale
    if not len(rows):
        return np.zeros(0, dtype=np.bool_)
    left, values, _ = np.linalg.svd(rows)
    rank = int(np.count_nonzero(values > ARITHMETIC * values[0]))
    out = np.abs(left[:, rank:]).max(axis=1, initial=0.0) > SINGLE
    if len(found.stresses):
        rest = along_rates(network, states, replace(found, on_second=found.stresses))
        passed = np.abs(multipliers(mechanism, rest)) * np.abs(rows).max(axis=1)
        out |= (passed > SINGLE * mechanism.length).any(axis=0)
    return np.asarray(out, dtype=np.bool_)

"""What presses in joints with friction, and what gears that lose pass on, as it follows from the efforts of frictions.

Wrenches in all joints are affine in these efforts, where it is known with which side the teeth of gears push: the
wrenches of some trials say all of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from weakref import WeakKeyDictionary

import numpy as np

from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints
from kinform.simulation.kernel import layout
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.mechanism.efforts import effort_of
from kinform.simulation.mechanism.states import states_at
from kinform.simulation.outcome.gear_forces import on_shafts, toothed
from kinform.simulation.outcome.reactions import Network, reactions
from kinform.simulation.solver.run_state import Run

_NETWORKS: WeakKeyDictionary[Dynamics, Network] = WeakKeyDictionary()
"""Of the modes that are run."""


@dataclass(frozen=True, eq=False)
class Responses:
    """To k trials of efforts (k, m) of the frictions: (k, n) accelerations, efforts given, efforts needed."""

    trials: Array
    accelerations: Array
    given: Array
    needed: Array
    size: float
    """N·m or N of what is tried: of a mechanism of tons, what one newton changes is lost in rounding."""


@dataclass(frozen=True, eq=False)
class Sight:
    """What presses in k trials, where the teeth push with certain sides."""

    seen: Array
    """(b, 3, k) vectors whose lengths are grips."""
    owner: Ints
    """(b,) the friction of each."""
    passed: Array
    """(m, k) what lossy gears pass on."""
    geared: Array
    """(G, k) what all gears give their shafts at a."""
    sides: Ints
    """(G,) as of `gear_forces.Transmitted`."""
    size: float
    """N·m or N of the trials."""

    @property
    def base(self) -> Array:
        """(b, 3) without friction."""
        return self.seen[:, :, 0]

    @property
    def slopes(self) -> Array:
        """(b, 3, k - 1) what a unit of each friction adds."""
        return (self.seen[:, :, 1:] - self.seen[:, :, :1]) / self.size

    @property
    def carried(self) -> Array:
        """(m, k - 1) what a unit of each friction adds to what lossy gears pass on."""
        return (self.passed[:, 1:] - self.passed[:, :1]) / self.size

    def grips(self, vectors: Array) -> Array:
        """(m,) of vectors (b, 3)."""
        return np.asarray(np.bincount(self.owner, np.linalg.norm(vectors, axis=1), len(self.passed)), dtype=np.float64)

    def flanks(self, u: Array, flanks: list[int]) -> list[int]:
        """Which sides push for the sizes u (k - 1,); as they were where nothing is passed on."""
        efforts = self.geared[:, 0] + (self.geared[:, 1:] - self.geared[:, :1]) / self.size @ u
        return [
            before if side < 0 or effort == 0.0 else int(side if effort > 0.0 else 1 - side)
            for before, side, effort in zip(flanks, self.sides, efforts, strict=True)
        ]


def normal_loads(run: Run, t: float, y: Array, to: Responses, held: Sequence[int], flanks: Sequence[int]) -> Sight:
    """What presses in the trials of `to`, in the state y (kernel's order) at t. `held`: frictions that stand for what
    is needed on their rates; `flanks` (G,): the sides with which teeth push."""
    dynamics, rubbings = run.dynamics, run.dynamics.actuation.frictions
    q, v = dynamics.tables.unpack(y)
    count = len(to.trials)
    passed = np.zeros((len(rubbings), count))
    wrenches = np.zeros((count, len(dynamics.system.joints), 6))
    geared, sides = np.zeros((len(flanks), count)), np.full(len(flanks), -1, dtype=np.int64)
    R = np.broadcast_to(np.eye(3), (len(dynamics.mechanism.parent), 3, 3))
    if any(one.loaded for one in rubbings):
        states = states_at(
            dynamics.mechanism, np.repeat(q[None], count, axis=0), np.repeat(v[None], count, axis=0), to.accelerations
        )
        network = _NETWORKS.get(dynamics)
        if network is None:
            network = _NETWORKS[dynamics] = Network(dynamics)
        effort = dynamics.on_bodies(to.given + to.needed, to.accelerations)
        found = reactions(dynamics, states, np.full(count, t), effort, run.settings.free, network, flanks)
        if found.gears is not None:
            geared, sides = found.gears.efforts[:, :, 0].T, found.gears.sides[0]
        wrenches, R = found.on_second.copy(), states.poses[0, :, :3, :3]
        if any(one.thread for one in rubbings) and found.gears is not None:
            effort = effort + on_shafts(dynamics, found.gears)
        for k, one in enumerate(rubbings):
            if one.thread and one.lost is None:
                own = to.trials[:, k] + (to.needed[:, one.v] if k in held else 0.0)
                wrenches[:, one.number, :3] -= (effort[:, one.v] - own)[:, None] * (R[one.link] @ one.axis)
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
    owner = np.repeat(np.arange(len(rubbings)), [len(rows) for rows in each])
    return Sight(np.concatenate(each), owner, passed, geared, sides, to.size)


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


def pressing_teeth(dynamics: Dynamics) -> list[int]:
    """Gears whose teeth press on what rubs by load, by their numbers."""
    if not any(one.loaded and one.lost is None for one in dynamics.actuation.frictions):
        return []
    return np.flatnonzero(toothed(dynamics.system)).tolist()

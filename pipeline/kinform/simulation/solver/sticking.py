"""What sticks and what slips: groups of frictions, held while they stick, and what lets them go.

Frictions whose joints move by one and the same free motion (the bearings of a four-bar) are one group: they stick and
slip together. At rest how they share the load is not determined; that the group slips is: when all of them at their
limits together do not hold it. One of the group is held then, and stands for all.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinform.behaviour.signals import Constant
from kinform.model.arrays import Array
from kinform.simulation import constants
from kinform.simulation.mechanism.actuation import Actuation, Stop
from kinform.simulation.mechanism.closure import factor, rank_of
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.mechanism.rubbing import Rubbing
from kinform.simulation.solver.run_state import Run
from kinform.simulation.solver.slip import Answer, NotDeterminedError, Rub, dry


def ways(dynamics: Dynamics, actuation: Actuation, q: Array, free: float) -> Array:
    """(m, d) how the rates of the frictions, as shares of what moves points about one length, follow from the d free
    motions at positions q (nq,); a row without length is led, or at a dead centre."""
    mechanism = dynamics.mechanism
    loose = actuation.free
    scale, rows = mechanism.scale[loose], mechanism.closure_at(q)[:, loose]
    null = np.zeros((mechanism.rates, len(loose)))
    rank = rank_of(rows, scale, free)
    null = np.zeros((mechanism.rates, len(loose) - rank))
    null[loose] = factor(rows, scale, rank).null if rows.size else np.diag(scale)
    return np.array([null[one.v] / mechanism.scale[one.v] for one in actuation.frictions]).reshape(
        len(actuation.frictions), null.shape[1]
    )


def grouped(rows: Array) -> tuple[list[list[int]], list[int], list[int]]:
    """(groups of frictions that move by one motion, those that are led, those whose motions depend on each other
    otherwise) for the rows (m, d) of `ways`."""
    size = np.linalg.norm(rows, axis=1)
    groups: list[list[int]] = []
    led = []
    for k, row in enumerate(rows):
        if size[k] < constants.DEAD_CENTRE:
            led.append(k)
            continue
        for group in groups:
            other = rows[group[0]] / size[group[0]]
            if float(np.linalg.norm(row / size[k] - (row @ other) / size[k] * other)) < constants.SAME_MOTION:
                group.append(k)
                break
        else:
            groups.append([k])
    firsts = np.array([rows[group[0]] / size[group[0]] for group in groups]).reshape(len(groups), rows.shape[1])
    if len(groups) and np.linalg.matrix_rank(firsts, tol=constants.DEAD_CENTRE) < len(groups):
        return groups, led, [k for group in groups for k in group]
    return groups, led, []


@dataclass(frozen=True)
class Hold:
    """A group that sticks: the one that is held, and the senses (±1) of all as it moves one way."""

    group: int
    held: int
    senses: tuple[tuple[int, int], ...]
    stop: Stop


class Sticking:
    """Which frictions stick in one run, and in which direction the others slip."""

    def __init__(self, run: Run, groups: Sequence[Sequence[int]], led: Sequence[int]):
        """`run`: at its start, nothing held; `groups` and `led` as `grouped` has them."""
        self.run, self.groups, self.led = run, groups, led
        self.base: Actuation = run.dynamics.actuation
        self.rubbings: list[Rubbing] = self.base.frictions
        self.senses = np.zeros(len(self.rubbings), dtype=np.int64)
        """Direction in which each slips; 0: it sticks, or what leads it stands still."""
        self.holds: list[Hold] = []
        self.switches = 0

    @property
    def acting(self) -> dict[int, Rub]:
        """The frictions that slip."""
        return {k: Rub(int(sense)) for k, sense in enumerate(self.senses) if sense}

    @property
    def sticking(self) -> list[bool]:
        """Of each friction, whether its group is held."""
        stuck = {k for hold in self.holds for k, _ in hold.senses}
        return [k in stuck for k in range(len(self.rubbings))]

    def group_of(self, k: int) -> int:
        """The group of a friction; −1 where it is led."""
        return next((g for g, group in enumerate(self.groups) if k in group), -1)

    def begin(self, t: float) -> None:
        """Decide for all groups from the rates at the start. Raises NotDeterminedError."""
        v = self.rates()
        for g, group in enumerate(self.groups):
            if np.all(v[[self.rubbings[k].v for k in group]] == 0.0):
                self._hold(g)
            else:
                for k in group:
                    self.senses[k] = int(np.sign(v[self.rubbings[k].v]))
        self._change()
        self.look_at_led(t)
        self.settle(t)

    def look_at_led(self, t: float) -> None:
        """Directions in which what is led, or has just passed a dead centre, goes."""
        undecided = [k for k in range(len(self.rubbings)) if k in self.led or not (self.senses[k] or self.sticking[k])]
        for k in undecided:
            self.senses[k] = 0
        if not undecided:
            return
        v, a = self.rates(), self.answer(t, self.run.y).accelerations
        for k in undecided:
            at = self.rubbings[k].v
            still = abs(v[at]) <= constants.STICK_ROUNDING * abs(a[at])
            self.senses[k] = int(np.sign(a[at] if still else v[at]))

    def rates(self) -> Array:
        """(n,) now."""
        return self.run.dynamics.tables.unpack(self.run.y)[1]

    def stopped(self, k: int, t: float) -> None:
        """The friction `k` has come to rest: its group is held, or it turns at a dead centre. Raises
        NotDeterminedError."""
        g = self.group_of(k)
        if g < 0:
            self.senses[k] = 0
            self.look_at_led(t)
        elif self._takes_part(k):
            self._hold(g)
            self._change()
        else:
            self.senses[k] = -self.senses[k]
        self.settle(t)

    def settle(self, t: float) -> None:
        """Let go what friction does not hold. Raises NotDeterminedError."""
        while True:
            worst: tuple[float, Hold, int] | None = None
            for hold in self.holds:
                for margin, way in self.margins(hold, t, self.run.y):
                    if margin < 0.0 and (worst is None or margin < worst[0]):
                        worst = margin, hold, way
            if worst is None:
                return
            self.release(worst[1], worst[2], t)

    def margins(self, hold: Hold, t: float, y: Array) -> list[tuple[float, int]]:
        """(share of the limit that is left, which way) both ways in which a held group could go; negative: it slips."""
        senses = dict(hold.senses)
        one = self.rubbings[hold.held]
        out = []
        for way in (1, -1):
            others = {k: Rub(way * sense, at_rest=True) for k, sense in senses.items() if k != hold.held}
            answer = self.answer(t, y, others)
            needed = -way * float(answer.needed[one.v])
            limit = self._limit(hold.held, answer, way)
            out.append((_share(limit - needed, max(limit, abs(needed))), way))
            if not others:
                limit = self._limit(hold.held, answer, -way)
                out.append((_share(limit + needed, max(limit, abs(needed))), -way))
                break
        return out

    def answer(self, t: float, y: Array, others: Mapping[int, Rub] | None = None) -> Answer:
        """What all frictions do, `others` beside those that slip. Raises NotDeterminedError."""
        return dry(self.run, t, y, self.acting | dict(others or {}), [hold.held for hold in self.holds])

    def limits(self, answer: Answer) -> Array:
        """(m,) what each friction takes at most at rest, against what it holds or the way in which it slips."""
        efforts = self.held_effort(answer)
        return np.array([self._limit(k, answer, 1 if effort <= 0.0 else -1) for k, effort in enumerate(efforts)])

    def _limit(self, k: int, answer: Answer, way: int) -> float:
        """What friction k takes at most at rest before it slips that way."""
        return self.rubbings[k].limit(float(answer.grips[k] + way * answer.leans[k]), at_rest=True)

    def release(self, hold: Hold, way: int, t: float) -> None:
        """Let a group go one way. Raises NotDeterminedError where it then would not go there."""
        self.holds.remove(hold)
        for k, sense in hold.senses:
            self.senses[k] = way * sense
        self._change()
        one = self.rubbings[hold.held]
        a, scale = self.answer(t, self.run.y).accelerations, self.run.dynamics.mechanism.scale
        # At the moment of release all that moves it is balanced, but for rounding of what there is without friction.
        size = max(float(np.abs(x / scale).max()) for x in (a, dry(self.run, t, self.run.y, {}).accelerations))
        if way * a[one.v] / scale[one.v] < -constants.DEAD_CENTRE * size:
            raise NotDeterminedError(
                f"at t = {t:.6g} s {one.joint} can neither stick nor slip: more friction than what moves it bears"
            )

    def held_effort(self, answer: Answer) -> Array:
        """(m,) efforts of all frictions, that of a held one being what holds its group."""
        out = answer.efforts.copy()
        for hold in self.holds:
            out[hold.held] = answer.needed[self.rubbings[hold.held].v]
        return out

    def _takes_part(self, k: int) -> bool:
        """Whether the joint moves when its group does, at the present pose."""
        return float(np.linalg.norm(self._rows()[k])) > constants.DEAD_CENTRE

    def _rows(self) -> Array:
        run = self.run
        return ways(run.dynamics, self.base, run.dynamics.tables.unpack(run.y)[0], run.settings.free)

    def _hold(self, g: int) -> None:
        rows, group = self._rows(), self.groups[g]
        held = max(group, key=lambda k: float(np.linalg.norm(rows[k])))
        senses = tuple((k, 1 if float(rows[k] @ rows[held]) >= 0.0 else -1) for k in group)
        one = self.rubbings[held]
        value = float(self.run.dynamics.tables.unpack(self.run.y)[0][one.q])
        self.holds.append(Hold(g, held, senses, Stop(one.joint, one.q, one.v, 1, value)))
        self.senses[list(group)] = 0

    def _change(self) -> None:
        """Go on with what is held now."""
        run, actuation = self.run, self.base
        self.switches += 1
        for hold in self.holds:
            actuation = actuation.held(hold.stop, Constant(hold.stop.limit))
        old = run.dynamics
        run.change(Dynamics(old.mechanism, old.system, old.gravity, actuation, run.rank(actuation.free)))
        run.project(float(run.clock[0]), run.y)


def _share(left: float, size: float) -> float:
    """What is left of a limit as a share of the greater of it and what is needed; 0 within rounding."""
    return 0.0 if abs(left) <= constants.STICK_ROUNDING * size else left / size

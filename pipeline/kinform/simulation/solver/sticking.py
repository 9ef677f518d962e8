"""What sticks and what slips: groups of frictions, held while they stick, and what lets them go.

Frictions whose joints move by one and the same free motion (the bearings of a four-bar) are one group: they stick and
slip together. At rest how they share the load is not determined; that the group slips is: when all of them at their
limits together do not hold it. One of the group is held then, and stands for all. Where a joint of the group rests at
an end stop, the group is held too, and does not go beyond it (`friction_stops`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from kinform.behaviour.signals import Constant
from kinform.foundation.rounding import ARITHMETIC, SINGLE, SOLVED
from kinform.frozen import dataclass
from kinform.mechanism.rank import factor, rank_of
from kinform.model.arrays import Array
from kinform.simulation.mechanism.actuation import Actuation, Stop
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.mechanism.rubbing import Rubbing
from kinform.simulation.solver.friction_forces import Answer, NotDeterminedError, Rub, friction_efforts
from kinform.simulation.solver.run_state import Run


def ways(dynamics: Dynamics, actuation: Actuation, q: Array, free: float, rates: Sequence[int] | None = None) -> Array:
    """(m, d) how the rates of the frictions (or these), as shares of what moves points about one length, follow from
    the d free motions at positions q (nq,); a row without length is led, or at a dead centre."""
    mechanism = dynamics.mechanism
    loose = actuation.free
    scale, rows = mechanism.scale[loose], mechanism.closure_at(q)[:, loose]
    null = np.zeros((mechanism.rates, len(loose)))
    rank = rank_of(rows, scale, free)
    null = np.zeros((mechanism.rates, len(loose) - rank))
    null[loose] = factor(rows, scale, rank).null if rows.size else np.diag(scale)
    rates = [one.v for one in actuation.frictions] if rates is None else rates
    return np.array([null[v] / mechanism.scale[v] for v in rates]).reshape(len(rates), null.shape[1])


def grouped(rows: Array) -> tuple[list[list[int]], list[int], list[int]]:
    """(groups of frictions that move by one motion, those that are led, those whose motions depend on each other
    otherwise) for the rows (m, d) of `ways`."""
    size = np.linalg.norm(rows, axis=1)
    groups: list[list[int]] = []
    led = []
    for k, row in enumerate(rows):
        if size[k] < SINGLE:
            led.append(k)
            continue
        for group in groups:
            other = rows[group[0]] / size[group[0]]
            if float(np.linalg.norm(row / size[k] - (row @ other) / size[k] * other)) < SOLVED:
                group.append(k)
                break
        else:
            groups.append([k])
    firsts = np.array([rows[group[0]] / size[group[0]] for group in groups]).reshape(len(groups), rows.shape[1])
    if len(groups) and np.linalg.matrix_rank(firsts, tol=SINGLE) < len(groups):
        return groups, led, [k for group in groups for k in group]
    return groups, led, []


@dataclass(frozen=True)
class Hold:
    """A group that sticks: the one that is held, and the senses (±1) of all as it moves one way."""

    group: int
    """−1: a joint without friction that rests at an end stop."""
    held: int
    senses: tuple[tuple[int, int], ...]
    stop: Stop
    blocked: int = 0
    """Which way an end stop does not let it go; 0: it rests at none."""


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
        self.resting: list[int] = []
        """End stops at which joints rest."""
        self.switches = self.impacts = 0
        self.struck: list[str] = []
        """Joints that have struck an end stop."""

    @property
    def acting(self) -> dict[int, Rub]:
        """The frictions that slip."""
        return {k: Rub(int(sense)) for k, sense in enumerate(self.senses) if sense}

    @property
    def sticking(self) -> list[bool]:
        """Of each friction, whether its group is held."""
        stuck = {k for hold in self.holds for k, _ in hold.senses}
        return [k in stuck for k in range(len(self.rubbings))]

    @property
    def bare(self) -> list[int]:
        """End stops at which joints without friction rest."""
        rubbed = {one.v for one in self.rubbings}
        return [k for k in self.resting if self.base.stops[k].v not in rubbed]

    def group_of(self, k: int) -> int:
        """The group of a friction; −1 where it is led."""
        return next((g for g, group in enumerate(self.groups) if k in group), -1)

    def begin(self, t: float) -> None:
        """Decide for all groups from the rates now. Raises NotDeterminedError."""
        v = self.rates()
        self.holds, self.senses[:] = [], 0
        for k in self.bare:
            stop = self.base.stops[k]
            self.holds.append(Hold(-1, -1, (), stop, stop.sense))
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
            still = abs(v[at]) <= ARITHMETIC * abs(a[at])
            self.senses[k] = int(np.sign(a[at] if still else v[at]))

    def let_all_go(self) -> None:
        """Hold nothing, as in an impact."""
        self.holds, self.senses[:] = [], 0
        self._change()

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
        if hold.group < 0:
            pull = hold.stop.sense * float(self.answer(t, y).needed[hold.stop.v])
            return [(-pull, -hold.blocked), (np.inf, hold.blocked)]
        free = self._ways_free(hold, t, y)
        return [(np.inf if way == hold.blocked else margin, way) for margin, way in free]

    def _ways_free(self, hold: Hold, t: float, y: Array) -> list[tuple[float, int]]:
        """The same where no end stop blocks it."""
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
        held = [hold.held for hold in self.holds if hold.group >= 0]
        return friction_efforts(self.run, t, y, self.acting | dict(others or {}), held)

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
        self.resting = [k for k in self.resting if self.base.stops[k].v != hold.stop.v]
        for k, sense in hold.senses:
            self.senses[k] = way * sense
        self._change()
        if hold.group < 0:
            return
        one = self.rubbings[hold.held]
        a, scale = self.answer(t, self.run.y).accelerations, self.run.dynamics.mechanism.scale
        # At the moment of release all that moves it is balanced, but for rounding of what there is without friction.
        size = max(
            float(np.abs(x / scale).max()) for x in (a, friction_efforts(self.run, t, self.run.y, {}).accelerations)
        )
        if way * a[one.v] / scale[one.v] < -SINGLE * size:
            raise NotDeterminedError(
                f"at t = {t:.6g} s {one.joint} can neither stick nor slip: more friction than what moves it bears"
            )

    def held_effort(self, answer: Answer) -> Array:
        """(m,) efforts of all frictions, that of a held one being what holds its group."""
        out = answer.efforts.copy()
        for hold in self.holds:
            if hold.group < 0:
                continue
            needed = float(answer.needed[hold.stop.v])
            if hold.blocked * needed < 0.0:
                # What friction cannot take, pressed against an end stop, that takes.
                needed = -hold.blocked * min(abs(needed), self._limit(hold.held, answer, hold.blocked))
            out[hold.held] = needed
        return out

    def _takes_part(self, k: int) -> bool:
        """Whether the joint moves when its group does, at the present pose."""
        return float(np.linalg.norm(self._rows()[k])) > SINGLE

    def _rows(self) -> Array:
        run = self.run
        return ways(run.dynamics, self.base, run.dynamics.tables.unpack(run.y)[0], run.settings.free)

    def _hold(self, g: int) -> None:
        rows, group = self._rows(), self.groups[g]
        against = {self.base.stops[k].v: self.base.stops[k].sense for k in self.resting}
        at_stop = [k for k in group if self.rubbings[k].v in against]
        held = max(at_stop or group, key=lambda k: float(np.linalg.norm(rows[k])))
        senses = tuple((k, 1 if float(rows[k] @ rows[held]) >= 0.0 else -1) for k in group)
        one = self.rubbings[held]
        value = float(self.run.dynamics.tables.unpack(self.run.y)[0][one.q])
        blocked = against.get(one.v, 0)
        self.holds.append(Hold(g, held, senses, Stop(one.joint, one.q, one.v, 1, value), blocked))
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
    """What is left of a limit as a share of the greater of it and what is needed; 0 within rounding: a block on a slope
    of exactly atan μ stays."""
    return 0.0 if abs(left) <= ARITHMETIC * size else left / size

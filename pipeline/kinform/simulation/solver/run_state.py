"""The state of one dynamic run: what the kernel changes, and what has come out so far."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kinform.model.arrays import Array
from kinform.simulation.kernel import layout
from kinform.simulation.mechanism.closure import rank_of
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.outcome.record import Record
from kinform.simulation.solver.engine import Engine
from kinform.simulation.solver.settings import SolverSettings
from kinform.simulation.solver.start import Start

__all__ = ["Run"]


class Run:
    """One run: `y` at clock[NOW], and the outputs so far."""

    def __init__(self, dynamics: Dynamics, start: Start, times: Array, settings: SolverSettings):
        self.dynamics, self.settings = dynamics, settings
        self.times = np.ascontiguousarray(times, dtype=np.float64)
        self.y = dynamics.tables.pack(start.q, start.v)
        n = dynamics.mechanism.rates
        self.out = np.zeros((len(times), len(self.y) + 3 * n))
        self.outputs = (self.times[None], self.out)
        self.rows = ([self.times.tolist()], self.out)
        """The same for functions that are not compiled."""
        self.clock, self.tally = np.zeros(layout.CLOCK), np.zeros(8, dtype=np.int64)
        self.clock[layout.NOW] = times[0]
        self.clock[layout.RTOL], self.clock[layout.ATOL] = settings.rtol, settings.atol
        self.clock[layout.CLOSED], self.clock[layout.OPEN] = settings.closed, settings.open
        self.clock[layout.NEAR], self.clock[layout.KEEP] = settings.near, settings.keep
        self.clock[layout.MARGIN], self.clock[layout.PATIENCE] = np.inf, 15.0 if settings.method == "auto" else np.inf
        self.notes: list[str] = []
        dynamics.place(start.q, start.v)

    def begin(self, engine: Engine) -> bool:
        """Sample the start; False when a free motion has no mass there."""
        self.clock[layout.END] = np.inf
        y = self.y.copy()
        engine.project(self, float(self.times[0]), y)
        self.y[:] = y
        if engine.derivative(self, float(self.times[0]), y, np.zeros_like(y)) < 0.0:
            return False
        engine.sample(self, float(self.times[0]), y, self.out[0])
        self.tally[layout.NEXT] = 1
        return True

    def open_stretch(self, begin: float, end: float) -> None:
        """Prepare for laws that are smooth from begin to end."""
        self.clock[layout.END] = end
        self.dynamics.tables.nums[layout.CONSTANTS][0, layout.LAST] = np.nextafter(end, begin)
        self.clock[layout.STEP] = min(1e-3, end - begin)
        self.tally[layout.FRESH], self.tally[layout.STIFF] = 1, 0

    def change(self, dynamics: Dynamics) -> None:
        """Go on with other dynamics from the present state."""
        last = self.dynamics.tables.nums[layout.CONSTANTS][0, layout.LAST]
        self.dynamics = dynamics
        dynamics.tables.nums[layout.CONSTANTS][0, layout.LAST] = last
        self.choose()
        self.tally[layout.FRESH], self.tally[layout.STIFF] = 1, 0

    def choose(self) -> None:
        """Choose independent rows of the loops at the present pose."""
        self.dynamics.place(*self.dynamics.tables.unpack(self.y))

    def rank(self, free: NDArray[np.int64]) -> int:
        """Rank of the loops for these rates at the present pose."""
        mechanism = self.dynamics.mechanism
        q, _ = self.dynamics.tables.unpack(self.y)
        rows = mechanism.closure(mechanism.screws(mechanism.poses(q)))
        return rank_of(rows[:, free], mechanism.scale[free], self.settings.free)

    def loops(self) -> str:
        """The joints of the loops that are worst off at the present pose, as a clause."""
        mechanism = self.dynamics.mechanism
        if not mechanism.closed:
            return ""
        q, _ = self.dynamics.tables.unpack(self.y)
        rows = mechanism.closure(mechanism.screws(mechanism.poses(q)))
        touched = np.abs(rows).max(axis=0) > 0.0
        names = [slot.name for slot in mechanism.slots if touched[slot.v].any()]
        return f", in the loops of {', '.join(names)}"

    def record(self, stopped: str) -> Record:
        """What there is, with a warning where the loops came close to a singular pose."""
        done = int(self.tally[layout.NEXT])
        size, n = len(self.y), self.dynamics.mechanism.rates
        q, v = self.dynamics.tables.unpack(self.out[:done, :size])
        acceleration, given, needed = (
            self.dynamics.tables.rates(self.out[:done, k : k + n]) for k in (size, size + n, size + 2 * n)
        )
        notes = list(self.notes)
        passed = not stopped or self.clock[layout.TIGHTEST] < self.clock[layout.NOW] - 1e-3
        if passed and self.clock[layout.MARGIN] < self.settings.doubtful:
            notes.append(
                f"near t = {self.clock[layout.TIGHTEST]:.4g} s the loops pass a singular pose, where they could go "
                "on in several ways: taken is the one that the momentum continues"
            )
        return Record(
            time=self.times[:done].copy(), q=q, v=v, acceleration=acceleration, effort=given + needed, needed=needed,
            extra=self.out[:done, q.shape[1] + n : size - 1].copy(), work=self.out[:done, size - 1].copy(),
            stopped=stopped, notes=tuple(notes),
        )  # fmt: skip

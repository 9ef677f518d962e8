"""One dynamic run: its state, which the kernel changes, the calls of the kernel, and what has come out so far."""

from __future__ import annotations

import numpy as np

from kinform.mechanism.rank import rank_of
from kinform.model.arrays import Array, Ints
from kinform.model.simulation import Damping
from kinform.simulation.kernel import layout
from kinform.simulation.kernel.calls import Engine, engine
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.record import Record
from kinform.simulation.settings import SolverSettings
from kinform.simulation.solver.start import Start

FIRST_STEP = 1e-3
"""s: the first step that is tried in a stretch; the control finds the right one in a few steps."""
STIFF_PATIENCE = 15.0
"""Steps in a row that a decay kept short before the run is looked at for stiffness: those of Hairer's DOP853."""
PASSED_BEFORE_STOP = 1e-3
"""s: a singular pose nearer than this to where a run stopped is why it did, and was not passed. A choice: steps that
shrink towards one are far shorter."""
APPROACHED = 3e-3
"""Margin below which a step that ends there was not laid across a singular pose ahead, but came too near. A pose that
could not be crossed is behind from three times this on. Choices: forty four-bars in a row never come above 0.05."""


class Run:
    """One run: `y` at clock[NOW], and the outputs so far."""

    def __init__(self, dynamics: Dynamics, start: Start, times: Array, settings: SolverSettings):
        """A run from its start, with outputs at `times` (t,) s; nothing is compiled yet."""
        self.dynamics, self.settings = dynamics, settings
        self.engine: Engine = engine(compiled=False)
        self.times = np.ascontiguousarray(times, dtype=np.float64)
        self.y = dynamics.tables.pack(start.q, start.v)
        n = dynamics.mechanism.rates
        self.out = np.zeros((len(times), len(self.y) + 3 * n))
        self.outputs = (self.times[None], self.out)
        self.rows = ([self.times.tolist()], self.out)
        """The same for functions that are not compiled."""
        self.clock, self.tally = np.zeros(layout.CLOCK), np.zeros(layout.TALLY, dtype=np.int64)
        self.clock[layout.NOW] = times[0]
        self.clock[layout.RTOL], self.clock[layout.ATOL] = settings.rtol, settings.atol
        self.clock[layout.CLOSED], self.clock[layout.OPEN] = settings.closed, settings.open
        self.clock[layout.NEAR], self.clock[layout.KEEP] = settings.near, settings.keep
        self.clock[layout.MARGIN], self.clock[layout.PATIENCE] = (
            np.inf,
            STIFF_PATIENCE if settings.method == "auto" else np.inf,
        )
        self.clock[layout.NARROW] = dynamics.mechanism.narrow
        self.clock[layout.APPROACH] = APPROACHED
        self.notes: list[str] = []
        self.dampings: list[Damping] = []
        """Vibrations that the method has damped."""
        dynamics.place(start.q, start.v)

    def advance(self) -> int:
        """Integrate; see `kernel.explicit.advance`."""
        outputs = self.outputs if self.engine.compiled else self.rows
        return int(self.engine.call("advance", self.dynamics.tables, self.y, self.clock, self.tally, outputs))

    def derivative(self, t: float, y: Array, dy: Array) -> float:
        """See `kernel.equations.derivative`."""
        return float(self.engine.call("derivative", self.dynamics.tables, t, y, dy))

    def project(self, t: float, y: Array) -> tuple[float, float]:
        """(gap left, smallest pivot over that of its choice); see `kernel.equations.project`."""
        tables = self.dynamics.tables
        gap = float(self.engine.call("project", tables, t, y, self.settings.closed, False))
        return gap, float(tables.work[layout.VECTORS][layout.KEPT, 0])

    def sample(self, t: float, y: Array, out: Array) -> None:
        """Write an output; see `kernel.explicit.sample`."""
        self.engine.call("sample", self.dynamics.tables, self.clock, t, y, out)

    def begin(self) -> bool:
        """Sample the start; False when a free motion has no mass there."""
        start = float(self.times[0])
        self.clock[layout.END] = np.inf
        y = self.y.copy()
        self.project(start, y)
        self.y[:] = y
        if self.derivative(start, y, np.zeros_like(y)) < 0.0:
            return False
        self.sample(start, y, self.out[0])
        self.tally[layout.NEXT] = 1
        return True

    def open_stretch(self, begin: float, end: float) -> None:
        """Prepare for laws that are smooth from begin to end."""
        self.clock[layout.END] = end
        self.dynamics.tables.nums[layout.CONSTANTS][0, layout.LAST] = np.nextafter(end, begin)
        self.clock[layout.STEP] = min(FIRST_STEP, end - begin)
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

    def rank(self, free: Ints) -> int:
        """Rank of the loops for these rates at the present pose."""
        mechanism = self.dynamics.mechanism
        rows = mechanism.closure_at(self.dynamics.tables.unpack(self.y)[0])
        return rank_of(rows[:, free], mechanism.scale[free], self.settings.free)

    def loops(self) -> str:
        """The joints of the loops that are worst off at the present pose, as a clause."""
        mechanism = self.dynamics.mechanism
        if not mechanism.closed:
            return ""
        touched = np.abs(mechanism.closure_at(self.dynamics.tables.unpack(self.y)[0])).max(axis=0) > 0.0
        names = [slot.name for slot in mechanism.slots if touched[slot.v].any()]
        return f", in the loops of {', '.join(names)}"

    def look_ahead(self, wanted: bool) -> None:
        """Whether the kernel is to come back where a step ends near a singular pose; after one that could not be leaped
        over, not before it is far behind."""
        if wanted and self.clock[layout.MARGINS] > 3.0 * APPROACHED:
            self.clock[layout.APPROACH] = APPROACHED
        elif not wanted:
            self.clock[layout.APPROACH] = 0.0

    def limit(self) -> str:
        """That what is led has come to a limit position at the present pose, in words; "" where it has not."""
        mechanism, led = self.dynamics.mechanism, self.dynamics.actuation.led
        q = self.dynamics.tables.unpack(self.y)[0]
        return mechanism.limit(led) if mechanism.at_limit(q, led, self.dynamics.rank) else ""

    def folds(self) -> bool:
        """Whether branches of the motion meet at the present pose, as far as lengths are known."""
        return self.dynamics.mechanism.folds(self.dynamics.tables.unpack(self.y)[0], self.dynamics.rank)

    def _notes_of_dampings(self) -> tuple[str, ...]:
        """What is to be said of vibrations that the method has damped."""
        if not self.dampings:
            return ()
        frequency, lost = max(one.frequency for one in self.dampings), sum(one.energy for one in self.dampings)
        return (
            f"from t = {self.dampings[0].since:.4g} s on vibrations of the springs, of up to {frequency:.4g} Hz, are "
            f"damped by the method, as following them would take more than {self.settings.steps} steps: "
            f"{lost:.4g} J go with them, and what is computed is the motion about which they swing",
        )

    def record(self, stopped: str) -> Record:
        """What there is, with a warning where the loops came close to a singular pose."""
        done = int(self.tally[layout.NEXT])
        size, n = len(self.y), self.dynamics.mechanism.rates
        q, v = self.dynamics.tables.unpack(self.out[:done, :size])
        acceleration, driven, needed = (
            self.dynamics.tables.rates(self.out[:done, k : k + n]) for k in (size, size + n, size + 2 * n)
        )
        notes = list(self.notes)
        passed = not stopped or self.clock[layout.TIGHTEST] < self.clock[layout.NOW] - PASSED_BEFORE_STOP
        if passed and self.clock[layout.MARGIN] < self.settings.doubtful:
            notes.append(
                f"near t = {self.clock[layout.TIGHTEST]:.4g} s the loops pass a singular pose, where they could go "
                "on in several ways: taken is the one that the momentum continues"
            )
        return Record(
            time=self.times[:done].copy(), q=q, v=v, acceleration=acceleration, effort=driven + needed, needed=needed,
            extra=self.out[:done, q.shape[1] + n : size - 1].copy(), work=self.out[:done, size - 1].copy(),
            stopped=stopped, notes=(*notes, *self._notes_of_dampings()), dampings=tuple(self.dampings),
        )  # fmt: skip

"""Motion under forces, through time: from one end stop, knot of a law or change of method to the next.

The kernel integrates with DOP853 and closes loops after each step. Where it finds the model stiff the
implicit method takes over. Short runs are made by the kernel's functions as they are, which give the same
to the last bit: importing and compiling them would take longer.
"""

from __future__ import annotations

import numpy as np

from kinform.model.arrays import Array
from kinform.simulation.kernel import layout
from kinform.simulation.kernel.calls import by_articulated_bodies, engine, is_loaded, ready
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.record import Record
from kinform.simulation.settings import Conduct
from kinform.simulation.solver.constants import LOOK
from kinform.simulation.solver.implicit import run_implicit
from kinform.simulation.solver.run_state import Run
from kinform.simulation.solver.singular_crossing import cross_singular_pose
from kinform.simulation.solver.start import Start
from kinform.simulation.solver.stiffness import is_stiff, vibration
from kinform.simulation.solver.stops import Contact

PLAIN = 20_000
"""Evaluations times links that are made without the compiled functions: 25 μs each, 60 in loops, so 0.5 to 1.2 s, about
as long as loading them takes."""
SHOWN = 60
"""Steps from which on the length of the whole run can be told: the first dozen grow from a short one. A choice."""
LARGE = 1000
"""Rates times independent rows of the loops (32 of each) from which on plain functions take too long at all. A
choice."""
STALL = 1000
"""Steps after which a run is asked how far they have brought it. It counts as stalled where at their pace it would take
ten times its budget: a choice."""
REPORTS = 50
"""Times at least that the progress of a run is reported: every 2 %."""


def run_dynamic(dynamics: Dynamics, start: Start, times: Array, conduct: Conduct) -> Record:
    """Positions, rates, efforts and work at `times` (s), until the end or until it cannot go on."""
    first, last = float(times[0]), float(times[-1])
    knots = [knot for knot in dynamics.actuation.knots if first < knot < last]
    run = Run(dynamics, start, times, conduct.settings)
    driver = _Driver(run, conduct)
    if not run.begin():
        return run.record(f"after t = {first:.6g} s a free motion moves no mass")
    for begin, end in zip([first, *knots], [*knots, last], strict=True):
        why = driver.stretch(begin, end) if end > begin else ""
        if why:
            return run.record(why)
    return run.record("")


_GOING = (layout.DONE, layout.PAUSED, layout.SPENT, layout.STIFFENED, layout.WORN, layout.NEARING)
"""The kernel came back, and the run goes on."""
_AT_SINGULAR_POSES = (layout.NEARING, layout.TURNED, layout.STUCK)
"""It came back where the pose may be singular."""


class _Driver:
    """Calls the kernel until a stretch is done."""

    def __init__(self, run: Run, conduct: Conduct):
        self.run, self.progress, self.say = run, conduct.progress, conduct.say
        self.contact = Contact(run)
        self.looked = 0
        self.mark = (0, float(run.times[0]))
        # Times more where they would have to be compiled first, which takes ten seconds.
        share = PLAIN if ready(run.dynamics.tables) else PLAIN * 10
        self.plain = max(1, share // len(run.dynamics.mechanism.parent))
        """Evaluations."""
        if run.dynamics.mechanism.rates * run.dynamics.rank > LARGE:
            self._compile()

    def stretch(self, begin: float, end: float) -> str:
        """Integrate over a stretch in which all laws are smooth; why it stopped, or ""."""
        run = self.run
        run.open_stretch(begin, end)
        if run.settings.method == "implicit":
            run.engine = engine(compiled=is_loaded(run.dynamics.tables))
            return run_implicit(run, self.contact, self._report)
        while True:
            status = self._advance()
            self._report()
            if status in (*_GOING, layout.STOPPED) and self.contact.release_if_pulled():
                status = layout.SPENT
            if status == layout.DONE and run.clock[layout.NOW] >= run.clock[layout.END]:
                return ""
            crossed = cross_singular_pose(run) if status in _AT_SINGULAR_POSES else ""
            if crossed is None:
                continue
            if crossed:
                return crossed
            run.look_ahead(status != layout.NEARING)
            if status == layout.STOPPED:
                why = self.contact.strike()
            elif status in (layout.STIFFENED, layout.SPENT, layout.PAUSED) and self._looks():
                fastest = self._fastest()
                stiff = fastest > 0.0 or is_stiff(run)
                why = run_implicit(run, self.contact, self._report, fastest) if stiff else self._problem(status)
            else:
                why = self._problem(status)
            if why:
                return why

    def _advance(self) -> int:
        """One call of the kernel, compiled once the run has shown to be long."""
        run, tally = self.run, self.run.tally
        if not run.engine.compiled and (is_loaded(run.dynamics.tables) or self._long()):
            self._compile()
        left = run.settings.steps - int(tally[layout.STEPS])
        tally[layout.BUDGET] = 1 if self.contact.holding else min(left, LOOK if run.engine.compiled else SHOWN)
        tally[layout.PAUSE] = tally[layout.NEXT] + max(1, len(run.times) // REPORTS)
        run.clock[layout.STEP] = min(run.clock[layout.STEP], self.contact.longest())
        self.contact.remember()
        return run.advance()

    def _long(self) -> bool:
        """Whether the run takes so many evaluations, of steps and of outputs, that compiling pays, by those so far."""
        run, tally = self.run, self.run.tally
        made = int(tally[layout.SLOPES] + tally[layout.NEXT])
        done = (run.clock[layout.NOW] - run.times[0]) / (run.times[-1] - run.times[0])
        # Times the plain evaluations that a run must promise to take before it is compiled early: its pace may change.
        # A choice.
        return made >= self.plain or (int(tally[layout.STEPS]) >= SHOWN and made > 1.5 * self.plain * done)

    def _looks(self) -> bool:
        """Whether it is time to ask if the implicit method is to go on."""
        run = self.run
        run.tally[layout.STIFF] = 0
        if run.settings.method == "explicit" or run.tally[layout.STEPS] < self.looked + LOOK:
            return False
        self.looked = int(run.tally[layout.STEPS])
        return True

    def _fastest(self) -> float:
        """The vibration that would use up the steps that are left; 0 without."""
        run = self.run
        left = run.settings.steps - int(run.tally[layout.STEPS])
        return vibration(run, float(run.clock[layout.STEP]), float(left))

    def _stalled(self) -> bool:
        """Whether STALL steps have brought the run on by less than a share of it that would ever end."""
        run, (steps, t) = self.run, self.mark
        if run.tally[layout.STEPS] < steps + STALL:
            return False
        self.mark = int(run.tally[layout.STEPS]), float(run.clock[layout.NOW])
        share = STALL / (10.0 * run.settings.steps)
        return bool(self.mark[1] - t < share * (run.times[-1] - run.times[0]))

    def _compile(self) -> None:
        tables = self.run.dynamics.tables
        if self.say is not None and not ready(tables):
            self.say("compiling the equations of motion: some seconds, once on this machine")
        self.run.engine = engine(compiled=True, articulated_bodies=by_articulated_bodies(tables))

    def _problem(self, status: int) -> str:
        """Why the run cannot go on, or "" when it can."""
        run, t = self.run, float(self.run.clock[layout.NOW])
        if status == layout.WORN:
            run.choose()
        if status in _GOING:
            if self._stalled():
                if run.limit():
                    return f"at t = {t:.6g} s {run.limit()}{run.loops()}"
                return (
                    f"at t = {t:.6g} s the steps become too short to get on: "
                    f"the mechanism is singular there or the model is stiff{run.loops()}"
                )
            if run.tally[layout.STEPS] >= run.settings.steps:
                return f"at t = {t:.6g} s {run.settings.steps} steps were used up: the model is stiff or singular"
            return ""
        rates = np.zeros_like(run.y)
        run.derivative(t, run.y.copy(), rates)
        if not np.all(np.isfinite(rates)):
            return f"after t = {t:.6g} s forces or laws of motion are not numbers"
        if status == layout.MASSLESS:
            return f"after t = {t:.6g} s a free motion moves no mass"
        if status == layout.TURNED:
            t = float(run.clock[layout.REACHED])
        if status == layout.TURNED or (status == layout.STUCK and run.folds()):
            return f"at t = {t:.6g} s {run.dynamics.mechanism.doubt()}{run.loops()}"
        if run.limit():
            return f"at t = {t:.6g} s {run.limit()}{run.loops()}"
        if status == layout.OPENED:
            return f"at t = {t:.6g} s the loops cannot be closed any more: the pose is singular{run.loops()}"
        return (
            f"at t = {t:.6g} s the motion becomes too fast to follow: "
            f"the mechanism is singular there or the model is stiff{run.loops()}"
        )

    def _report(self) -> None:
        if self.progress is not None:
            self.progress(int(self.run.tally[layout.NEXT]), len(self.run.times))

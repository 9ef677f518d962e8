"""How a simulation is run: numbers that the solvers use, each with where it comes from, and who is told how it goes."""

from __future__ import annotations

from dataclasses import field
from typing import Literal

from kinform.foundation.progress import Progress, Say
from kinform.frozen import dataclass


@dataclass(frozen=True)
class SolverSettings:
    """Tolerances and budgets of the solvers. Gaps are in rad and in shares of the mechanism's length."""

    rtol: float = 1e-10
    """Relative error a step of the integrator: pendulum periods come out to 1e-9."""
    atol: float = 1e-12
    """Absolute error a step, rad or m."""
    method: Literal["explicit", "implicit", "auto"] = "auto"
    """auto: explicit, and implicit once a stiff model would take it too many steps. Vibrations too
    fast to be followed are damped in either but the explicit."""
    ahead: int = 20_000
    """So many: an implicit step costs what dozens of explicit ones do."""
    implicit_rtol: float = 1e-8
    """Relative error a step of the implicit method, of order 5: with less its steps grow many."""
    implicit_atol: float = 1e-10
    """Absolute error a step of the implicit method."""
    steps: int = 200_000
    """Steps of the integrators before they give up: a chaotic or nearly singular model would run for ever."""
    keep: float = 0.1
    """Independent rows of the loops are chosen again when a pivot falls below this share of what it was."""
    closed: float = 1e-14
    """A loop is closed when its gap is below this, a few dozen roundings."""
    open: float = 1e-7
    """A gap that stays above this is no rounding and no misfit that snapping leaves: it does not close."""
    free: float = 1e-4
    """Singular values of the closure below this share of the largest are zero: the rank of redundant
    loops, as for mobility (`Tolerances.free`)."""
    singular: float = 1e-6
    """A pose is singular when the smallest singular value that counts falls below this share."""
    near: float = 0.1
    """Below this share loops are closed at every evaluation of the integrator too, not only after steps:
    with less a four-bar lost its energy on passing its collinear pose."""
    doubtful: float = 1e-2
    """A run that came below this share passed a singular pose, and says so."""
    stride: float = 0.2
    """Greatest motion of a driven joint (rad, or lengths) in one step along a path."""
    correction: float = 0.05
    """Greatest correction by Newton (rad, or lengths) after a predicted step: beyond, the other assembly
    of the loop could be reached."""
    halvings: int = 20
    """How often a step along a path is halved before its end counts as unreachable."""
    newton: int = 12
    """Newton iterations a step; they converge in three or four."""


@dataclass(frozen=True)
class Conduct:
    """How one simulation is run."""

    settings: SolverSettings = field(default_factory=SolverSettings)
    progress: Progress | None = None
    """Told how many outputs of how many there are."""
    say: Say | None = None
    """Told when the equations are compiled, which takes seconds once on a machine."""

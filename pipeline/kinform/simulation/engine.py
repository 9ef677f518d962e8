"""The kernel's entries, as they are or compiled."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from kinform.simulation.kernel import equations, explicit

if TYPE_CHECKING:
    from kinform.simulation.run import Run

__all__ = ["Engine", "engine", "ready"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Engine:
    """Calls into the kernel with the tables of a run."""

    compiled: bool
    _derivative: Callable[..., float]
    _project: Callable[..., tuple[float, float]]
    _advance: Callable[..., int]
    loaded: ClassVar[bool] = False
    """Whether this process has the compiled functions already."""

    def advance(self, run: Run) -> int:
        """Integrate; see `kernel.explicit.advance`."""
        tables = run.dynamics.tables
        with _quiet(self.compiled):
            return int(
                self._advance(tables.ints, tables.nums, tables.work, run.y, run.clock, run.tally, run.times, run.out)
            )

    def derivative(self, run: Run, t: float, y: Array, dy: Array) -> float:
        """See `kernel.equations.derivative`."""
        tables = run.dynamics.tables
        with _quiet(self.compiled):
            return float(self._derivative(tables.ints, tables.nums, tables.work, t, y, dy))

    def project(self, run: Run, t: float, y: Array) -> tuple[float, float]:
        """See `kernel.equations.project`."""
        tables = run.dynamics.tables
        with _quiet(self.compiled):
            return self._project(tables.ints, tables.nums, tables.work, t, y, run.settings.closed)


class _Silence(warnings.catch_warnings):
    """numpy warns of overflow in numbers that compiled code lets pass; the kernel looks for both itself."""

    def __enter__(self) -> Any:
        out = super().__enter__()
        warnings.simplefilter("ignore", RuntimeWarning)
        return out


class _Nothing:
    def __enter__(self) -> None: ...

    def __exit__(self, *_: object) -> None: ...


def _quiet(compiled: bool) -> Any:
    return _Nothing() if compiled else _Silence()


def ready() -> bool:
    """Whether the compiled functions can be had within about a second."""
    from kinform.simulation.kernel.compiled import is_cached

    return Engine.loaded or is_cached()


def engine(*, compiled: bool) -> Engine:
    """The kernel's entries, compiled (from numba's cache where there is one) or not."""
    if not compiled:
        advance = partial(explicit.advance, equations.derivative, equations.project)
        return Engine(False, equations.derivative, equations.project, advance)
    from kinform.simulation.kernel.compiled import compiled as functions

    made = functions()
    Engine.loaded = True
    return Engine(True, made.derivative, made.project, made.advance)

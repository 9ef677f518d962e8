"""The kernel's entries, as they are or compiled."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from kinform.model.arrays import Array
from kinform.simulation.kernel import equations, explicit, layout
from kinform.simulation.kernel.addresses import address, addresses
from kinform.simulation.kernel.uncompiled import plainly

if TYPE_CHECKING:
    from kinform.simulation.solver.run_state import Run

__all__ = ["Engine", "engine", "ready"]


@dataclass(frozen=True)
class Engine:
    """Calls into the kernel with the tables of a run."""

    compiled: bool
    _units: Any
    loaded: ClassVar[bool] = False
    """Whether this process has the compiled functions already."""

    def advance(self, run: Run) -> int:
        """Integrate; see `kernel.explicit.advance`."""
        outputs = run.outputs if self.compiled else run.rows
        return int(self._call("advance", run, run.y, run.clock, run.tally, outputs))

    def derivative(self, run: Run, t: float, y: Array, dy: Array) -> float:
        """See `kernel.equations.derivative`."""
        return float(self._call("derivative", run, t, y, dy))

    def project(self, run: Run, t: float, y: Array) -> tuple[float, float]:
        """(gap left, smallest pivot over that of its choice); see `kernel.equations.project`."""
        gap = float(self._call("project", run, t, y, run.settings.closed, False))
        return gap, float(run.dynamics.tables.work[layout.VECTORS][layout.KEPT, 0])

    def sample(self, run: Run, t: float, y: Array, out: Array) -> None:
        """Write an output; see `kernel.explicit.sample`."""
        self._call("sample", run, run.clock, t, y, out)

    def _call(self, name: str, run: Run, *arguments: Any) -> Any:
        """The unit of that name with the tables of the run."""
        tables = run.dynamics.tables
        unit = getattr(self._units, name)
        if not self.compiled:
            return plainly(unit, tables, *arguments)
        held = [addresses(a) if isinstance(a, tuple) else a for a in arguments]
        return unit(
            *(address(list_) for list_ in tables.addresses),
            *(address(a) if isinstance(a, np.ndarray) else a for a in held),
        )


class _Plain:
    """The units as they are."""

    advance, sample = staticmethod(explicit.advance), staticmethod(explicit.sample)
    derivative, project = staticmethod(equations.derivative), staticmethod(equations.project)


def ready() -> bool:
    """Whether the compiled functions can be had within about a second."""
    from kinform.simulation.kernel.compiled import is_cached

    return Engine.loaded or is_cached()


def engine(*, compiled: bool) -> Engine:
    """The kernel's entries, compiled (from numba's cache where there is one) or not."""
    if not compiled:
        return Engine(False, _Plain)
    from kinform.simulation.kernel.compiled import compiled as functions

    made = functions()
    Engine.loaded = True
    return Engine(True, made)

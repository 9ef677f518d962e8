"""Calls the kernel's functions with the tables of a mechanism, as they are or compiled.

As they are, they get lists in the place of the arrays: Python reads and writes a number of a list several times
faster than one of an array. Numbers are the same: both are doubles, and what is computed with them is written once,
in the kernel.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np

from kinform.frozen import dataclass
from kinform.simulation.kernel import equations, explicit, layout
from kinform.simulation.kernel.tables import Tables, address, addresses


def plainly(unit: Callable[..., Any], tables: Tables, *arguments: Any) -> Any:
    """What the unit returns for the tables and the arguments, whose arrays it changes as compiled code would.

    Where Python raises an error of arithmetic and compiled code goes on with infinity or NaN, the unit is
    called again on the arrays themselves, which go on too.
    """
    ints, work = ([table.tolist() for table in group] for group in (tables.ints, tables.work))
    nums = [tables.nums[layout.CONSTANTS].tolist(), *tables.constants]
    lists = [argument.tolist() if isinstance(argument, np.ndarray) else argument for argument in arguments]
    try:
        result = unit(ints, nums, work, *lists)
    except (ArithmeticError, ValueError):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)
            return unit(tables.ints, tables.nums, tables.work, *arguments)
    arrays = (tables.ints[layout.MODE], *tables.work, *arguments)
    for array, rows in zip(arrays, (ints[layout.MODE], *work, *lists), strict=True):
        if isinstance(array, np.ndarray) and array.size:
            array[...] = rows
    return result


@dataclass(frozen=True)
class Engine:
    """The units of the kernel, compiled or not."""

    compiled: bool
    loaded: ClassVar[set[bool]] = set()
    """Which of the compiled builds this process has already: with articulated bodies, without."""

    def call(self, name: str, tables: Tables, *arguments: Any) -> Any:
        """What the unit of that name returns for the tables and the arguments, which it changes."""
        if not self.compiled:
            return plainly(getattr(_PLAIN, name), tables, *arguments)
        held = [addresses(a) if isinstance(a, tuple) else a for a in arguments]
        return getattr(_units(by_articulated_bodies(tables)), name)(
            *(address(list_) for list_ in tables.addresses),
            *(address(a) if isinstance(a, np.ndarray) else a for a in held),
        )


_PLAIN = SimpleNamespace(
    advance=explicit.advance, sample=explicit.sample, derivative=equations.derivative, project=equations.project
)
"""The units that runs call, as they are."""


def by_articulated_bodies(tables: Tables) -> bool:
    """Whether the tables say that articulated bodies are the way to solve, now."""
    return bool(tables.ints[layout.MODE][layout.WAY][0] == 1)


def is_loaded(tables: Tables) -> bool:
    """Whether this process has the compiled functions for the tables already."""
    return True in Engine.loaded or (False in Engine.loaded and not by_articulated_bodies(tables))


def ready(tables: Tables) -> bool:
    """Whether the compiled functions can be had within about a second."""
    from kinform.simulation.kernel.compiled import is_cached

    return is_loaded(tables) or is_cached(articulated_bodies=by_articulated_bodies(tables))


def _units(articulated_bodies: bool) -> SimpleNamespace:
    """The compiled units of a build; that with articulated bodies serves for both."""
    from kinform.simulation.kernel.compiled import compiled_units

    build = articulated_bodies or True in Engine.loaded
    units = compiled_units(articulated_bodies=build)
    Engine.loaded.add(build)
    return units


def engine(*, compiled: bool, articulated_bodies: bool = False) -> Engine:
    """The kernel's units, as they are or compiled (from numba's cache where there is one). The other build is compiled
    when tables need it."""
    if compiled:
        _units(articulated_bodies)
    return Engine(compiled)

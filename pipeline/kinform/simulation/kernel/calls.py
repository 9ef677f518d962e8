"""Calls the kernel's functions with the tables of a mechanism, as they are or compiled.

As they are, they get lists in the place of the arrays: Python reads and writes a number of a list several times
faster than one of an array. Numbers are the same: both are doubles, and what is computed with them is written once,
in the kernel.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np

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
    """The units of the kernel, compiled or not, by name."""

    compiled: bool
    _units: Any
    loaded: ClassVar[bool] = False
    """Whether this process has the compiled functions already."""

    def call(self, name: str, tables: Tables, *arguments: Any) -> Any:
        """What the unit of that name returns for the tables and the arguments, which it changes."""
        unit = getattr(self._units, name)
        if not self.compiled:
            return plainly(unit, tables, *arguments)
        held = [addresses(a) if isinstance(a, tuple) else a for a in arguments]
        return unit(
            *(address(list_) for list_ in tables.addresses),
            *(address(a) if isinstance(a, np.ndarray) else a for a in held),
        )


_PLAIN = SimpleNamespace(
    advance=explicit.advance, sample=explicit.sample, derivative=equations.derivative, project=equations.project
)
"""The units that runs call, as they are."""


def ready() -> bool:
    """Whether the compiled functions can be had within about a second."""
    from kinform.simulation.kernel.compiled import is_cached

    return Engine.loaded or is_cached()


def engine(*, compiled: bool) -> Engine:
    """The kernel's units, compiled (from numba's cache where there is one) or not."""
    if not compiled:
        return Engine(False, _PLAIN)
    from kinform.simulation.kernel.compiled import compiled_units

    units = compiled_units()
    Engine.loaded = True
    return Engine(True, units)

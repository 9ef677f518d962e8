"""Calls the kernel's functions as they are, on lists in the place of the arrays of its tables.

Python reads and writes a number of a list several times faster than one of an array. Numbers are the same:
both are doubles, and what is computed with them is written once, in the kernel.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

from kinform.simulation.kernel import layout
from kinform.simulation.mechanism.kernel_tables import Tables

__all__ = ["plainly"]


def plainly(unit: Callable[..., Any], tables: Tables, *arguments: Any) -> Any:
    """What the unit returns for the tables and the arguments, whose arrays it changes as compiled code would.

    Where Python raises an error of arithmetic and compiled code goes on with infinity or NaN, the unit is
    called again on the arrays themselves, which go on too.
    """
    ints, work = ([table.tolist() for table in group] for group in (tables.ints, tables.work))
    nums = [tables.nums[layout.CONSTANTS].tolist(), *tables.constants]
    given = [argument.tolist() if isinstance(argument, np.ndarray) else argument for argument in arguments]
    try:
        result = unit(ints, nums, work, *given)
    except (ArithmeticError, ValueError):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)
            return unit(tables.ints, tables.nums, tables.work, *arguments)
    arrays = (tables.ints[layout.MODE], *tables.work, *arguments)
    for array, rows in zip(arrays, (ints[layout.MODE], *work, *given), strict=True):
        if isinstance(array, np.ndarray) and array.size:
            array[...] = rows
    return result

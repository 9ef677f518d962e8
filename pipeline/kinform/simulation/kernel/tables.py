"""The tables of one mechanism in memory, and where compiled functions find them; see `layout` for what is in them.

Compiled functions get addresses in the place of arrays: see `native` for the other side.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints


def address(array: NDArray[Any]) -> int:
    """Of the first number of an array of float64 or int64 in C order; TypeError for any other."""
    if not (array.flags.c_contiguous and array.dtype in (np.float64, np.int64)):
        raise TypeError("the kernel takes arrays of float64 or int64 in C order")
    return int(array.ctypes.data)


def addresses(tables: Sequence[NDArray[Any]]) -> Ints:
    """(3 k,) address, rows and columns of each of k tables. Holds for as long as they do."""
    return np.array([n for table in tables for n in (address(table), *table.shape)], dtype=np.int64)


@dataclass(frozen=True, eq=False)
class Tables:
    """Constants and scratch of the kernel, and how its order of coordinates relates to the mechanism's."""

    ints: tuple[Ints, ...]
    nums: tuple[Array, ...]
    work: tuple[Array, ...]
    q_order: Ints
    """(nq,) position of the mechanism that each of the kernel's is."""
    v_order: Ints
    """(n,) the same of rates."""
    states: int
    """How many states controllers and motors have, and meters."""
    meters: int
    """How many of these are meters, at their end."""

    @cached_property
    def addresses(self) -> tuple[Ints, Ints, Ints]:
        """Where compiled functions find the tables, which stay where they are."""
        return addresses(self.ints), addresses(self.nums), addresses(self.work)

    @cached_property
    def constants(self) -> list[list[list[float]]]:
        """The tables of `nums` after the first, which nothing changes, as lists of rows."""
        return [table.tolist() for table in self.nums[1:]]

    @property
    def size(self) -> int:
        """Length of the kernel's state."""
        return len(self.q_order) + len(self.v_order) + self.states + 1

    @property
    def metered(self) -> slice:
        """Which numbers of the kernel's state are meters."""
        return slice(self.size - 1 - self.meters, self.size - 1)

    def pack(self, q: Array, v: Array) -> Array:
        """The kernel's state with these positions and rates, all else zero."""
        y = np.zeros(self.size)
        y[: len(q)] = q[self.q_order]
        y[len(q) : len(q) + len(v)] = v[self.v_order]
        return y

    def unpack(self, y: Array) -> tuple[Array, Array]:
        """Positions (…, nq) and rates (…, n) of the mechanism in states (…, size)."""
        nq, n = len(self.q_order), len(self.v_order)
        return self.positions(y[..., :nq]), self.rates(y[..., nq : nq + n])

    def positions(self, values: Array) -> Array:
        """Positions in the kernel's order put in the mechanism's."""
        out = np.empty_like(values)
        out[..., self.q_order] = values
        return out

    def rates(self, values: Array) -> Array:
        """Rates, accelerations or efforts in the kernel's order put in the mechanism's."""
        out = np.empty_like(values)
        out[..., self.v_order] = values
        return out

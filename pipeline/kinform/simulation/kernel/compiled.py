"""The kernel's functions compiled by numba, from its cache where there is one.

Every function is compiled for one signature: three tuples of two-dimensional arrays, and numbers. The
names under which numba caches them carry a digest of all the kernel's source: a change of one function
compiles afresh those that call it.
"""

from __future__ import annotations

import gc
import hashlib
import inspect
import os
import sys
import types
from collections.abc import Callable, Mapping
from functools import cache, partial
from pathlib import Path
from typing import Any

from kinform.simulation.kernel import (
    crossings,
    equations,
    explicit,
    forces,
    layout,
    loops,
    masses,
    motion,
    signals,
    vectors,
)

__all__ = ["compiled", "is_cached"]

_ORDER = (
    vectors.three, vectors.put, vectors.add, vectors.cross, vectors.dot, vectors.turned, vectors.place,
    signals.law, motion.place_screw, motion.place_ball, motion.place_links, motion.twist_links,
    masses.momentum, masses.heavy, masses.inertias, masses.wrenches, masses.mass_matrix, masses.cholesky,
    masses.solve_cholesky, forces.controlled, forces.drive, forces.push, forces.pace, forces.loads, forces.between,
    loops.line_of, loops.gained, loops.gap_of, loops.gather, loops.eliminate, loops.back_substitute,
    equations.impose, equations.reduce, equations.balance, equations.derivative, equations.move, equations.project,
    crossings.alike, crossings.tip, crossings.laid,
    explicit.slope, explicit.roundings, explicit.try_step, explicit.prepare, explicit.interpolate, explicit.sample,
    explicit.stop_reached, explicit.advance,
)  # fmt: skip
"""Functions after those that they call."""

_POINTERS = ("derivative", "project")
"""Passed to the integrator as functions."""
_ENTRIES = (*_POINTERS, "advance")
"""What is called from Python; the rest gets no wrapper, which shortens compilation."""


def _digest() -> str:
    modules = (layout, vectors, signals, motion, masses, forces, loops, equations, crossings, explicit)
    text = "".join(inspect.getsource(module) for module in (*modules, sys.modules[__name__]))
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def _renamed(function: Callable[..., Any], known: dict[str, Any], digest: str) -> Any:
    """The function with compiled ones in place of those that it calls."""
    scope = {**function.__globals__, **known}
    made = types.FunctionType(function.__code__, scope, function.__name__)
    made.__module__ = function.__module__
    made.__qualname__ = f"{function.__name__}_{digest}"
    return made


def _kinds() -> dict[str, Any]:
    """What the annotations of the kernel are to numba."""
    import numba

    nb: Any = numba.types
    whole, real, row = nb.int64, nb.float64, nb.float64[::1]
    index, table = whole[:, ::1], real[:, ::1]
    tables = (nb.UniTuple(index, 10), nb.UniTuple(table, 12), nb.UniTuple(table, 9))
    return {
        "int": whole, "float": real, "bool": nb.boolean, "Row": row, "Counts": whole[::1], "Table": table,
        "Index": index, "Ints": tables[0], "Nums": tables[1], "Work": tables[2],
        "Derivative": nb.ExternalFunctionPointer(real(*tables, real, row, row), int),
        "Project": nb.ExternalFunctionPointer(nb.UniTuple(real, 2)(*tables, real, row, real), int),
    }  # fmt: skip


def _signature(function: Callable[..., Any], kinds: Mapping[str, Any]) -> tuple[Any, ...]:
    """Types of the arguments, from their annotations."""
    return tuple(kinds[argument.annotation] for argument in inspect.signature(function).parameters.values())


@cache
def compiled() -> types.SimpleNamespace:
    """The compiled entries `derivative`, `project` and `advance`; the last without its first two arguments."""
    import numba

    digest, kinds = _digest(), _kinds()
    known: dict[str, Any] = {}
    config: Any = numba.config
    collecting, level = gc.isenabled(), config.OPT
    # A compiler makes much and drops little: collecting between costs a tenth of its time. The higher
    # levels of optimisation cost a quarter of it, and the result is no faster.
    gc.disable()
    config.OPT = type(level)(min(level, 1))
    try:
        for function in _ORDER:
            name = function.__name__
            known[name] = _jit(numba, _signature(function, kinds), _renamed(function, known, digest), name)
    finally:
        config.OPT = level
        if collecting:
            gc.enable()
    made = {name: known[name].overloads[known[name].signatures[0]] for name in _ENTRIES}
    pointers = [
        made[name].library.get_pointer_to_function(made[name].fndesc.llvm_cfunc_wrapper_name) for name in _POINTERS
    ]
    # The entry itself: numba's dispatcher knows no type of a pointer.
    advance = partial(made["advance"].entry_point, *pointers)
    return types.SimpleNamespace(**{name: known[name] for name in _POINTERS}, advance=advance)


def is_cached() -> bool:
    """Whether numba's cache holds the kernel compiled: where its variable says, else beside the kernel
    or, where that cannot be written, in the user's own."""
    named = os.environ.get("NUMBA_CACHE_DIR")
    user = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "numba"
    places = [Path(named)] if named else [Path(__file__).parent / "__pycache__", user]
    pattern = f"*.advance_{_digest()}-*.nbi"
    return any(any(place.glob(f"{depth}{pattern}")) for place in places for depth in ("", "*/"))


def _jit(numba: Any, signature: tuple[Any, ...], function: Any, name: str) -> Any:
    """Compile, with the cache where the machine allows one."""
    options = {
        "nopython": True, "error_model": "numpy",
        "no_cpython_wrapper": name not in _ENTRIES, "no_cfunc_wrapper": name not in _POINTERS,
    }  # fmt: skip
    try:
        return numba.jit(signature, cache=True, **options)(function)
    except RuntimeError as error:
        if "cache" not in str(error):
            raise
        return numba.jit(signature, **options)(function)

"""The kernel's functions compiled by numba, from the user's cache where they are there.

Units are functions that others call by name, as C does: each is compiled once and kept (`unit_cache`). All
other functions are compiled into the units that use them, when such a unit has to be compiled. The names
under which units are kept carry a digest of all the kernel's source: a change of one function
compiles all of them afresh.

Few mechanisms are so large that articulated bodies are the way to solve (`pivoting.choose_method`), and a fifth of the
time of compiling went into them. So there are two builds: one that lacks them, and one that has all. What lies below
them is in both, and compiled once. `calls.Engine` takes the second where the tables say so.
"""

from __future__ import annotations

import ctypes
import gc
import hashlib
import inspect
import sys
import types
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from kinform.simulation.kernel import (
    articulated,
    crossings,
    equations,
    explicit,
    forces,
    loops,
    masses,
    motion,
    reduction,
    steps,
    tables,
    unit_cache,
    vectors,
)
from kinform.simulation.kernel.load_numba import load_numba
from kinform.simulation.kernel.numba_patches import no_machine_code, operators_looked_up_once, variables_listed_directly

_MODULES = (vectors, motion, masses, forces, loops, articulated, reduction, equations, crossings, steps, explicit)
"""Functions after those that they call."""
_BELOW = (vectors, motion, masses, forces, loops)
"""Those that call nothing of articulated bodies, also not by others: the same in both builds."""
_UNITS = (
    motion.place_links, motion.twist_links, masses.inertias, masses.mass_matrix, loops.gather, loops.eliminate,
    articulated.refer, articulated.articulate, articulated.resist, articulated.respond, articulated.settle_tree,
    reduction.reduce, reduction.settle, equations.derivative, equations.project, steps.slope, steps.try_step,
    explicit.sample, explicit.attempt, explicit.pass_through, explicit.advance,
)  # fmt: skip


@cache
def _digest() -> str:
    """Of all that decides what is compiled: the source of the functions and of this module's, and the numbers that
    functions read by name, which the compiler takes for constants."""
    native = Path(__file__).with_name("native.py")  # read, not imported: it needs numba
    text = "".join(inspect.getsource(module) for module in (*_MODULES, tables, sys.modules[__name__]))
    numbers = {name: value for module in _MODULES for name, value in vars(module).items() if name.isupper()}
    text += f"{native.read_text(encoding='utf-8')}{sorted(numbers.items())}"
    return hashlib.sha256(text.encode()).hexdigest()[:12]


class _Copy:
    """The kernel's functions in a world of their own, where the names of those that they call can be given
    other meanings."""

    def __init__(self) -> None:
        self._scopes = {module.__name__: dict(vars(module)) for module in _MODULES}

    def of(self, function: Callable[..., Any], mark: str) -> Any:
        made = types.FunctionType(function.__code__, self._scopes[function.__module__], function.__name__)
        made.__module__ = function.__module__
        made.__qualname__ = f"{function.__name__}_{mark}"
        return made

    def mean(self, function: Callable[..., Any], other: Any) -> None:
        """The other for the function, wherever one calls it."""
        for scope in self._scopes.values():
            if scope.get(function.__name__) is function:
                scope[function.__name__] = other


def _kinds() -> dict[str, tuple[Any, Any]]:
    """What the annotations of the kernel are to numba and, where units have them, to ctypes."""
    numba = load_numba()

    from kinform.simulation.kernel.native import Row, Table, Tables

    whole, real = numba.types.int64, numba.types.float64
    memory = {
        "Row": Row(real), "Counts": Row(whole), "Table": Table(real), "Index": Table(whole),
        "Ints": Tables(whole), "Nums": Tables(real), "Work": Tables(real),
    }  # fmt: skip
    return {
        "int": (whole, ctypes.c_int64), "float": (real, ctypes.c_double), "bool": (numba.types.boolean, ctypes.c_bool),
        "None": (numba.types.none, None), **{name: (kind, ctypes.c_void_p) for name, kind in memory.items()},
    }  # fmt: skip


@cache
def compiled_units(*, articulated_bodies: bool) -> types.SimpleNamespace:
    """The units, compiled, with articulated bodies or without; where they take arrays, they take addresses
    (`tables`)."""
    numba = load_numba()
    config: Any = numba.config
    collecting = gc.isenabled()
    before = {name: getattr(config, name) for name in ("OPT", "LOOP_VECTORIZE", "SLP_VECTORIZE")}
    # A compiler makes much and drops little: collecting between costs a tenth of its time. The higher
    # levels of optimisation cost a quarter of it, vectors a tenth, and the result is no faster.
    gc.disable()
    config.OPT = type(config.OPT)(min(config.OPT, 1))
    config.LOOP_VECTORIZE = config.SLP_VECTORIZE = 0
    try:
        with operators_looked_up_once(), variables_listed_directly():
            return _compile(numba, articulated_bodies)
    finally:
        for name, value in before.items():
            setattr(config, name, value)
        if collecting:
            gc.enable()


def _mark(module: types.ModuleType, articulated_bodies: bool) -> str:
    """What tells the units of a module in a build from others of their names."""
    return f"{_digest()}{'' if module in _BELOW else 'a' if articulated_bodies else 'b'}"


def _compile(numba: Any, articulated_bodies: bool) -> types.SimpleNamespace:
    """Functions in the order of the modules, so that each finds those that it calls."""
    from llvmlite import binding

    kinds, cached = _kinds(), is_cached(articulated_bodies=articulated_bodies)
    copy, made = _Copy(), types.SimpleNamespace()
    options = {"nopython": True, "error_model": "numpy", "no_rewrites": True, "_nrt": False}
    for module in _MODULES:
        mark, lacking = _mark(module, articulated_bodies), module is articulated and not articulated_bodies
        for name, function in list(vars(module).items()):
            if not inspect.isfunction(function) or function.__module__ != module.__name__:
                continue
            shape = inspect.signature(function)
            taken = [kinds[argument.annotation] for argument in shape.parameters.values()]
            if function not in _UNITS:
                if lacking:
                    continue
                # Without a signature nothing is compiled until a unit asks for it, which none in the cache does.
                signature = None if cached else tuple(kind for kind, _ in taken)
                inner = numba.jit(signature, no_cpython_wrapper=True, no_cfunc_wrapper=True, **options)
                with no_machine_code():
                    copy.mean(function, inner(copy.of(function, mark)))
                continue
            given = kinds[shape.return_annotation]
            signature, symbol = given[0](*(kind for kind, _ in taken)), f"kinform_{name}_{mark}"
            copy.mean(function, numba.types.ExternalFunction(symbol, signature))
            if lacking:
                binding.add_symbol(symbol, _nowhere())
                continue
            unit = _unit(numba, signature, copy.of(function, mark), options)
            binding.add_symbol(symbol, unit.address)
            setattr(made, name, ctypes.CFUNCTYPE(given[1], *(kind for _, kind in taken))(unit.address))
    return made


def _nowhere() -> int:
    """Where a build leads that calls what it lacks: to the end of the process, which is better than a wrong number."""
    return ctypes.cast(ctypes.pythonapi.Py_FatalError, ctypes.c_void_p).value or 0


def is_cached(*, articulated_bodies: bool = False) -> bool:
    """Whether the user's cache holds the kernel compiled, with articulated bodies or without."""
    return unit_cache.has(f"advance_{_mark(explicit, articulated_bodies)}")


def _unit(numba: Any, signature: Any, function: Any, options: dict[str, Any]) -> Any:
    """Compile, or take from the cache what was compiled before."""
    from numba.core import ccallback, sigutils

    forms: Any = sigutils
    unit: Any = ccallback.CFunc(function, forms.normalize_signature(signature), locals={}, options=options)
    unit._cache = unit_cache.UnitCache(function.__qualname__)
    unit.compile()
    return unit

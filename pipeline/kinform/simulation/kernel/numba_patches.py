"""What numba does and the kernel has no use for, left out while it is compiled.

A third of the time of compiling went into three things. For every operator in every function numba looks for its
meaning anew, through some ten templates: the same few operators of the same few types, five thousand times. Which
variables an instruction names it asks a million times. And of every function it makes machine code, also of those that
are compiled into the units that call them, and are called by nobody else. What is compiled of the units is the same
without (LLVM's assembly of all of them was compared for the first and the last).

As `native`, this rests on numba's internals (`types.Function.get_call_type`, `ir.Inst._rec_list_vars`,
`CPUContext.get_executable`, `_dynfunc`, `CPUCodeLibrary` and its steps), of the versions that are named there. Where
one of them is not as it was, a compiled function is none, or refers to what is not there, and ends the process: the
tests in tests/simulation that compile all units and call them would tell.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def operators_looked_up_once() -> Iterator[None]:
    """While numba compiles: what an operator, or another function of numba's, means for arguments of some types is
    found once."""
    from numba.core import types

    function: Any = types.Function
    looked_up, found = function.get_call_type, {}

    def get_call_type(self: Any, context: Any, args: Any, kws: Any) -> Any:
        if kws:
            return looked_up(self, context, args, kws)
        asked = (id(self), tuple(args))
        if asked not in found:
            found[asked] = (self, looked_up(self, context, args, kws))  # kept with it, so that no other gets its number
        return found[asked][1]

    function.get_call_type = get_call_type
    try:
        yield
    finally:
        function.get_call_type = looked_up


@contextmanager
def variables_listed_directly() -> Iterator[None]:
    """While numba compiles: which variables an instruction names is found by the kinds of what it holds, each judged
    once. numba asks this of every instruction, in each of its passes again."""
    from numba.core import ir

    instruction: Any = ir.Inst
    listed, judged = instruction._rec_list_vars, {}

    def judge(kind: type) -> int:
        kinds: tuple[Any, ...] = (ir.Var, ir.Inst, (list, tuple), dict)
        judged[kind] = next((k for k, one in enumerate(kinds) if issubclass(kind, one)), len(kinds))
        return judged[kind]

    def collect(value: Any, variables: list[Any]) -> None:
        kind = type(value)
        what = judged[kind] if kind in judged else judge(kind)
        if what == 0:
            variables.append(value)
        elif what == 1:
            variables.extend(value.list_vars())
        elif what < 4:
            for one in value if what == 2 else value.values():
                collect(one, variables)

    def list_variables(_: Any, value: Any) -> list[Any]:
        variables: list[Any] = []
        collect(value, variables)
        return variables

    instruction._rec_list_vars = list_variables
    try:
        yield
    finally:
        instruction._rec_list_vars = listed


@contextmanager
def no_machine_code() -> Iterator[None]:
    """While numba compiles what is compiled into others, and never called by itself: it ends with LLVM's code."""
    from numba import _dynfunc  # type: ignore[attr-defined]
    from numba.core import codegen, cpu

    target: Any = cpu.CPUContext
    code: Any = codegen.CPUCodeLibrary
    executable, finish = target.get_executable, code._finalize_final_module

    def get_executable(_: Any, library: Any, described: Any, env: Any) -> Any:
        library._ensure_finalized()
        name = described.qualname.split(".")[-1]
        return _dynfunc.make_function(described.lookup_module(), name, "", 0, env, (library,))

    def finish_without(library: Any) -> None:
        library._finalize_dynamic_globals()
        library._verify_declare_only_symbols()
        library._finalized = True

    target.get_executable, code._finalize_final_module = get_executable, finish_without
    try:
        yield
    finally:
        target.get_executable, code._finalize_final_module = executable, finish

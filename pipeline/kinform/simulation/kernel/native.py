"""What the kernel's tables are to numba: bare addresses.

An array of numba's is nine numbers with a count of who holds it, and its indices may be negative: with
thirty of them as arguments, most of the time of compiling, and a third of that of the equations of a
small mechanism, went into handing them on. Here a row is an address, a table an address with its rows and
columns, and a tuple of tables the address of a list of those (`tables.addresses`). Nothing is checked: indices
must lie within, and nothing keeps the arrays but who calls.

This rests on numba's internals, which nobody promises to keep: `types.Type`, the models of `numba.extending`
(`register_model`, `PrimitiveModel`, `StructModel`), the templates that are asked for the types of operators
(`AbstractTemplate`, `infer_global`, and that `metadata = {"target": "cpu"}` puts one before those for any target),
`lower_builtin` and `cgutils`; in `compiled` and `unit_cache` besides on `ExternalFunction`, on the option `_nrt`, on
`CFunc._cache` and on `CompileResult._reduce` and `_rebuild`. numba 0.60 to 0.68 were tried, and `pyproject.toml`
admits no other.

When numba moves, an ImportError here, a TypingError ("No implementation of function … getitem") or an AssertionError of
its lowering say that one of these has changed. test_compiled.py and test_reduction.py in tests/simulation/kernel
compile all units and compare them with the plain functions, bit by bit. One thing goes wrong in silence: a cache that
is no longer found (`is_cached` stays False after a compilation), so that runs are left to the plain functions for
longer, and each process that compiles does so for ten seconds. Short runs need none of this.
"""

from __future__ import annotations

import operator
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.typing.templates import AbstractTemplate, infer_global
from numba.extending import lower_builtin, models, register_model

# 64-bit integers, to LLVM and to numba
WORD, WHOLE = ir.IntType(64), types.int64
# two 64-bit integers
PAIR = types.UniTuple(WHOLE, 2)
FIRST = {"target": "cpu"}
"""Of a template: numba asks it before those that are for any target."""


class _Memory(types.Type):
    """Numbers of one kind in memory."""

    def __init__(self, of: Any):
        self.of = of
        super().__init__(f"kinform.{type(self).__name__}({of})")


class Row(_Memory):
    """One dimension."""


class Table(_Memory):
    """Two dimensions, C order."""


class Tables(_Memory):
    """Tables, taken from them by number."""


@register_model(Row)
class _RowModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Row):
        super().__init__(manager, kind, manager.lookup(kind.of).get_data_type().as_pointer())


@register_model(Tables)
class _TablesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Tables):
        super().__init__(manager, kind, WORD.as_pointer())


@register_model(Table)
class _TableModel(models.StructModel):
    def __init__(self, manager: Any, kind: Table):
        super().__init__(manager, kind, [("data", Row(kind.of)), ("rows", WHOLE), ("columns", WHOLE)])


def _item(memory: Any, index: Any) -> tuple[Any, Any]:
    """(what is at such an index, the index as lowered); None for both where there is no such."""
    if isinstance(memory, _Memory) and isinstance(index, types.Integer):
        return {Tables: Table(memory.of), Table: Row(memory.of), Row: memory.of}[type(memory)], WHOLE
    if isinstance(memory, Table) and isinstance(index, types.BaseTuple) and len(index) == 2:
        return memory.of, PAIR
    return None, None


@infer_global(operator.getitem)
class _Get(AbstractTemplate):
    metadata = FIRST

    def generic(self, args: Any, _: Any) -> Any:
        found, index = _item(*args)
        return None if found is None else found(args[0], index)


@infer_global(operator.setitem)
class _Set(AbstractTemplate):
    metadata = FIRST

    def generic(self, args: Any, _: Any) -> Any:
        found, index = _item(*args[:2])
        return types.none(args[0], index, found) if isinstance(found, types.Number) else None


@infer_global(len)
class _Len(AbstractTemplate):
    metadata = FIRST

    def generic(self, args: Any, _: Any) -> Any:
        return WHOLE(args[0]) if isinstance(args[0], Table) else None


def _parts(context: Any, builder: Any, kind: Any, value: Any = None) -> Any:
    return cgutils.create_struct_proxy(kind)(context, builder, value=value)


def _start(builder: Any, table: Any, row: Any) -> Any:
    """Address of a row of a table."""
    return builder.gep(table.data, [builder.mul(row, table.columns)], inbounds=True)


def _cell(context: Any, builder: Any, kind: Any, table: Any, index: Any) -> Any:
    """Address of a number in a table."""
    row, column = cgutils.unpack_tuple(builder, index, 2)
    return builder.gep(_start(builder, _parts(context, builder, kind, table), row), [column], inbounds=True)


@lower_builtin(operator.getitem, Tables, types.Integer)
def _table(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    kind, (place, index) = signature.return_type, arguments
    first = builder.mul(index, ir.Constant(WORD, 3))
    found = [
        builder.load(builder.gep(place, [builder.add(first, ir.Constant(WORD, k))], inbounds=True)) for k in range(3)
    ]
    table = _parts(context, builder, kind)
    table.data = builder.inttoptr(found[0], context.get_value_type(Row(kind.of)))
    table.rows, table.columns = found[1], found[2]
    return table._getvalue()


@lower_builtin(operator.getitem, Table, types.Integer)
def _row(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    return _start(builder, _parts(context, builder, signature.args[0], arguments[0]), arguments[1])


@lower_builtin(operator.getitem, Row, types.Integer)
def _number(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    return builder.load(builder.gep(arguments[0], [arguments[1]], inbounds=True))


@lower_builtin(operator.getitem, Table, types.BaseTuple)
def _number_of_table(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    return builder.load(_cell(context, builder, signature.args[0], *arguments))


@lower_builtin(operator.setitem, Row, types.Integer, types.Number)
def _put(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    place, index, value = arguments
    builder.store(value, builder.gep(place, [index], inbounds=True))


@lower_builtin(operator.setitem, Table, types.BaseTuple, types.Number)
def _put_in_table(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    table, index, value = arguments
    builder.store(value, _cell(context, builder, signature.args[0], table, index))


@lower_builtin(len, Table)
def _rows(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    return _parts(context, builder, signature.args[0], arguments[0]).rows

"""`dataclass` for frozen records: that of the standard library, at a tenth of what defining a class costs.

The standard library writes the source of up to six methods for each class and compiles it while modules are imported,
which was a fifth of a short run: hundreds of classes, of which most are never made. Here fields, defaults and
parameters come from the standard library too, but the methods that guard, show and compare are shared code, and the
source of `__init__` is written when the first record is made. Everything else is as there: `fields`, `replace`,
`asdict`, `match`, inheritance, pickles, signatures. Classes that are not frozen, or ask for more, are left to it.
"""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Callable
from dataclasses import MISSING, Field, FrozenInstanceError
from operator import attrgetter
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any

__all__ = ["dataclass"]


class _Absent:
    """Stands for an argument that its field's factory gives."""

    def __repr__(self) -> str:
        return "<factory>"


_ABSENT = _Absent()


def _dataclass(cls: type | None = None, /, **options: Any) -> Any:
    """As `dataclasses.dataclass`, with the same options and the same outcome."""
    return (lambda made: _record(made, **options)) if cls is None else _record(cls, **options)


if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:
    dataclass = _dataclass


def _record(cls: type[Any], *, frozen: bool = False, eq: bool = True, **others: bool) -> type[Any]:
    own = vars(cls)
    if not frozen or others or (own.keys() & {"__eq__", "__hash__", "__setattr__", "__delattr__"}):
        return dataclasses.dataclass(frozen=frozen, eq=eq, **others)(cls)
    if own.get("__doc__") is None:
        cls.__doc__ = cls.__name__  # else a signature would be written for it, which needs `__init__`
    inherits = any(dataclasses.is_dataclass(base) for base in cls.__mro__[1:])
    # records that inherit frozen ones cannot be made without: the methods that guard them are compiled
    dataclasses.dataclass(init=False, repr=False, eq=False, frozen=inherits)(cls)
    parameters = cls.__dataclass_params__
    parameters.init = parameters.repr = parameters.frozen = True
    parameters.eq = eq
    if not inherits:
        _guard(cls)
    if "__init__" not in own:
        _build_later(cls)
    if "__repr__" not in own:
        cls.__repr__ = _repr  # type: ignore[assignment]
    if eq:
        _compare(cls)
    return cls


def _guard(cls: type[Any]) -> None:
    """Nothing can be set or deleted; in classes below this one, none of its fields."""
    names = frozenset(field.name for field in dataclasses.fields(cls))

    def __setattr__(self: Any, name: str, value: Any) -> None:
        if type(self) is cls or name in names:
            raise FrozenInstanceError(f"cannot assign to field {name!r}")
        super(cls, self).__setattr__(name, value)

    def __delattr__(self: Any, name: str) -> None:
        if type(self) is cls or name in names:
            raise FrozenInstanceError(f"cannot delete field {name!r}")
        super(cls, self).__delattr__(name)

    _set(cls, "__setattr__", __setattr__)
    _set(cls, "__delattr__", __delattr__)


@recursive_repr()
def _repr(self: Any) -> str:
    shown = (f"{field.name}={getattr(self, field.name)!r}" for field in dataclasses.fields(self) if field.repr)
    return f"{self.__class__.__qualname__}({', '.join(shown)})"


def _compare(cls: type[Any]) -> None:
    """Equal where the fields are, of one class; the hash is that of the fields."""
    fields = dataclasses.fields(cls)
    compared = _values([field.name for field in fields if field.compare])
    hashed = _values([field.name for field in fields if (field.compare if field.hash is None else field.hash)])

    def __eq__(self: Any, other: object) -> Any:
        return compared(self) == compared(other) if other.__class__ is self.__class__ else NotImplemented

    def __hash__(self: Any) -> int:
        return hash(hashed(self))

    _set(cls, "__eq__", __eq__)
    _set(cls, "__hash__", __hash__)


def _values(names: list[str]) -> Callable[[Any], tuple[Any, ...]]:
    """A function that gives these attributes as a tuple."""
    if len(names) > 1:
        return attrgetter(*names)
    return lambda record: tuple(getattr(record, name) for name in names)


def _build_later(cls: type[Any]) -> None:
    """An `__init__` that puts the one of the fields in its own place when it is called first."""

    def __init__(self: Any, *given: Any, **named: Any) -> None:
        built = _init(cls)
        _set(cls, "__init__", built)
        built(self, *given, **named)

    _set(cls, "__init__", __init__)
    cls.__signature__ = _Signature(cls)


class _Signature:
    """What `inspect.signature` tells of a class whose `__init__` may not have been built."""

    def __init__(self, cls: type[Any]):
        self._cls = cls

    def __get__(self, record: Any, owner: type) -> inspect.Signature:
        if record is not None or owner.__init__ is not self._cls.__init__:  # type: ignore[misc]
            raise AttributeError("__signature__")
        whole = inspect.signature(_init(self._cls))
        return whole.replace(parameters=[*whole.parameters.values()][1:])


def _init(cls: type[Any]) -> Callable[..., None]:
    """The `__init__` of the fields; raises TypeError where an argument without default follows one with."""
    fields = dataclasses.fields(cls)
    scope: dict[str, Any] = {"_set": object.__setattr__, "_absent": _ABSENT}
    taken = [field for field in fields if field.init]
    plain = [_argument(field) for field in taken if not field.kw_only]
    named = [_argument(field) for field in taken if field.kw_only]
    lines = [f" _set(self, {field.name!r}, {value})" for field in fields if (value := _value(field))]
    if hasattr(cls, "__post_init__"):
        lines.append(" self.__post_init__()")
    head = ", ".join(["self", *plain, *(["*", *named] if named else [])])
    for field in fields:
        scope[f"_default_{field.name}"] = field.default
        scope[f"_factory_{field.name}"] = field.default_factory
    exec(f"def __init__({head}):\n" + ("\n".join(lines) or " pass"), scope)
    made: Callable[..., None] = scope["__init__"]
    made.__annotations__ = {field.name: field.type for field in taken} | {"return": None}
    made.__qualname__ = f"{cls.__qualname__}.__init__"
    made.__module__ = cls.__module__
    return made


def _argument(field: Field[Any]) -> str:
    if field.default_factory is not MISSING:
        return f"{field.name}=_absent"
    return field.name if field.default is MISSING else f"{field.name}=_default_{field.name}"


def _value(field: Field[Any]) -> str:
    """What a field is set to, as source; empty where it is left to the class."""
    if field.default_factory is MISSING:
        return field.name if field.init else ""
    made = f"_factory_{field.name}()"
    return f"{made} if {field.name} is _absent else {field.name}" if field.init else made


def _set(cls: type[Any], name: str, function: Any) -> None:
    function.__qualname__ = f"{cls.__qualname__}.{name}"
    setattr(cls, name, function)

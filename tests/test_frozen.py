"""`kinform.frozen.dataclass` beside `dataclasses.dataclass`: classes made by both behave alike."""

from __future__ import annotations

import copy
import dataclasses
import importlib
import inspect
import math
import pickle
import subprocess
import sys
from dataclasses import FrozenInstanceError, field
from pathlib import Path
from typing import Any, ClassVar

import pytest

from kinform import frozen

SOURCES = Path(__file__).parents[1] / "pipeline"


def kinds(dataclass: Any) -> dict[str, Any]:
    """Classes of every form that records take, made by this decorator."""

    @dataclass(frozen=True)
    class Empty:
        pass

    @dataclass(frozen=True)
    class One:
        """Of one field."""

        value: Any

    @dataclass(frozen=True, eq=False)
    class Plain:
        """Compared by identity."""

        KINDS: ClassVar[tuple[str, ...]] = ("a", "b")

        name: str
        numbers: tuple[float, ...] = ()
        notes: list[str] = field(default_factory=list)
        hidden: int = field(default=3, repr=False)

    @dataclass(frozen=True)
    class Fields:
        first: int
        kept: dict[str, int] = field(default_factory=dict, init=False, repr=False, compare=False)
        second: float = field(default=2.0, compare=False)
        apart: int = field(default=5, hash=False)
        named: str = field(default="n", kw_only=True)

    @dataclass(frozen=True)
    class Below(Fields):
        """Inherits fields and comes with its own."""

        third: int = 7

    @dataclass(frozen=True, eq=False)
    class Last(Below):
        second: float = 9.0

    @dataclass(frozen=True)
    class Checked:
        value: int

        def __post_init__(self) -> None:
            if self.value < 0:
                raise ValueError(self.value)

    @dataclass(frozen=True)
    class Told:
        value: int

        def __repr__(self) -> str:
            return f"<{self.value}>"

    @dataclass(frozen=True)
    class OwnEquality:
        value: int

        def __eq__(self, other: object) -> bool:
            return True

    @dataclass(frozen=True)
    class OwnInit:
        value: int

        def __init__(self, text: str):
            object.__setattr__(self, "value", int(text))

    @dataclass(frozen=True, kw_only=True)
    class Named:
        a: int
        b: int = 1

    @dataclass(frozen=True, order=True)
    class Ordered:
        a: int

    @dataclass(frozen=True, slots=True)
    class Slotted:
        a: int = 1

    @dataclass
    class Open:
        a: int
        b: list[int] = field(default_factory=list)

    return {name: made for name, made in locals().items() if inspect.isclass(made)}


THEIRS, OURS = kinds(dataclasses.dataclass), kinds(frozen.dataclass)
CALLS: dict[str, list[tuple[tuple[Any, ...], dict[str, Any]]]] = {
    "Empty": [((), {}), ((1,), {})],
    "One": [((1,), {}), (((1, 2),), {}), ((math.nan,), {}), ((), {}), ((1, 2), {})],
    "Plain": [(("x",), {}), (("x", (1.0,), ["n"], 4), {}), ((), {"name": "y", "hidden": 1}), ((), {"other": 1})],
    "Fields": [((1,), {}), ((1, 3.0, 6), {"named": "m"}), ((1, 2.0, 3, "m"), {}), ((1,), {"kept": {}})],
    "Below": [((1,), {}), ((1, 3.0, 6, 8), {"named": "m"}), ((), {"first": 1, "third": 0})],
    "Last": [((1,), {}), ((1, 3.0), {"third": 2})],
    "Checked": [((1,), {}), ((-1,), {})],
    "Told": [((1,), {})],
    "OwnEquality": [((1,), {})],
    "OwnInit": [(("12",), {})],
    "Named": [((), {"a": 1}), ((1,), {}), ((), {"b": 1})],
    "Ordered": [((1,), {})],
    "Slotted": [((), {}), ((2,), {})],
    "Open": [((1,), {}), ((1, [2]), {})],
}
CASES = [(name, positional, named) for name, calls in CALLS.items() for positional, named in calls]


def outcome(call: Any) -> Any:
    """What a call gives, or the kind of its error."""
    try:
        return call()
    except Exception as error:
        return type(error)


def test_every_kind_is_called():
    assert CALLS.keys() == OURS.keys()


@pytest.mark.parametrize("name", CALLS)
def test_classes_tell_the_same_of_themselves(name: str):
    theirs, ours = THEIRS[name], OURS[name]
    shape = ("name", "type", "default", "default_factory", "init", "repr", "hash", "compare", "kw_only")
    assert [[getattr(f, key) for key in shape] for f in dataclasses.fields(ours)] == [
        [getattr(f, key) for key in shape] for f in dataclasses.fields(theirs)
    ]
    assert repr(ours.__dataclass_params__) == repr(theirs.__dataclass_params__)
    assert ours.__match_args__ == theirs.__match_args__
    assert str(inspect.signature(ours)) == str(inspect.signature(theirs))
    assert ours.__module__ == theirs.__module__ and ours.__qualname__ == theirs.__qualname__
    assert (ours.__hash__ is None) == (theirs.__hash__ is None)


@pytest.mark.parametrize(("name", "positional", "named"), CASES)
def test_records_are_the_same(name: str, positional: tuple[Any, ...], named: dict[str, Any]):
    theirs, ours = (outcome(lambda made=kind[name]: made(*positional, **named)) for kind in (THEIRS, OURS))
    if inspect.isclass(theirs):
        assert ours == theirs
        return
    assert repr(ours) == repr(theirs) and vars(type(ours)).keys() >= {"__dataclass_fields__"}
    assert outcome(lambda: dataclasses.asdict(ours)) == outcome(lambda: dataclasses.asdict(theirs)) or name == "One"
    assert outcome(lambda: hash(ours)) == outcome(lambda: hash(theirs)) or "__hash__" not in vars(type(ours))
    for one in (ours, theirs):
        assert one == one
        assert (one != object() and one != name) or name == "OwnEquality"
    again = [outcome(lambda made=kind[name]: made(*positional, **named)) for kind in (THEIRS, OURS)]
    assert (ours == again[1]) == (theirs == again[0])
    assert (ours == copy.copy(ours)) == (theirs == copy.copy(theirs))
    if name != "OwnInit":
        assert repr(dataclasses.replace(ours)) == repr(dataclasses.replace(theirs))


@pytest.mark.parametrize("name", CALLS)
def test_frozen_records_cannot_be_changed(name: str):
    positional, named = CALLS[name][0]
    for kind in (THEIRS, OURS):
        one = kind[name](*positional, **named)
        for field_name in [f.name for f in dataclasses.fields(one)] + ["something"]:
            expected = () if name == "Open" else FrozenInstanceError
            if not expected or (name == "Slotted" and field_name == "something"):
                continue
            with pytest.raises(expected):
                setattr(one, field_name, 1)
            with pytest.raises(expected):
                delattr(one, field_name)


@pytest.mark.parametrize("kind", [THEIRS, OURS])
def test_a_class_below_may_have_attributes_of_its_own(kind: dict[str, Any]):
    class Below(kind["One"]):
        pass

    below = Below(1)
    below.another = 2
    with pytest.raises(FrozenInstanceError):
        below.value = 2
    assert repr(below).endswith("Below(value=1)") and below != kind["One"](1)
    assert str(inspect.signature(Below)) == "(value: 'Any') -> None"

    class WithInit(kind["One"]):
        def __init__(self, other: str):
            super().__init__(len(other))

    assert str(inspect.signature(WithInit)) == "(other: 'str')" and WithInit("abc").value == 3


def test_what_contains_itself_is_shown():
    inside: list[Any] = []
    one = OURS["One"](inside)
    inside.append(one)
    assert repr(one).endswith("One(value=[...])")


def test_a_frozen_record_below_an_open_one_is_refused_as_there():
    for decorator in (dataclasses.dataclass, frozen.dataclass):
        with pytest.raises(TypeError):
            decorator(frozen=True)(type("Below", (OURS["Open"],), {"__annotations__": {}}))


def test_an_argument_without_default_after_one_with_is_refused():
    made = type("Wrong", (), {"__annotations__": {"a": "int", "b": "int"}, "a": 1})
    with pytest.raises((TypeError, SyntaxError)):
        frozen.dataclass(frozen=True)(made)(1, 2)


def test_a_mutable_default_is_refused():
    with pytest.raises(ValueError):  # noqa: PT011
        frozen.dataclass(frozen=True)(type("Wrong", (), {"__annotations__": {"a": "list"}, "a": []}))


def test_records_go_through_pickles_before_one_was_made():
    """In a process that has made none: what is unpickled never went through `__init__`."""
    from kinform.model.tolerances import Tolerances

    given = Tolerances()
    code = "import pickle, sys; one = pickle.load(sys.stdin.buffer); sys.stdout.write(repr(one)); one.__class__()"
    ran = subprocess.run([sys.executable, "-c", code], input=pickle.dumps(given), capture_output=True, check=True)
    assert ran.stdout.decode() == repr(given)


def records_of_the_library() -> list[type]:
    out = []
    for path in sorted((SOURCES / "kinform").rglob("*.py")):
        parts = path.relative_to(SOURCES).with_suffix("").parts
        if path.stem != "__main__" and "batch" not in parts:  # needs packages that may not be there
            module = importlib.import_module(".".join(parts[:-1] if parts[-1] == "__init__" else parts))
            classes = (made for made in vars(module).values() if inspect.isclass(made))
            out += [made for made in classes if made.__module__ == module.__name__ and dataclasses.is_dataclass(made)]
    return out


def test_the_records_of_the_library_take_what_their_fields_say():
    seen = records_of_the_library()
    assert len(seen) > 300
    for made in seen:
        fields = {f.name: f for f in dataclasses.fields(made) if f.init}
        takes = inspect.signature(made).parameters
        if "__init__" in vars(made) and "__signature__" not in vars(made):
            continue  # written by hand, or by the standard library
        assert list(takes) == sorted(fields, key=lambda name: fields[name].kw_only)
        for name, argument in takes.items():
            default = (fields[name].default, fields[name].default_factory)
            required = default == (dataclasses.MISSING, dataclasses.MISSING)
            assert (argument.default is inspect.Parameter.empty) == required, f"{made}.{name}"

"""An altered record is the one that `dataclasses.replace` makes, and one made at once that of its constructor."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from functools import cached_property

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinform.foundation.records import altered, made


@dataclass(frozen=True)
class _Box:
    width: float
    name: str = "box"
    inside: list[int] = field(default_factory=list)

    @cached_property
    def doubled(self) -> float:
        return 2.0 * self.width


values = st.fixed_dictionaries(
    {}, optional={"width": st.floats(allow_nan=False), "name": st.sampled_from(["", "b", "é"])}
)


@settings(max_examples=20)
@given(values)
def test_it_has_the_values_that_are_given_and_the_others_as_they_were(changes: dict) -> None:
    box = _Box(1.5, "a", [1, 2])
    other = altered(box, **changes)
    assert type(other) is _Box
    assert other == replace(box, **changes)
    assert other.inside is box.inside
    assert list(vars(other)) == [f.name for f in fields(box)]
    assert box == _Box(1.5, "a", [1, 2])


def test_what_was_found_of_the_first_does_not_stand_for_the_second() -> None:
    box = _Box(1.5)
    assert box.doubled == 3.0
    assert altered(box, width=2.0).doubled == 4.0


def test_it_is_frozen_and_has_no_other_fields() -> None:
    with pytest.raises(AttributeError):
        altered(_Box(1.0), width=2.0).width = 3.0  # type: ignore[misc]
    with pytest.raises(TypeError):
        altered(_Box(1.0), height=2.0)


def test_one_made_at_once_is_that_of_its_constructor() -> None:
    inside = [3]
    box = made(_Box, width=2.0, name="b", inside=inside)
    assert box == _Box(2.0, "b", [3])
    assert box.inside is inside
    assert box.doubled == 4.0
    with pytest.raises(AttributeError):
        box.width = 3.0  # type: ignore[misc]


@pytest.mark.parametrize("given", [{"width": 1.0}, {"width": 1.0, "name": "", "inside": [], "height": 2.0}])
def test_all_fields_and_no_others_are_given(given: dict) -> None:
    with pytest.raises(TypeError):
        made(_Box, **given)

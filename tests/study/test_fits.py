"""Tolerance classes against the formulas of ISO 286-1, and against values that every handbook has."""

from __future__ import annotations

import math

import pytest

from kinform.study.fits import GRADES, LOWER, STEPS, UPPER, limits


def means() -> list[float]:
    """The geometric mean of each step (mm); of the first the standard takes 1 and 3 mm."""
    return [math.sqrt(low * high) for low, high in zip((1, *STEPS[:-1]), STEPS, strict=True)]


@pytest.mark.parametrize(("grade", "factor"), [(5, 7), (6, 10), (7, 16), (8, 25), (9, 40), (10, 64), (11, 100)])
def test_grades_are_the_formula_rounded(grade, factor):
    for k, (value, size) in enumerate(zip(GRADES[grade], means(), strict=True)):
        unit = 0.45 * size ** (1 / 3) + 0.001 * size
        assert value == pytest.approx(factor * unit, rel=0.06 if k else 0.16, abs=1.0)  # up to 3 mm it is rounded up


@pytest.mark.parametrize(
    ("letter", "formula"),
    [
        ("d", lambda s: 16 * s**0.44), ("e", lambda s: 11 * s**0.41), ("f", lambda s: 5.5 * s**0.41),
        ("g", lambda s: 2.5 * s**0.34), ("n", lambda s: 5 * s**0.34), ("k", lambda s: 0.6 * s ** (1 / 3)),
    ],
)  # fmt: skip
def test_fundamental_deviations_are_the_formula_rounded(letter, formula):
    first = 1 if letter in LOWER else 0  # up to 3 mm the standard takes less for k and n
    for value, size in list(zip((UPPER | LOWER)[letter], means(), strict=True))[first:]:
        assert value == pytest.approx(formula(size), rel=0.05, abs=1.02)


def test_m_is_the_difference_of_grades_7_and_6_and_p_lies_at_grade_7():
    for m, p, six, seven in zip(LOWER["m"], LOWER["p"], GRADES[6], GRADES[7], strict=True):
        assert m == pytest.approx(seven - six, abs=1.0) or m == 2
        assert 0 <= p - seven <= 6 or p == 6


@pytest.mark.parametrize(
    ("text", "size", "expected"),
    [
        ("H7", 20, (0, 21)), ("g6", 20, (-20, -7)), ("H7/g6", 20, (7, 41)), ("h9", 50, (-62, 0)),
        ("js7", 25, (-10.5, 10.5)),
        ("p6", 25, (22, 35)), ("F8", 30, (20, 53)), ("H7/p6", 25, (-35, -1)), ("k6", 10, (1, 10)),
        ("H8/f7", 100, (36, 125)),
    ],
)  # fmt: skip
def test_classes_are_those_of_handbooks(text, size, expected):
    assert limits(text, size) == pytest.approx([value / 1000 for value in expected])


@pytest.mark.parametrize("text", ["H13", "K7", "P7", "u6", "7H", "g6/H7", "k8", "H4"])
def test_what_is_not_known_is_refused(text):
    with pytest.raises(ValueError) as caught:  # noqa: PT011
        limits(text, 20)
    assert text in str(caught.value)


@pytest.mark.parametrize("size", [0.0, -1.0, 501.0])
def test_sizes_outside_of_the_tables_are_refused(size):
    with pytest.raises(ValueError, match="500"):
        limits("H7", size)

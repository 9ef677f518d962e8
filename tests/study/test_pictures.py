"""Pictures of samples: bars that hold every sample, round ticks, axes with their names."""

from __future__ import annotations

import re

import numpy as np
import pytest

from kinform.study.pictures import histogram, scatter


def bars(svg: str) -> list[tuple[float, float]]:
    """Left end and height of each bar (px)."""
    found = re.findall(r'<rect x="([\d.]+)" y="[\d.]+" width="[\d.]+" height="([\d.]+)"', svg)
    return [(float(x), float(height)) for x, height in found]


@pytest.mark.parametrize(
    ("values", "count"),
    [(np.full(50, 3.0), 1), (np.repeat([1.0, 2.0, 4.0], 10), 3), (np.array([0.0, 1.0] * 5), 2)],
)
def test_whole_and_equal_values_have_a_bar_each(values, count):
    found = bars(histogram("mobility", values, []))
    assert len(found) == count and len({height for _, height in found}) == 1
    assert all(x >= 60.0 for x, _ in found)


def test_bars_grow_finer_with_more_samples_and_hold_them_all():
    many = np.random.default_rng(1).normal(size=4000)
    few, more = bars(histogram("x", many[:100], [])), bars(histogram("x", many, []))
    assert 8 <= len(few) < len(more) <= 60


@pytest.mark.parametrize("limits", [[], [0.0342, 0.0346]])
def test_axes_have_names_units_and_round_ticks(limits):
    values = np.linspace(0.03416, 0.03467, 60)
    svg = scatter("crank (mm)", "farthest (m)", np.linspace(29.8, 30.2, 60), values, limits)
    assert svg.count(">crank (mm)<") == 1 and svg.count(">farthest (m)<") == 1
    assert svg.count('class="limit"') == len(limits)
    ticks = [float(text) for text in re.findall(r">(-?[\d.]+)</text>", svg)]
    assert {29.8, 30.0, 30.2} <= set(ticks) and {0.0342, 0.0344, 0.0346} <= set(ticks)


def test_names_are_escaped():
    assert "<b>" not in histogram("<b>", np.array([1.0, 2.0, 3.5]), [])

"""Courses over time as lines of blocks in the terminal."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

from commands import Ran
from known import FIXTURES

from kinform import results
from kinform_cli.text import sparkline


def test_a_ramp_runs_through_all_levels_once() -> None:
    assert sparkline([float(k) for k in range(8)]) == "▁▂▃▄▅▆▇█"
    assert sparkline([float(k) for k in range(800)], 8) == "▁▂▃▄▅▆▇█"
    assert sparkline([-float(k) for k in range(8)]) == "█▇▆▅▄▃▂▁"


def test_what_is_not_known_is_blank_and_what_stays_is_level() -> None:
    assert sparkline([0.0, math.nan, 1.0]) == "▁ █"
    assert len(set(sparkline([5.0, 5.0, 5.0 + 1e-12]))) == 1
    assert sparkline([]) == ""
    assert sparkline([math.nan]) == " "


def test_a_simulation_is_shown_within_80_columns_and_without_blocks_where_there_are_none(
    kinform: Callable[..., Ran], tmp_path: Path, derive_design: Callable
) -> None:
    design = derive_design(FIXTURES / "seekers" / "seeker_2dof" / "seeker_2dof.toml")
    results.write(design, tmp_path / "a.h5")
    shown = kinform("show", "a.h5", "simulation", PYTHONIOENCODING="utf-8").stdout
    assert max(map(len, shown.splitlines())) <= 80
    assert shown.count("█") > 2
    plain = kinform("show", "a.h5", "simulation", PYTHONIOENCODING="ascii").stdout
    assert "over time" not in plain
    assert "energy" in plain

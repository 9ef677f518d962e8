"""How far requirements are from their limits: the sign is that of the answer, the size that of the value."""

from __future__ import annotations

import math
import shutil
from dataclasses import replace

import pytest
from support.devices import sine
from support.places import FIXTURES
from support.requirements import G, arm, bar, requiring, wall, wheel

from kinform import stages
from kinform.consistency import margins
from kinform.study.work import measure


@pytest.mark.parametrize(
    ("made", "kind", "values", "expected", "unit"),
    [
        (arm, "mass", {"of": "upper", "minimum": 0.9, "maximum": 1.3}, 0.1, "kg"),
        (arm, "mass", {"of": "upper", "maximum": 0.8}, -0.2, "kg"),
        (arm, "centre_of_mass", {"of": "upper", "point": [0.15, 0.02, 0.0], "tolerance": 0.05}, 0.03, "m"),
        (arm, "hold", {"joint": "shoulder", "limit": 5.0}, 5.0 - G * (0.15 + 0.5 * 0.45), "N·m"),
        (wheel, "balance", {"of": "disc", "joint": "spin", "limit": 0.02}, None, "kg·m"),
    ],
)
def test_a_margin_is_what_is_left_to_the_nearest_bound(made, kind, values, expected, unit):
    given = made(com=(0.003, 0.004, 0.1)) if made is wheel else made()
    (found,) = margins(requiring(given, kind, **values)).values()
    left = 0.02 - 0.005 * 2.0 if expected is None else expected
    assert found.value == pytest.approx(left, abs=1e-9) and found.unit == unit


def test_margins_of_a_run_count_what_peaks_between_its_times_and_need_its_end():
    made, peak = wheel(sine(30.0, 0.5)), math.radians(30.0) * math.pi
    for limit in (1.2 * peak, 0.7 * peak):
        (found,) = margins(requiring(made, "speed", joint="spin", limit=limit)).values()
        assert found.value == pytest.approx(limit - peak, abs=1e-4) and found.unit == "rad/s"
    stopped = replace(made, simulation=replace(made.simulation, status="stopped", reason="singular"))
    assert margins(requiring(stopped, "speed", joint="spin", limit=0.7 * peak)) == {"r": None}


def test_what_is_not_decided_has_no_margin():
    assert margins(requiring(arm(), "mass", of="upper")) == {"r": None}
    assert margins(requiring(replace(arm(), mass=None), "mass", of="upper", maximum=1.0)) == {"r": None}


MASS = 0.0648
"""kg of the block."""


@pytest.fixture
def judged(tmp_path):
    """The margins of a planar block with these requirements."""

    def of(text):
        folder = shutil.copytree(FIXTURES / "pairs" / "planar_block", tmp_path / "block")
        (manifest,) = folder.glob("*.toml")
        with manifest.open("a") as stream:
            stream.write(text)
        design = stages.check(stages.simulate(stages.mass(stages.joints(stages.contacts(stages.import_(manifest))))))
        found = {f.subject[0] for f in design.report.findings if f.code.startswith(("KF42", "KF43"))}
        values = {name: margin and margin.value for name, margin in margins(design).items()}
        assert measure(design, [("margins", name) for name in values]) == tuple(values.values())
        return values, found

    return of


def requirement(name, kind, **values):
    lines = [f"{key} = {value}" for key, value in values.items()]
    return "\n".join(["", "[[function.require]]", f'name = "{name}"', f'kind = "{kind}"', *lines, ""])


def test_margins_are_of_the_value_to_its_nearest_limit(judged):
    text = requirement("light", "mass", of='"block"', maximum=0.07)
    text += requirement("between", "mass", of='"block"', minimum=0.06, maximum=0.08)
    text += requirement("too_light", "mass", of='"block"', minimum=0.1)
    text += requirement("centred", "centre_of_mass", of='"block"', point=[0, 0, 0], tolerance=1000)
    found, violated = judged(text)
    assert found["light"] == pytest.approx(0.07 - MASS, abs=1e-6)
    assert found["between"] == pytest.approx(MASS - 0.06, abs=1e-6)
    assert found["too_light"] == pytest.approx(MASS - 0.1, abs=1e-6)
    assert 0.9 < found["centred"] < 1.0
    assert violated == {"too_light"} == {name for name, margin in found.items() if margin < 0}


def test_what_is_no_matter_of_a_value_has_no_margin(judged):
    found, _ = judged(requirement("kept", "retained", part='"block"'))
    assert found == {"kept": None}


def test_a_clearance_has_no_margin():
    """The sweep stops where the distance is certain: the nearest of its poses is not the nearest of all."""
    given = {"between": ["bar", "base"], "over": "ranges"}
    assert margins(requiring(bar(wall()), "clear", distance=0.0, **given)) == {"r": None}
    assert margins(requiring(bar(wall()), "clear", distance=0.02, **given)) == {"r": None}

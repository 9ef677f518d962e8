"""How far requirements are from their limits: the sign is that of the answer, the size that of the value."""

from __future__ import annotations

import shutil

import pytest
from support.places import FIXTURES

from kinform import stages
from kinform.consistency import margins
from kinform.study.work import measure

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
        assert measure(design, [("margins", name) for name in margins(design)]) == tuple(margins(design).values())
        return margins(design), found

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

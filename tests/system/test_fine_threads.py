"""A thread that advances little beside its size is a thread: a function that states a turn is contradicted."""

from __future__ import annotations

import shutil

import pytest
from support.places import FIXTURES

from kinform import stages


@pytest.mark.parametrize("complete", [False, True])
@pytest.mark.parametrize("profile", ["design", "description"])
def test_a_nut_on_a_lead_screw_is_no_pivot(tmp_path, complete, profile):
    """4 mm a turn, over a nut that is 40 mm long: the motion of the turn is a hundredth off."""
    shutil.copytree(FIXTURES / "pairs" / "screw_right", tmp_path / "screw")
    manifest = tmp_path / "screw" / "screw_right.toml"
    text = manifest.read_text().replace('type = "screw"', 'type = "revolute"').replace("pitch = 4\n", "")
    assert text.count('"revolute"') == 1
    assert "pitch" not in text
    text = text.replace("[function]\n", f"[function]\ncomplete = {str(complete).lower()}\n")
    manifest.write_text(text + f'[check]\nprofile = "{profile}"\n')
    design = stages.mass(stages.joints(stages.contacts(stages.import_(manifest))))
    design = stages.check(stages.simulate(design, ranges=False))
    assert [(joint.type, joint.status) for joint in design.kinematics.joints] == [("screw", "determined")]
    assert {(f.code, f.severity) for f in design.report.findings if f.code in ("KF402", "KF414")} == {
        ("KF402", "error")
    }

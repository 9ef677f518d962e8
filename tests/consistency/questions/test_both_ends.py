"""Loops that are shaky or singular by contact that only pushes: a note, and no warning."""

from __future__ import annotations

from dataclasses import replace

import pytest
from support.mistakes import changed_function
from support.places import FIXTURES

from kinform.consistency import check
from kinform.model.kinematics import FiniteCertificate


@pytest.mark.parametrize(
    ("code", "values"),
    [("KF305", {"infinitesimal": 1}), ("KF306", {"singular": True, "branches": (1, 1)})],
)
@pytest.mark.parametrize("stated", [None, 1, 2, 3])
@pytest.mark.parametrize("at_ends", [True, False])
def test_a_warning_holds_at_both_ends(derive_design, code, values, stated, at_ends):
    """Mobility 1 at the low end, 3 at the high one."""
    made = derive_design(FIXTURES / "pairs" / "revolute_collars" / "revolute_collars.toml")
    kinematics = made.kinematics
    name = kinematics.joints[0].name
    certificate = FiniteCertificate((name,), 1, 1, moves=(name,), at_ends=at_ends, **values)
    mobility = replace(kinematics.mobility, certificates=(certificate,), low=1, high=3)
    made = replace(made, kinematics=replace(kinematics, mobility=mobility))
    report = check(changed_function(made, mobility=stated))
    (finding,) = (one for one in report.findings if one.code == code)
    (rule,) = (one for one in report.rules if one.code == code)
    assert finding.severity == ("warning" if at_ends else "note")
    assert rule.outcome == ("failed" if at_ends else "inconclusive" if stated == 2 else "passed")

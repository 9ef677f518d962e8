"""What is said of a joint that contact does not decide begins with what is missing, not with singular values."""

from __future__ import annotations

import re

import pytest
from support.places import manifests

from kinform.model.findings import Finding

AMBIGUOUS = [m for m in manifests() if m.stem in ("boss_sliver", "finger_at_stop", "piston_at_bottom")]


@pytest.mark.parametrize("manifest", AMBIGUOUS, ids=lambda m: m.stem)
def test_what_was_found_is_two_kinds_of_joints(manifest, derive_design):
    report = derive_design(manifest).report
    found: list[Finding] = [f for f in report.findings if f.code == "KF901"]
    assert found
    for finding in found:
        assert "singular" not in (finding.found or "")
        assert not re.match(r"[^:]*: singular", finding.message)
        assert finding.remedy

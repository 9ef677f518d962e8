"""Each rule fires on a design that is wrong in its way, and only there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.linkages import KNOWN, manifest
from support.mistakes import (
    UNDECIDED,
    WRONG,
    changed_function,
    changed_intent,
    changed_mesh,
    with_function,
)
from support.places import FIXTURES

from kinform.consistency import RULES, UnknownRuleError, check, explain, verdict
from kinform.model.findings import SEVERITIES, CheckReport, Finding, RuleOutcome
from kinform.model.function import Coupling, Function, IntendedJoint, Requirement, SimulationRequest

HINGE = FIXTURES / "pairs" / "revolute_collars" / "revolute_collars.toml"


@pytest.fixture
def hinge(derive_design):
    """A sound hinge with the function that it has."""
    design = derive_design(HINGE)
    joint = design.kinematics.joints[0]
    stated = IntendedJoint("swing", joint.bodies, "revolute", joint.axis, None, joint.point, None, None, "m.toml", 20)
    return with_function(design, Function(mobility=1, mobility_line=19, joints=(stated,)))


def codes(design):
    return {finding.code for finding in check(design).findings}


def outcome(design, code):
    return next(rule.outcome for rule in check(design).rules if rule.code == code)


def test_a_sound_design_has_no_finding_and_passes(hinge):
    report = check(hinge)
    assert report.findings == ()
    assert verdict(report) == 0


@pytest.mark.parametrize("code", WRONG)
def test_a_rule_fires_on_what_it_is_about(hinge, code):
    assert code not in codes(hinge)
    wrong = WRONG[code](hinge)
    report = check(wrong)
    found = [finding for finding in report.findings if finding.code == code]
    assert found
    for finding in found:
        assert finding.severity in SEVERITIES
        assert finding.subject
        assert finding.message
        assert finding.file is not None or finding.place is not None
    notes_only = all(finding.severity == "note" for finding in found)
    assert next(rule.outcome for rule in report.rules if rule.code == code) == ("passed" if notes_only else "failed")


@pytest.mark.parametrize("code", UNDECIDED)
def test_what_no_rule_can_decide_is_not_a_pass(hinge, code):
    assert outcome(hinge, code) != "inconclusive"
    report = check(UNDECIDED[code](hinge))
    assert next(rule.outcome for rule in report.rules if rule.code == code) == "inconclusive"
    assert verdict(report) != 0


def test_a_part_that_touches_nothing_is_found(derive_design, hinge):
    apart = derive_design(FIXTURES / "pairs" / "free_apart" / "free_apart.toml")
    assert "KF203" in codes(apart)
    assert "KF203" not in codes(hinge)


def test_an_intended_joint_without_contact_is_missing(derive_design):
    apart = derive_design(FIXTURES / "pairs" / "free_apart" / "free_apart.toml")
    first, second = (part.name for part in apart.assembly.parts)
    wanted = IntendedJoint(
        "j", (first, second), "revolute", np.array([0, 0, 1.0]), None, np.zeros(3), None, None, "m", 1
    )
    assert "KF401" in codes(with_function(apart, Function(joints=(wanted,))))


def test_a_dynamic_level_needs_densities(hinge):
    asked = replace(
        hinge.assembly,
        parts=tuple(replace(part, density=None) for part in hinge.assembly.parts),
        simulation=SimulationRequest("dynamic", file="m.toml", line=50),
    )
    from kinform.mass import compile_mass
    from kinform.simulation import simulate

    mass = compile_mass(asked, hinge.kinematics)
    design = replace(hinge, assembly=asked, mass=mass, simulation=simulate(asked, hinge.kinematics, mass))
    assert "KF120" in codes(design)
    assert "KF120" not in codes(hinge)


@pytest.fixture
def sticks(derive_design, tmp_path):
    """A mechanism of linkages.py as a design of sticks that states its mobility."""

    def made(name, mobility):
        path = tmp_path / f"{name}.toml"
        path.write_text(manifest(KNOWN[name][0], mobility=mobility))
        return derive_design(path)

    return made


def test_a_freedom_that_is_only_infinitesimal_is_found(sticks):
    design = sticks("shaky truss", 1)
    (finding,) = (f for f in design.report.findings if f.code == "KF305")
    assert finding.severity == "warning"
    assert finding.subject == ("base~link1", "base~link2", "link1~link2")
    # what a velocity allows is no mobility
    assert "KF301" in codes(design)
    assert "KF306" not in codes(design)


def test_a_pose_from_which_two_motions_lead_is_found(sticks):
    design = sticks("flat parallelogram", 1)
    (finding,) = (f for f in design.report.findings if f.code == "KF306")
    assert finding.severity == "warning"
    (certificate,) = (one for one in design.kinematics.mobility.certificates if one.singular)
    assert certificate.branches == (1, 1)
    assert not codes(design) & {"KF301", "KF305"}


@pytest.mark.parametrize("name", ["parallelogram", "Bennett", "Roberval balance", "Watt six-bar"])
def test_mechanisms_that_move_are_neither_shaky_nor_singular(sticks, name):
    design = sticks(name, 1)
    assert not codes(design) & {"KF301", "KF305", "KF306"}
    assert outcome(design, "KF305") == outcome(design, "KF306") == "passed"


def test_a_stated_mobility_of_loops_that_could_not_be_tried_is_not_verified(hinge):
    kinematics = hinge.kinematics
    mobility = replace(kinematics.mobility, finite=None, finite_reason="not known: x is ambiguous")
    unknown = replace(hinge, kinematics=replace(kinematics, mobility=mobility))
    assert outcome(unknown, "KF305") == "inconclusive"
    assert outcome(changed_function(unknown, mobility=None), "KF305") == "passed"


def test_findings_do_not_depend_on_the_order_of_parts(hinge):
    wrong = changed_function(changed_mesh(hinge, watertight=False), mobility=4)
    turned = replace(wrong, assembly=replace(wrong.assembly, parts=wrong.assembly.parts[::-1]))
    assert check(wrong).findings == check(turned).findings


def test_stages_that_were_not_run_leave_rules_undecided(hinge):
    report = check(replace(hinge, kinematics=None))
    assert next(rule.outcome for rule in report.rules if rule.code == "KF402") == "inconclusive"
    assert verdict(report) == 2


STAGES = ("contacts", "kinematics", "mass", "simulation")


@pytest.mark.parametrize("missing", [STAGES[k:] for k in range(4)] + [(stage,) for stage in STAGES], ids=" ".join)
def test_rules_declare_all_that_they_need(hinge, missing):
    # what a rule reads without having declared it raises LookupError
    wanted = Requirement("weak", "torque", {"joint": "swing", "limit": 1.0}, "m.toml", 40)
    held = Requirement("held", "retained", {"part": "shaft"}, "m.toml", 41)
    asked = changed_function(
        hinge, requirements=(wanted, held), couplings=(Coupling(("swing", "swing"), 2.0, "m.toml", 42),)
    )
    report = check(replace(asked, **dict.fromkeys(missing)))
    assert [rule.code for rule in report.rules] == [rule.code for rule in RULES]
    assert verdict(report) == 2


def test_the_registry_is_sorted_unique_and_documented():
    listed = [rule.code for rule in RULES]
    assert listed == sorted(set(listed))
    for rule in RULES:
        assert rule.code in explain(rule.code)
    with pytest.raises(UnknownRuleError):
        explain("KF999")


@given(
    severities=st.lists(st.sampled_from(SEVERITIES), max_size=4),
    outcomes=st.lists(st.sampled_from(["passed", "failed", "inconclusive", "skipped"]), max_size=4),
    fail_on=st.sampled_from(SEVERITIES),
)
def test_the_verdict_is_one_for_findings_two_for_doubt_and_zero_only_for_a_pass(severities, outcomes, fail_on):
    report = CheckReport(
        tuple(Finding("KF1", "x", severity, ("a",), "m") for severity in severities),
        tuple(RuleOutcome("KF1", "x", name) for name in outcomes),
    )
    bad = any(SEVERITIES.index(s) >= SEVERITIES.index(fail_on) for s in severities)
    doubt = "inconclusive" in outcomes or all(name == "skipped" for name in outcomes)
    assert verdict(report, fail_on) == (1 if bad else 2 if doubt else 0)


def test_a_closure_is_contradicted_only_by_contact_that_lets_nothing_of_it_move(hinge):
    """A hinge does part of what two points that are one leave free; about another axis it does nothing of it."""
    closing = check(changed_intent(hinge, type="spherical", closure=True))
    assert "KF402" not in {finding.code for finding in closing.findings}
    assert next(rule.outcome for rule in closing.rules if rule.code == "KF402") == "inconclusive"
    beside = hinge.assembly.function.joints[0].point + np.array([1.0, 2.0, 3.0])
    elsewhere = check(changed_intent(hinge, type="spherical", closure=True, point=beside))
    assert "KF402" in {finding.code for finding in elsewhere.findings}
    stated = check(changed_intent(hinge, type="spherical"))
    assert "KF402" in {finding.code for finding in stated.findings}

"""Simulations in which what is not understood is held: what moves is right, and nothing that it shows passes."""

from __future__ import annotations

import numpy as np
from support.devices import Z, device, drive, joint, rod
from support.export_models import design
from support.places import shared

import kinform
from kinform import results
from kinform.exports import export
from kinform.model.function import Law
from kinform.simulation import simulate

DOWN = np.array([0.0, -9.81, 0.0])


def _arm(tip, drives=(), **request):
    """Two rods in a row, the second on a joint of the kind `tip`, and a wheel apart from them."""
    parts = [rod("arm", (0, 0, 0), (1, 0, 0)), rod("tip", (1, 0, 0), (2, 0, 0)), rod("wheel", (0, 3, 0), (1, 3, 0))]
    joints = [
        joint("arm", "base", "revolute", Z, (0, 0, 0)),
        joint("arm", "tip", tip, Z, (1, 0, 0), **({"freedoms": 2} if tip == "general" else {})),
        joint("base", "wheel", "revolute", Z, (0, 3, 0)),
    ]
    return device(parts, joints, drives=drives, duration=0.5, step=0.05, gravity=DOWN, **request)


def test_what_is_not_understood_is_held_and_the_rest_moves():
    run = simulate(*_arm("general", partial=True))
    whole = simulate(*_arm("fixed"))
    assert (run.status, whole.status) == ("partial", "done") and run.partial and not whole.partial
    assert [subject for subject, _ in run.failures] == ["arm~tip"]
    np.testing.assert_allclose(run.p_WB, whole.p_WB, atol=1e-12)
    # A rod of 2 m and 2 kg on its end: m g L/2 over m L²/3.
    np.testing.assert_allclose(abs(run.joint_acceleration[0, 0]), 1.5 * 9.81 / 2.0, rtol=1e-12)


def test_without_partial_nothing_runs():
    run = simulate(*_arm("general"))
    assert run.status == "refused" and not len(run.time)
    assert [subject for subject, _ in run.failures] == ["arm~tip"]


def test_what_acts_on_a_held_joint_is_named_with_it():
    push = drive("arm~tip", "motion", Law("constant", value=1.0))
    run = simulate(*_arm("general", [push], partial=True))
    assert run.status == "partial"
    assert [subject for subject, _ in run.failures] == ["arm~tip", "arm~tip"]
    # A drive on a joint that does not exist is a mistake, and no partial run.
    run = simulate(*_arm("general", [drive("elbow", "motion", Law("constant", value=1.0))], partial=True))
    assert run.status == "refused"


def test_a_partial_run_verifies_nothing(tmp_path):
    text = (shared("cases/motion") / "planetary/design.toml").read_text().replace('mesh = "', f'mesh = "{_folder()}/')
    (tmp_path / "design.toml").write_text(text.replace("duration = 0.2", "duration = 0.2\npartial = true"))
    done = kinform.run(tmp_path / "design.toml", allow_outside=True)
    assert done.simulation.status == "partial"
    outcomes = {rule.code: rule.outcome for rule in done.report.rules}
    reading = ("KF501", "KF502", "KF503", "KF504", "KF505", "KF506", "KF507")
    assert {outcomes[code] for code in reading} == {"inconclusive"}


def _folder():
    return shared("cases/motion") / "planetary"


def test_results_and_exports_of_a_partial_run_say_so(tmp_path):
    found = design(_arm("general", partial=True))
    made = export(found, "json")
    assert any("arm~tip" in text for text in made.lost)
    results.write(found, tmp_path / "r.h5")
    again = results.read(tmp_path / "r.h5")
    assert again.simulation.status == "partial" and again.simulation.failures == found.simulation.failures
    assert again.assembly.simulation.partial

"""`kinform check --baseline`, `--write-baseline` and `--witness`, and `[check]` through the command."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from support.places import FIXTURES

from kinform import results
from kinform_cli.main import main

TWIN = FIXTURES / "broken" / "seeker_gimbal_overlaps"


@pytest.fixture(scope="module")
def overlapping(tmp_path_factory: pytest.TempPathFactory, derive_design) -> Path:
    """Results of a design with one error (KF201)."""
    file = tmp_path_factory.mktemp("baseline") / "r.h5"
    results.write(derive_design(TWIN / f"{TWIN.name}.toml"), file)
    return file


def test_a_written_baseline_turns_the_gate_green(
    overlapping: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    baseline = tmp_path / "b.json"
    assert main(["check", str(overlapping), "--write-baseline", str(baseline)]) == 1
    first = baseline.read_bytes()
    assert b"KF201" in first
    capsys.readouterr()
    assert main(["check", str(overlapping), "--baseline", str(baseline), "-f", "json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["findings"] == []
    # written again on top of itself: the same bytes
    main(["check", str(overlapping), "--baseline", str(baseline), "--write-baseline", str(baseline), "-q"])
    assert baseline.read_bytes() == first
    assert main(["check", str(overlapping), "--baseline", str(baseline), "-f", "concise"]) == 0
    assert "KF201" not in capsys.readouterr().out


def test_what_is_no_longer_found_is_told(overlapping: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    baseline = tmp_path / "b.json"
    entry = {"code": "KF101", "subject": ["a <b>\n[c]"], "severity": "error", "count": 1}
    baseline.write_text(json.dumps({"schema": "kinform/baseline/1", "findings": [entry]}))
    assert main(["check", str(overlapping), "--baseline", str(baseline)]) == 1
    assert "KF101 a <b>\\n[c]" in capsys.readouterr().err


@pytest.mark.parametrize("text", [None, "no json", "{}"])
def test_a_bad_baseline_is_exit_2_and_names_the_file(
    overlapping: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str | None
) -> None:
    baseline = tmp_path / "b.json"
    if text is not None:
        baseline.write_text(text)
    assert main(["check", str(overlapping), "--baseline", str(baseline)]) == 2
    assert "b.json" in capsys.readouterr().err


def test_settings_of_the_manifest_hold_in_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = FIXTURES / "pairs" / "revolute_collars"
    for mesh in source.glob("*.stl"):
        (tmp_path / mesh.name).write_bytes(mesh.read_bytes())
    text = (source / "revolute_collars.toml").read_text()
    manifest = tmp_path / "m.toml"
    manifest.write_text(text.replace("mobility = 1", "mobility = 2"))
    assert main(["run", str(manifest), "-q"]) == 1
    manifest.write_text(
        text.replace("mobility = 1", "mobility = 2")
        + '\n[[check.ignore]]\ncode = "KF301"\nreason = "a spring is missing yet"\n'
    )
    capsys.readouterr()
    assert main(["run", str(manifest), "-f", "json"]) == 0
    document = json.loads(capsys.readouterr().out)
    (rule,) = (r for r in document["rules"] if r["code"] == "KF301")
    assert rule["outcome"] == "ignored"
    assert "a spring is missing yet" in rule["reason"]
    manifest.write_text(text + '\n[check]\nselect = ["KF405"]\n')
    assert main(["run", str(manifest)]) == 2


def test_witnesses_are_replayed_and_one_that_does_not_hold_fails(
    overlapping: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["check", str(overlapping), "--witness", "-f", "json"]) == 0
    document = json.loads(capsys.readouterr().out)
    (one,) = (item for item in document["witnesses"] if item["severity"] == "error")
    assert (one["code"], one["kind"], one["outcome"]) == ("KF201", "geometric", "holds")
    assert document["counts"]["does not hold"] == 0
    design = results.read(overlapping)
    wrong = [f for f in design.report.findings if f.code == "KF201"]
    findings = tuple(replace(f, witness=replace(f.witness, gap=2.0 * f.witness.gap)) for f in wrong)
    forged = tmp_path / "forged.h5"
    results.write(replace(design, report=replace(design.report, findings=findings)), forged)
    assert main(["check", str(forged), "--witness"]) == 1
    assert "does not hold: KF201" in capsys.readouterr().out


def test_witnesses_are_text_or_json(overlapping: Path) -> None:
    assert main(["check", str(overlapping), "--witness", "-f", "sarif"]) == 2


def test_witnesses_are_replayed_alone(overlapping: Path, tmp_path: Path) -> None:
    assert main(["check", str(overlapping), "--witness", "--write-baseline", str(tmp_path / "b.json")]) == 2
    assert not (tmp_path / "b.json").exists()

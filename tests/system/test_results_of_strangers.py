"""Earlier results are reused only where this user's kinform wrote them, or the command says so."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from support.command_line import ran_here
from support.places import ROOT
from support.sealing import editing

import kinform
from kinform import results
from kinform.batch import record
from kinform.reports import FORMATS, render
from kinform.results import NotWholeError

DESIGN = ROOT / "examples" / "slider_crank.toml"
STAGES = ("contacts", "joints", "mass", "simulate")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A design that does not do what it states, and its results."""
    folder = tmp_path_factory.mktemp("made")
    (folder / "m.toml").write_text(DESIGN.read_text().replace("mobility = 1", "mobility = 3"))
    assert ran_here("run", "m.toml", "-o", "m.h5", cwd=folder).returncode == 1
    return folder


@pytest.fixture
def folder(made, tmp_path, monkeypatch):
    """As `made`, for a user that never ran kinform."""
    shutil.copytree(made, tmp_path / "design")
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    return tmp_path / "design"


def forge(path: Path) -> bytes:
    """Results without their findings, sealed again; gives the bytes."""
    with editing(path) as file:
        group = file["findings"]
        rules = group["rules"][...]
        rules["outcome"] = [b"passed" if one in (b"failed", b"inconclusive") else one for one in rules["outcome"]]
        group["rules"][...] = rules
        units, none = dict(group["findings"].attrs), group["findings"][...][:0]
        del group["findings"]
        group.create_dataset("findings", data=none).attrs.update(units)
    return path.read_bytes()


def document(ran):
    """The JSON that a command printed."""
    return json.loads(ran.stdout)


def test_forged_results_are_computed_anew(folder, made):
    forge(folder / "m.h5")
    ran = ran_here("run", "m.toml", "-o", "m.h5", "-f", "json", cwd=folder)
    assert ran.returncode == 1 and not document(ran)["run"]["reused"] and "origin" not in document(ran)
    assert len(re.findall(r"m\.h5: .*--trust-results", ran.stderr)) == 1
    assert (folder / "m.h5").read_bytes() == (made / "m.h5").read_bytes()
    again = ran_here("run", "m.toml", "-o", "m.h5", "-f", "json", cwd=folder)
    assert again.returncode == 1 and not document(again)["run"]["recomputed"] and "--trust-results" not in again.stderr


def test_honest_results_of_another_machine_are_computed_anew_too(folder, made):
    ran = ran_here("run", "m.toml", "-o", "m.h5", "-f", "json", cwd=folder)
    assert ran.returncode == 1 and not document(ran)["run"]["reused"]
    assert (folder / "m.h5").read_bytes() == (made / "m.h5").read_bytes()


def test_a_changed_design_takes_nothing_over_from_results_of_unknown_origin(folder):
    (folder / "m.toml").write_text((folder / "m.toml").read_text().replace("rate = 180", "rate = 170"))
    ran = ran_here("run", "m.toml", "-o", "m.h5", "-f", "json", cwd=folder)
    assert ran.returncode == 1 and not document(ran)["run"]["reused"]


def test_trusted_results_are_used_said_and_not_recorded(folder):
    forged = forge(folder / "m.h5")
    ran = ran_here("run", "m.toml", "-o", "m.h5", "--trust-results", "-f", "json", cwd=folder)
    assert ran.returncode == 0 and document(ran)["origin"] == "unknown"
    assert "nothing changed" not in ran.stdout + ran.stderr
    assert (folder / "m.h5").read_bytes() == forged
    assert ran_here("run", "m.toml", "-o", "m.h5", cwd=folder).returncode == 1


def test_the_python_interface_trusts_no_more_than_the_command(folder):
    forge(folder / "m.h5")
    said: list[str] = []
    outcome = kinform.run(folder / "m.toml", folder / "m.h5", trust_results=True)
    assert not outcome.findings and outcome.report.origin == "unknown"
    assert outcome.account and "nothing changed" not in outcome.account
    outcome = kinform.run(folder / "m.toml", folder / "m.h5", say=said.append)
    assert outcome.findings and not outcome.reused and len(said) == 1 and outcome.report.origin == "recorded"
    assert kinform.run(folder / "m.toml", folder / "m.h5").reused


def test_a_named_file_is_checked_and_the_verdict_says_that_its_origin_is_unknown(folder):
    assert ran_here("check", "m.h5", "--write-baseline", "b.json", cwd=folder).returncode == 1
    for more, code in (((), 0), (("--strict",), 2)):
        ran = ran_here("check", "m.h5", "--baseline", "b.json", *more, "-f", "json", cwd=folder)
        assert ran.returncode == code and document(ran)["origin"] == "unknown"
        assert (document(ran)["exit_code"], "not verified" in document(ran)["verdict"]) == (code, code == 2)
    assert ran_here("check", "m.h5", "--strict", cwd=folder).returncode == 1
    assert ran_here("import", "m.toml", "-o", "m.h5", cwd=folder).returncode == 0
    for stage in STAGES:
        assert ran_here(stage, "m.h5", "-o", "m.h5", cwd=folder).returncode == 0
    ran = ran_here("check", "m.h5", "--baseline", "b.json", "--strict", "-f", "json", cwd=folder)
    assert ran.returncode == 0 and "origin" not in document(ran)


@pytest.mark.parametrize("format", FORMATS)
@pytest.mark.parametrize("strict", [False, True])
def test_every_format_says_that_the_origin_is_unknown(format, strict, made):
    design = results.read(made / "m.h5")
    for report in (design.report, replace(design.report, findings=())):
        told, same = (
            render(replace(report, origin=one, strict=strict), design, format) for one in ("unknown", "recorded")
        )
        assert told != same and "unknown" in told


@pytest.mark.parametrize("stage", ["contacts", pytest.param("joints", marks=pytest.mark.sweep)])
def test_a_stage_records_what_it_made_only_where_its_input_was_recorded(stage, folder):
    with editing(folder / "m.h5") as file:
        table = file["assembly/parts"][...]
        table["density"] = 1000.0
        file["assembly/parts"][...] = table
    for target in ("m.h5", "other.h5"):
        assert ran_here(stage, "m.h5", "-o", target, cwd=folder).returncode == 0
        assert results.is_unknown(folder / target)
    kinform.open(folder / "m.h5").save(folder / "saved.h5")
    assert results.is_unknown(folder / "saved.h5")


def test_results_beside_a_design_are_looked_at_only_where_they_are_recorded(folder):
    forge(folder / "m.h5")
    ran = ran_here("check", "m.toml", "-f", "json", cwd=folder)
    assert ran.returncode == 1 and "origin" not in document(ran) and "m.h5" in ran.stderr
    ran_here("run", "m.toml", "-o", "m.h5", cwd=folder)
    assert ran_here("check", "m.toml", cwd=folder).returncode == 1


def test_a_state_folder_that_cannot_be_written_means_computing_anew(folder, monkeypatch):
    (folder.parent / "state").write_text("")
    for _ in range(2):
        ran = ran_here("run", "m.toml", "-o", "m.h5", "-f", "json", cwd=folder)
        assert ran.returncode == 1 and not document(ran)["run"]["reused"] and "origin" not in document(ran)
        assert "state" in ran.stderr  # why


def test_damage_is_told_before_origin(folder):
    (folder / "m.h5").write_bytes((folder / "m.h5").read_bytes()[:-1])
    with pytest.raises(NotWholeError):
        results.read(folder / "m.h5")
    assert not results.is_unknown(folder / "m.h5")
    assert ran_here("run", "m.toml", "-o", "m.h5", cwd=folder).returncode == 1


def row(folder: Path) -> record.Row:
    """What a batch would have noted of the forged results."""
    from kinform.batch.work import summary_of

    gist = results.read_gist(folder / "m.h5")
    fields = summary_of(gist, (folder / "m.h5").read_bytes(), [])
    del fields["seal"]
    return record.Row(name="m.toml", source="m.toml", results="m.h5", **{**fields, "recorded": True})


def test_a_planted_record_of_a_batch_is_not_believed(folder, monkeypatch):
    forge(folder / "m.h5")
    planted = record.Record({"m.toml": row(folder)})
    with monkeypatch.context() as patch:
        patch.setenv("XDG_STATE_HOME", str(folder.parent / "of a stranger"))
        record.write(planted, folder)
    kept = record.read(folder)
    assert not kept.rows and kept.note
    assert [one.recorded for one in record.read(folder, trust=True).rows.values()] == [False]
    record.write(record.read(folder, trust=True), folder)  # which records the file, not its rows
    assert not record.read(folder).rows and not record.read(folder).note
    record.write(planted, folder)
    assert record.read(folder).rows["m.toml"].recorded

"""Many designs by a crew: the bytes of single runs, whatever happens to workers."""

from __future__ import annotations

import json
import os
import shutil
import signal
import sys
import threading
import time
from pathlib import Path
from xml.etree import ElementTree

import pytest
from support.command_line import at_work, ran_here
from support.places import FIXTURES

import kinform
from kinform import catalog
from kinform.batch import Found, Settings, discover, record, render, session, work
from kinform.batch import run as run_batch
from kinform.batch.record import Row
from kinform.batch.renderings import summary_line

pytest.importorskip("distributed")

BAD = os.fsdecode(b"\xff\xfe\n%s/bad.toml")
"""In a folder whose name is no UTF-8."""
GOOD = ("planar_block", "prismatic_drawer")


@pytest.fixture(scope="module")
def done(tmp_path_factory) -> tuple[Path, Path, tuple]:
    """Designs and their results: two good ones, one that is none; while they
    ran, a worker was killed."""
    folder = tmp_path_factory.mktemp("batch")
    designs, results = folder / "designs", folder / "results"
    for name in GOOD:
        shutil.copytree(FIXTURES / "pairs" / name, designs / name)
    (designs / BAD).parent.mkdir()
    (designs / BAD).write_text('schema = 1\n[assembly]\nname = "bad"\n')
    killer = threading.Thread(target=_kill, args=(lambda desk: desk,), daemon=True)
    killer.start()
    rows = run_batch(discover([designs]), results, Settings(jobs=1))
    return designs, results, rows


def _kill(chosen) -> None:
    """Kill what is `chosen` of the first desk that is seen at work: the death of a worker in the middle."""
    import psutil

    me = psutil.Process()
    for _ in range(1000):
        for child in me.children(recursive=True):
            try:
                if "kinform.batch.desk" in " ".join(child.cmdline()) and child.children():
                    os.kill(chosen(child).pid, signal.SIGKILL)
                    return
            except psutil.Error:
                continue
        time.sleep(0.05)


def test_results_are_the_bytes_of_single_runs_though_a_worker_was_killed(done, tmp_path):
    designs, results, rows = done
    assert max(row.tries for row in rows) == 2
    for name in GOOD:
        kinform.run(designs / name / f"{name}.toml", tmp_path / "one.h5")
        assert (results / name / f"{name}.h5").read_bytes() == (tmp_path / "one.h5").read_bytes()
        (tmp_path / "one.h5").unlink()


@pytest.mark.slow
def test_ctrl_c_keeps_what_is_written_and_is_told_in_one_line(tmp_path):
    """What Dask leaves behind was warned of by the process that clears up after it."""
    for name in ("a", "b", "c", "d"):
        shutil.copytree(FIXTURES / "pairs" / GOOD[0], tmp_path / "designs" / name)
    command = [sys.executable, "-m", "kinform_cli", "batch", "designs", "-o", "results", "--jobs", "1"]
    running = at_work(command, tmp_path, lambda: list((tmp_path / "results").glob("*/*.h5")))
    written = list((tmp_path / "results").glob("*/*.h5"))
    running.send_signal(signal.SIGINT)
    _, errors = running.communicate(timeout=60)
    assert running.returncode == 2
    assert errors.count("\n") == 1 and "interrupted" in errors
    kinform.run(tmp_path / "designs" / "a" / f"{GOOD[0]}.toml", tmp_path / "one.h5")
    assert written[0].read_bytes() == (tmp_path / "one.h5").read_bytes()


@pytest.mark.slow
def test_a_worker_of_dask_that_is_killed_loses_nothing(done, tmp_path):
    designs, results, _ = done
    killer = threading.Thread(target=_kill, args=(lambda desk: desk.parent(),), daemon=True)
    killer.start()
    (row,) = run_batch(discover([designs / GOOD[0]]), tmp_path, Settings(jobs=1))
    assert (row.failure, row.tries) == ("", 2)
    assert (tmp_path / row.results).read_bytes() == (results / GOOD[0] / row.results).read_bytes()


def test_a_catalog_is_filled_and_reads_only_what_is_new(done, monkeypatch):
    designs, _, _ = done
    words = ("batch", *(f"designs/{name}" for name in GOOD), "-o", "results", "--catalog", "all.sqlite")
    ran = ran_here(*words, cwd=designs.parent)
    assert ran.returncode == 0, ran.stderr
    kept = catalog.read(designs.parent / "all.sqlite")
    assert [entry.path for entry in kept.entries] == [f"results/{name}/{name}.h5" for name in GOOD]
    alone, _ = catalog.add(catalog.Catalog(), [designs.parent / "results"], designs.parent)
    assert alone.entries == kept.entries and alone.sources == kept.sources
    digests = {designs.parent / entry.path: entry.digest for entry in kept.entries}
    monkeypatch.setattr("kinform.catalog.build._entry", lambda *_: pytest.fail("read again"))
    assert catalog.fill(kept, digests, designs.parent / "results", designs.parent) == (kept, ())


def test_a_bad_design_stops_no_other(done):
    rows = {row.name: row for row in done[2]}
    assert rows[BAD].failure == "input" and "units" in rows[BAD].problems[0].message
    assert all(not rows[f"{name}/{name}.toml"].failure for name in GOOD)


def test_unchanged_designs_need_no_worker_and_are_not_touched(done, monkeypatch):
    designs, results, _ = done
    before = {path: path.stat().st_mtime_ns for path in results.rglob("*.h5")}
    monkeypatch.setitem(sys.modules, "distributed", None)
    good = discover([designs], exclude=[BAD])
    assert all(row.unchanged for row in run_batch(good, results, Settings()))
    assert {path: path.stat().st_mtime_ns for path in results.rglob("*.h5")} == before


def test_results_of_unknown_origin_are_run_again_and_said_once(done, tmp_path, monkeypatch):
    designs, kept, _ = done
    shutil.copytree(kept, tmp_path / "results")
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    said: list[str] = []
    asked: list[Found] = []
    good = [one for one in discover([designs]) if one.name.startswith(GOOD[0])]
    monkeypatch.setattr(session, "_run", lambda left, *_: asked.extend(left) or [])
    with pytest.raises(KeyError):  # of a design that was not run
        run_batch(good, tmp_path / "results", Settings(), say=said.append)
    assert len(asked) == len(good) == 1 and len(said) == 1
    (row,) = run_batch(good, tmp_path / "results", Settings(trust_results=True), say=said.append)
    assert row.unchanged and not row.recorded and len(said) == 1
    assert "unchanged" not in summary_line([row]).replace("0 unchanged", "")


def test_without_dask_the_extra_is_named(done, monkeypatch):
    designs, results, _ = done
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(kinform.InputError) as caught:
        run_batch(discover([designs]), results, Settings())
    assert "kinform[batch]" in caught.value.problems[0].remedy


def test_the_command_gives_one_table_all_formats_and_the_exit_code(done, tmp_path):
    designs, results, _ = done
    words = ["batch", *(f"designs/{name}" for name in GOOD), "-o", results.name]
    more = [f"--format={name}={tmp_path / name}" for name in ("json", "sarif", "junit", "github", "md", "concise")]
    ran = ran_here(*words, *more, cwd=designs.parent, COLUMNS="200")
    assert ran.returncode == 0, ran.stderr
    assert "2 unchanged" in ran.stderr and all(f"{name}.toml" in ran.stdout for name in GOOD)
    whole = json.loads((tmp_path / "json").read_text())
    assert [one["exit_code"] for one in whole["designs"]] == [0, 0] and whole["totals"]["consistent"] == 2
    suites = ElementTree.parse(tmp_path / "junit").getroot()
    assert [suite.get("name") for suite in suites] == [f"{name}/{name}.toml" for name in GOOD]
    log = json.loads((tmp_path / "sarif").read_text())["runs"]
    assert len(log) == 1 and log[0]["invocations"][0]["executionSuccessful"]


def test_formats_tell_what_has_no_results(done):
    _, results, rows = done
    texts = {name: render(rows, results, name) for name in ("json", "sarif", "junit", "github", "md", "concise")}
    assert all("units" in text for text in texts.values())
    notes = json.loads(texts["sarif"])["runs"][0]["invocations"][0]["toolExecutionNotifications"]
    assert notes[0]["locations"][0]["physicalLocation"]["region"]["startLine"] == 2
    assert ElementTree.fromstring(texts["junit"]).get("errors") == "1"
    assert json.loads(texts["json"])["exit_code"] == 2


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--memory", "much"], "no size"), (["--time", "-1"], "no time"), (["--send"], "--scheduler"),
        (["-f", "xml"], "no format"), (["-f", "md", "-f", "json"], "both go to stdout"),
    ],
)  # fmt: skip
def test_options_that_make_no_sense_are_refused(done, words, said):
    ran = ran_here("batch", "designs", "-o", "new", *words, cwd=done[0].parent)
    assert ran.returncode == 2 and said in ran.stderr


def test_a_design_whose_results_have_no_place_is_a_row(tmp_path):
    text = 'schema = 1\n[assembly]\nname = "a"\nunits = "mm"\n'
    for name in ("batch.json/a.toml", "long.urdf", "r.urdf", "r.urdf.toml", "x" * 250 + ".URDF", "f/a.toml"):
        (tmp_path / "d" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "d" / name).write_text(text if name.endswith("toml") else '<robot name="r"/>')
    out = tmp_path / "results"
    out.mkdir()
    (out / "f").write_text("a file in the place of a folder")
    found = [one for one in discover([tmp_path / "d"]) if one.name not in ("long.urdf", "r.urdf")]
    rows = run_batch(found, out, Settings())
    assert [row.failure for row in rows] == ["input"] * 4
    assert record.read(out).rows.keys() == {row.name for row in rows}


@pytest.mark.slow
def test_a_folder_whose_name_is_no_utf8_ends_nothing(tmp_path):
    for folder in (b"\xff\xfe", b"a\n%s"):
        place = tmp_path / "d" / os.fsdecode(folder)
        place.mkdir(parents=True)
        (place / "a.toml").write_text('schema = 1\n[assembly]\nname = "a"\n')
    ran = ran_here("batch", "d", "-o", "r", "-f", "json=all.json", "-f", "md=all.md", cwd=tmp_path)
    assert ran.returncode == 2, ran.stderr
    designs = json.loads((tmp_path / "all.json").read_text())["designs"]
    assert [(one["design"], one["failure"]) for one in designs] == [
        ("a\n%s/a.toml", "input"), ("\ufffd\ufffd/a.toml", "input"),
    ]  # fmt: skip


def test_what_manifests_set_aside_is_in_the_summary(tmp_path):
    design = 'schema = 1\n[assembly]\nname = "a"\nunits = "mm"\n[[part]]\nname = "a"\n[[part]]\nname = "b"\n'
    design += "[function]\nmobility = 0\n"
    told = {"": "", '[[check.ignore]]\ncode = "KF301"\nreason = "r"': "1 finding ignored"}
    told['[check]\nselect = ["KF1"]'] = "left out"
    for check, words in told.items():
        (tmp_path / "m.toml").write_text(design + check)
        output = tmp_path / "m.h5"
        row = Row("m.toml", "m.toml", "m.h5", **summary(tmp_path / "m.toml", output))
        line = summary_line([row])
        assert words in line and ("[check]" in line) is bool(words)


def summary(source, output):
    """The fields of a row, of a run in this process."""
    fields = work.run(str(source), str(output))
    return {name: value for name, value in fields.items() if name != "seal"}

"""diff, lock and watch as a user runs them, and what a run says of a change."""

from __future__ import annotations

import contextlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys

import pytest
from support.command_line import environment, listening
from support.places import FIXTURES

from kinform_cli.main import main

PAIR = FIXTURES / "pairs" / "revolute_collars"


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """A hinge and its results, which are those of its files also in a copy of the folder."""
    folder = tmp_path_factory.mktemp("built")
    shutil.copytree(PAIR, folder, dirs_exist_ok=True)
    (folder / "revolute_collars.toml").rename(folder / "m.toml")
    with contextlib.chdir(folder):
        assert run("-q") == 0
    return folder


@pytest.fixture
def folder(built, tmp_path, monkeypatch):
    shutil.copytree(built, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(*arguments):
    return main(["run", "m.toml", "-o", "r.h5", *arguments])


def heavier(folder):
    text = (folder / "m.toml").read_text()
    changed = re.sub(r'material = "\w+"', 'material = "brass"', text, count=1)
    if changed == text:
        changed = text.replace('mesh = "shaft.stl"', 'mesh = "shaft.stl"\ndensity = 8500.0', 1)
    assert changed != text
    (folder / "m.toml").write_text(changed)


def test_a_run_says_what_changed_and_what_followed(folder, capsys):
    run("-q")
    capsys.readouterr()
    run("-f", "json")
    first = capsys.readouterr()
    assert json.loads(first.out)["run"]["recomputed"] == []
    data = bytearray((folder / "shaft.stl").read_bytes())
    data[0:4] = b"same"  # another header, the same facets
    (folder / "shaft.stl").write_bytes(bytes(data))
    run("-f", "json")
    assert json.loads(capsys.readouterr().out)["run"]["recomputed"] == []
    heavier(folder)
    run("-f", "json")
    ran = capsys.readouterr()
    assert "m.toml" in ran.err
    account = json.loads(ran.out)["run"]
    assert account["recomputed"][0].startswith("mass")
    assert not any(sentence.startswith(("surfaces", "contacts", "joints")) for sentence in account["recomputed"])


def test_a_run_with_nothing_changed_parses_no_mesh_and_says_the_same(folder, capsys, monkeypatch):
    code = run("-q")
    told = capsys.readouterr().out
    before = (folder / "r.h5").read_bytes()
    os.utime("r.h5", (1e9, 1e9))

    def no(*_, **__):
        raise AssertionError("something was computed or read")

    monkeypatch.setattr("kinform.form.meshes.health.build_mesh", no)
    monkeypatch.setattr("kinform.stages.import_", no)
    monkeypatch.setattr("kinform.results.read", no)
    assert run("-q") == code
    assert capsys.readouterr().out == told
    assert (folder / "r.h5").read_bytes() == before
    assert (folder / "r.h5").stat().st_mtime > 1.6e9


@pytest.mark.parametrize("format", ["json", *(pytest.param(f, marks=pytest.mark.sweep) for f in ("full", "github"))])
def test_the_short_way_of_a_run_with_nothing_changed_says_what_the_long_one_says(folder, capsys, format):
    code = run("-q")
    capsys.readouterr()
    told = []
    for more in ((), ("--jobs", "1")):  # the second is left to the command line proper
        assert run("-f", format, *more) == code
        told.append(capsys.readouterr())
    assert told[0] == told[1]
    assert "[function]" not in told[0].err
    assert run("--fail-on", "nothing") == run("-f") == 2


@pytest.mark.parametrize(
    "spoil", ["mesh", *(pytest.param(s, marks=pytest.mark.sweep) for s in ("manifest", "nothing there"))]
)
def test_the_short_way_refuses_bad_input_as_the_long_one_does(folder, capsys, spoil):
    run("-q")
    before = (folder / "r.h5").read_bytes()
    if spoil == "mesh":
        (folder / "shaft.stl").write_bytes(b"solid nonsense")
    elif spoil == "manifest":
        (folder / "m.toml").write_text((folder / "m.toml").read_text() + "\n[[part]]\n")
    else:
        (folder / "shaft.stl").unlink()
    capsys.readouterr()
    told = []
    for more in ((), ("--jobs", "1")):  # the second is left to the command line proper
        assert run(*more) == 2
        told.append(capsys.readouterr())
    assert told[0] == told[1]
    assert "error: " in told[0].err
    assert (folder / "r.h5").read_bytes() == before


def test_what_the_function_asks_for_first_gives_the_bytes_of_a_run_from_nothing(folder, capsys):
    plain = (folder / "m.toml").read_text()
    asked = plain + '\n[[function.require]]\nname = "held"\nkind = "retained"\npart = "shaft"\n'
    for text in (asked, plain):
        (folder / "m.toml").write_text(text)
        run("-q")
        (folder / "fresh.h5").unlink(missing_ok=True)
        main(["run", "m.toml", "-o", "fresh.h5", "-q"])
        assert (folder / "r.h5").read_bytes() == (folder / "fresh.h5").read_bytes()


def test_a_mesh_that_moved_outside_is_refused_again(folder, tmp_path_factory, capsys):
    run("-q")
    elsewhere = tmp_path_factory.mktemp("elsewhere") / "shaft.stl"
    (folder / "shaft.stl").rename(elsewhere)
    (folder / "shaft.stl").symlink_to(elsewhere)
    capsys.readouterr()
    assert run("-q") == 2
    assert "outside" in capsys.readouterr().err


def test_diff_of_a_heavier_part_and_of_nothing(folder, capsys):
    run("-q")
    shutil.copy("r.h5", "before.h5")
    assert main(["diff", "before.h5", "r.h5"]) == 0
    heavier(folder)
    run("-q")
    capsys.readouterr()
    assert main(["diff", "before.h5", "r.h5"]) == 1
    assert re.search(r"shaft|block", capsys.readouterr().out)
    assert main(["diff", "before.h5", "r.h5", "-f", "json"]) == 1
    kinds = {change["kind"] for change in json.loads(capsys.readouterr().out)["changes"]}
    assert "mass" in kinds
    assert main(["diff", "before.h5", "r.h5", "-f", "md"]) == 1
    assert "| mass" in capsys.readouterr().out
    assert main(["diff", "before.h5", "absent.h5"]) == 2
    assert main(["diff", "before.h5", "r.h5", "--tolerance", "1 parsec"]) == 2


def test_diff_with_less_on_one_side_is_not_verified(folder, capsys):
    run("-q")
    main(["import", "m.toml", "-o", "a.h5", "-q"])
    assert main(["diff", "a.h5", "r.h5"]) == 2
    assert main(["diff", "a.h5", "a.h5"]) == 2


def test_a_lock_holds_until_the_behaviour_changes(folder, capsys):
    green = run("-q")
    assert main(["lock", "r.h5", "-o", "b.json", "-q"]) == 0
    assert main(["check", "r.h5", "--lock", "b.json", "-q"]) == green
    heavier(folder)
    run("-q")
    capsys.readouterr()
    assert main(["check", "r.h5", "--lock", "b.json", "-q", "-f", "concise"]) == 1
    line = next(
        n for n, text in enumerate((folder / "b.json").read_text().splitlines(), 1) if '"name": "block"' in text
    )
    assert f"b.json:{line}: error KF450 block: mass" in capsys.readouterr().out
    assert main(["check", "r.h5", "--lock", "b.json", "-f", "github", "--manifest-folder", "deeper/down"]) == 1
    assert f"::error file=b.json,line={line},title=KF450" in capsys.readouterr().out
    assert main(["check", "r.h5", "--lock", "absent.json"]) == 2
    assert main(["check", "r.h5", "--lock", "m.toml"]) == 2
    assert main(["import", "m.toml", "-o", "a.h5", "-q"]) == 0
    assert main(["lock", "a.h5", "-o", "c.json"]) == 2
    assert not (folder / "c.json").exists()


def started(*arguments):
    command = [sys.executable, "-m", "kinform_cli", "watch", "m.toml", "-o", "r.h5", "--period", "0.05", *arguments]
    return subprocess.Popen(
        command, env=environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=listening
    )


def said(watching, word):
    """Lines on stderr up to the one with that word."""
    lines = []
    for line in watching.stderr:
        lines.append(line)
        if word in line:
            return lines
    raise AssertionError(f"ended without {word!r}: {lines}")


def test_watch_runs_again_on_a_save_survives_bad_input_and_ends_cleanly(folder):
    watching = started()
    try:
        said(watching, "watching 3 files")
        good = (folder / "m.toml").read_text()
        (folder / "m.toml").write_text("schema = ")
        assert any("error:" in line for line in said(watching, "watching 3 files"))
        (folder / "m.toml").write_text(good)
        heavier(folder)
        assert any("m.toml" in line and "mass" in line for line in said(watching, "watching 3 files"))
        watching.send_signal(signal.SIGINT)
        out, errors = watching.communicate(timeout=60)
        assert watching.returncode in (0, 1, 2)
        assert watching.returncode != -signal.SIGINT
        assert "Traceback" not in errors
        assert len(re.findall(r"\d+ rules", out)) == 2
    finally:
        watching.kill()
        watching.communicate()


@pytest.mark.slow
def test_watch_sees_a_file_that_was_missing_appear(folder):
    text = (folder / "m.toml").read_text()
    (folder / "m.toml").write_text(text + '[[part]]\nname = "lid"\nmesh = "lid.stl"\n')
    watching = started()
    try:
        assert any("lid.stl" in line and "error:" in line for line in said(watching, "watching"))
        shutil.copy(folder / "shaft.stl", folder / "lid.stl")
        lines = said(watching, "watching")
        assert not any("error:" in line for line in lines)
        watching.send_signal(signal.SIGINT)
        watching.communicate(timeout=60)
    finally:
        watching.kill()
        watching.communicate()


def test_watch_leaves_after_so_many_runs_with_the_code_of_the_last(folder, capsys):
    assert main(["watch", "m.toml", "-o", "r.h5", "--max-runs", "1", "-q"]) == run("-q")
    (folder / "m.toml").write_text("schema = ")
    assert main(["watch", "m.toml", "-o", "r.h5", "--max-runs", "1", "-q"]) == 2

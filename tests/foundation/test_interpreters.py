"""Interpreters and programs that are started, in a working folder that holds others of the same names."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from kinform.foundation import interpreters


def planted(folder: Path, *names: str) -> Path:
    """Modules in a folder that leave a marker there when they are imported."""
    for name in names:
        (folder / f"{name}.py").write_text(f"open({str(folder / 'MARKER')!r}, 'a').write(__name__)\n")
    return folder / "MARKER"


@pytest.mark.parametrize("start", [["-c", "import tomllib, subprocess"], ["-m", "json.tool", "--help"]])
def test_no_module_comes_from_the_working_folder(start: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    marker = planted(tmp_path, "tomllib", "subprocess", "json", "argparse", "sitecustomize", "usercustomize")
    monkeypatch.setattr(sys, "path", ["", ".", *sys.path])
    monkeypatch.chdir(tmp_path)
    subprocess.run(interpreters.command(*start), env=interpreters.environment(), check=True, capture_output=True)
    assert not marker.exists()
    with interpreters.safe_children():
        subprocess.run([sys.executable, *start], check=True, capture_output=True)
    assert not marker.exists()


def test_programs_of_the_user_have_their_environment(monkeypatch: pytest.MonkeyPatch):
    before = dict(os.environ)
    with interpreters.safe_children():
        assert os.environ["PYTHONSAFEPATH"] and "PYTHONSAFEPATH" not in interpreters.of_user()
    assert dict(os.environ) == before
    monkeypatch.setenv("PYTHONSAFEPATH", "1")
    with interpreters.safe_children():
        assert interpreters.of_user()["PYTHONSAFEPATH"] == "1"


@pytest.mark.parametrize("name", ["DASK_CONFIG", "PYTHONPYCACHEPREFIX"])
def test_places_of_code_that_are_relative_are_not_passed_on(name: str, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv(name, "here")
    assert name not in interpreters.environment()
    with interpreters.safe_children():
        assert name not in os.environ
    assert os.environ[name] == "here"
    monkeypatch.setenv(name, os.path.abspath("here"))
    assert interpreters.environment()[name] == os.path.abspath("here")


@pytest.mark.skipif(os.name != "posix", reason="scripts are programs on POSIX only")
def test_no_program_comes_from_the_working_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    for folder in ("here", "there"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "git").write_text("#!/bin/sh\n")
        (tmp_path / folder / "git").chmod(0o755)
    monkeypatch.chdir(tmp_path / "here")
    monkeypatch.setenv("PATH", f":.:../here:{tmp_path / 'there'}")
    assert interpreters.program("git") == str(tmp_path / "there" / "git")
    monkeypatch.setenv("PATH", ":.:")
    assert interpreters.program("git") is None


@pytest.mark.skipif(os.name != "posix", reason="the home is HOME on POSIX only")
def test_a_home_in_the_working_folder_configures_no_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    for home in (str(tmp_path), "."):
        monkeypatch.setenv("HOME", home)
        with interpreters.safe_children():
            assert not Path(os.environ["HOME"]).resolve().is_relative_to(tmp_path)
            assert interpreters.of_user()["HOME"] == home
            with interpreters.safe_children():
                assert interpreters.of_user()["HOME"] == home
        assert os.environ["HOME"] == home and "KINFORM_HOME" not in os.environ
    other = tmp_path.with_name("other home")
    monkeypatch.setenv("HOME", str(other))
    with interpreters.safe_children():
        assert os.environ["HOME"] == str(other)

"""The command started in a folder that holds modules by the names of Python's own."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from support.command_line import environment
from support.planted import planted

START = [sys.executable, "-m", "kinform_cli", "--version"]


@pytest.mark.parametrize("path", [None, "", ".", "inner/.."])
def test_python_m_finds_no_module_in_the_working_folder(path: str | None, tmp_path: Path):
    marker = planted(tmp_path, at_start=path is None)
    given = environment()
    if path is not None:
        given["PYTHONPATH"] = os.pathsep.join([given.get("PYTHONPATH", ""), path])
    done = subprocess.run(START, cwd=tmp_path, env=given, capture_output=True, text=True)
    assert (done.returncode, marker.exists()) == (0, False), done.stderr


def test_absolute_entries_of_the_path_stay(tmp_path: Path):
    code = "import sys; from kinform_cli import working_folder; working_folder.forget(); print({0!r} in sys.path)"
    given = environment(PYTHONPATH=os.pathsep.join([*filter(None, [os.environ.get("PYTHONPATH")]), str(tmp_path)]))
    done = subprocess.run(
        [sys.executable, "-c", code.format(str(tmp_path))], cwd=tmp_path, env=given, capture_output=True, text=True
    )
    assert done.stdout == "True\n", done.stderr

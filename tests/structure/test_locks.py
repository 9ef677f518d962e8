"""What `make test` installs is locked: a dependency that the lock lacks is missing on a machine that had none of it."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def name(requirement):
    """As in "python-fcl" of "python_fcl>=0.7; extra"."""
    return re.split(r"[^\w.-]", requirement.strip(), maxsplit=1)[0].lower().replace("_", "-").replace(".", "-")


def locked(path):
    lines = (ROOT / path).read_text().splitlines()
    return {name(line) for line in lines if re.match(r"\w", line)}


def test_every_dependency_is_in_the_lock():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    wanted = {name(one) for one in [*project["dependencies"], *project["optional-dependencies"]["dev"]]}
    assert wanted <= locked("requirements-dev.lock")


def test_every_program_that_judges_is_in_the_lock():
    lines = (ROOT / "validators" / "requirements.in").read_text().splitlines()
    wanted = {name(line) for line in lines if line and not line.startswith("#")}
    assert wanted <= locked("validators/requirements.lock")


def test_a_lock_that_lacks_one_is_told(tmp_path, monkeypatch):
    monkeypatch.setattr(f"{__name__}.ROOT", tmp_path)
    (tmp_path / "short.lock").write_text("numpy==2\n    # via scipy\nPython_FCL==0.7\n")
    assert locked("short.lock") == {"numpy", "python-fcl"}

"""Runs that tests share."""

from __future__ import annotations

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session", autouse=True)
def bytecode_kept(tmp_path_factory):
    """Where Python is to leave no bytecode beside the source, hundreds of processes would each compile all of kinform
    again: for the length of the session they share a folder for it."""
    with pytest.MonkeyPatch.context() as patch:
        if os.environ.get("PYTHONDONTWRITEBYTECODE"):
            patch.delenv("PYTHONDONTWRITEBYTECODE")
            patch.setenv("PYTHONPYCACHEPREFIX", str(together(tmp_path_factory) / "bytecode"))
        yield


def together(tmp_path_factory) -> Path:
    """A folder of this session that all its workers have in common."""
    folder = tmp_path_factory.getbasetemp()
    return folder.parent if "PYTEST_XDIST_WORKER" in os.environ else folder


@pytest.fixture(scope="session")
def derive_design():
    """A manifest to a design with findings, each computed once a session."""
    from kinform import stages

    known = {}

    def derive(manifest: Path):
        if manifest not in known:
            design = stages.joints(stages.contacts(stages.import_(manifest)))
            known[manifest] = stages.check(stages.simulate(stages.mass(design)))
        return known[manifest]

    return derive

"""Runs that tests share, and the command as a user runs it."""

from __future__ import annotations

import atexit
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

if os.environ.pop("PYTHONDONTWRITEBYTECODE", ""):
    # no bytecode beside the source; but each worker and hundreds of processes would compile all of kinform again, and
    # each worker all tests. So all share a folder, which later sessions find again.
    sys.dont_write_bytecode = False
    sys.pycache_prefix = str(Path(__file__).parents[1] / ".pytest_cache" / "bytecode")
    os.environ["PYTHONPYCACHEPREFIX"] = sys.pycache_prefix
# before numpy is imported: the threads of BLAS wait for each other in loops, on processors that other workers need
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
if "PYTEST_XDIST_WORKER" not in os.environ:  # workers share the folder of the process that starts them
    os.environ["XDG_STATE_HOME"] = tempfile.mkdtemp(prefix="kinform-state-")
    atexit.register(shutil.rmtree, os.environ["XDG_STATE_HOME"], ignore_errors=True)

import pytest
from hypothesis import HealthCheck, settings
from support.once import common, once
from support.places import FIXTURES

# no test fails because a machine is busy: neither examples nor what draws them have a time to keep
settings.register_profile("any machine", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("any machine")


@pytest.fixture(scope="session")
def derive_design(tmp_path_factory):
    """A manifest to a design with findings, each computed once a session."""
    from kinform import stages

    known = {}

    def made(manifest: Path):
        design = stages.joints(stages.contacts(stages.import_(manifest)))
        return stages.check(stages.simulate(stages.mass(design)))

    def derive(manifest: Path):
        if manifest not in known:
            shared = manifest.is_relative_to(FIXTURES)
            known[manifest] = (
                once(common(tmp_path_factory), str(manifest), lambda: made(manifest)) if shared else made(manifest)
            )
        return known[manifest]

    return derive


@pytest.fixture(scope="module")
def small_pictures():
    """Pages have pictures of a tenth of their width, where a test looks at none: to draw them is nearly all of the time
    that a page takes."""
    from kinform.reports.page import pictures

    with pytest.MonkeyPatch.context() as patch:
        for name in ("OVERVIEW_WIDTH", "OVERVIEW_HEIGHT", "PICTURE_WIDTH", "PICTURE_HEIGHT"):
            patch.setattr(pictures, name, getattr(pictures, name) // 10)
        size = pictures.OVERVIEW_WIDTH, pictures.OVERVIEW_HEIGHT
        patch.setattr(pictures.Artist.overview, "__defaults__", size)
        yield


@pytest.fixture
def kinform(tmp_path: Path) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Run `kinform ARGUMENTS` in tmp_path, in a process of its own; stdout and stderr are pipes."""
    from support.command_line import environment

    def run(*arguments: object, cwd: Path = tmp_path, **extra: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "kinform_cli", *map(str, arguments)],
            cwd=cwd,
            env=environment(**extra),
            capture_output=True,
            text=True,
            timeout=120,
        )

    return run


@pytest.fixture
def command(tmp_path: Path) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Run `kinform ARGUMENTS` in tmp_path, in this process: where nothing is asked of the process itself."""
    from support.command_line import ran_here

    def run(*arguments: object, cwd: Path = tmp_path, **extra: str) -> subprocess.CompletedProcess[str]:
        return ran_here(*arguments, cwd=cwd, **extra)

    return run

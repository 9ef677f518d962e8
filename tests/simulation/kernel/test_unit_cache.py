"""Compiled units in the user's cache: taken over where this user wrote them whole, else compiled again."""

from __future__ import annotations

import hashlib
import os
import pickle
import subprocess
import sys
from pathlib import Path

import pytest
from support.planted import Marker

from kinform.simulation.kernel.load_numba import load_numba
from kinform.simulation.kernel.unit_cache import UnitCache, has


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where units are kept."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "kinform" / "kernel"


def compiled() -> tuple[int, float]:
    """Whether the unit came from the cache, and what it gives of 3."""
    numba = load_numba()
    from numba.core.ccallback import CFunc

    def twice(x):
        return 2.0 * x

    unit = CFunc(twice, (((numba.types.float64,)), numba.types.float64), locals={}, options={"nopython": True})
    unit._cache = UnitCache("twice")
    unit.compile()
    return unit._cache_hits, unit.ctypes(3.0)


def test_a_unit_is_compiled_once(place: Path):
    assert not has("twice")
    assert compiled() == (0, 6.0)
    assert has("twice") and not has("twic")
    assert compiled() == (1, 6.0)
    assert len(list(place.iterdir())) == 1


def sealed(content: bytes) -> bytes:
    return hashlib.sha256(content).digest() + content


@pytest.mark.parametrize("content", [b"", b"no pickle", sealed(b"no pickle"), sealed(pickle.dumps((1, 2)))])
def test_a_damaged_unit_is_compiled_again_and_replaced(content: bytes, place: Path):
    compiled()
    (file,) = place.iterdir()
    file.write_bytes(content)
    assert compiled() == (0, 6.0)
    assert compiled() == (1, 6.0)


@pytest.mark.skipif(os.name != "posix", reason="users and rights are those of POSIX")
def test_a_unit_that_others_could_have_written_is_not_unpickled(place: Path, tmp_path: Path):
    compiled()
    (file,) = place.iterdir()
    planted = sealed(pickle.dumps(Marker(tmp_path / "MARKER")))
    file.write_bytes(planted)
    for spoiled, rights, before in ((place, 0o755, 0o700), (place.parent, 0o770, 0o700), (file, 0o666, 0o600)):
        spoiled.chmod(rights)
        assert compiled() == (0, 6.0)
        spoiled.chmod(before)
        assert not (tmp_path / "MARKER").exists()
    file.write_bytes(planted)
    assert compiled() == (0, 6.0) and (tmp_path / "MARKER").exists()  # the oracle: what is this user's own is unpickled


def test_a_cache_that_cannot_be_made_is_done_without(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert compiled() == (0, 6.0) and not has("twice")


def test_numba_takes_no_settings_from_the_working_folder(tmp_path: Path):
    (tmp_path / ".numba_config.yaml").write_text("cache_dir: cache\nopt: 0\ncache_locator_classes: planted.Locator\n")
    code = (
        "import warnings; warnings.simplefilter('error')\n"
        "from kinform.simulation.kernel.load_numba import load_numba\n"
        "numba = load_numba()\n"
        "numba.core.config.reload_config()\n"
        "print(repr(numba.config.CACHE_DIR), repr(numba.config.CACHE_LOCATOR_CLASSES))\n"
        "import sys, yaml\n"
    )
    ran = subprocess.run([sys.executable, "-P", "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (ran.returncode, ran.stdout) == (0, "'' ''\n"), ran.stderr

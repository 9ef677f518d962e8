"""A disk that is full: every command that writes fails with exit code 2, and nothing that was there is lost."""

from __future__ import annotations

import contextlib
import errno
import gc
import os
import shutil
import subprocess
from pathlib import Path

import pytest
from support.places import FIXTURES

from kinform_cli.main import main

PAIR = FIXTURES / "pairs" / "revolute_collars"
WRITING = (
    ("run", "m.toml", "-o", "r.h5", "--depfile", "r.d"),
    ("import", "m.toml", "-o", "new.h5"),
    ("mass", "r.h5", "-o", "r.h5"),
    ("lock", "r.h5", "-o", "l.json", "--tolerance", "1mm"),
    ("check", "r.h5", "--write-baseline", "new.json"),
    ("report", "r.h5", "-o", "new.html"),
    ("export", "r.h5", "--to", "glb", "-o", "new"),
)


@pytest.fixture
def small_disk(tmp_path, monkeypatch):
    """A file system of its own, which the design fits into once."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = shutil.which("mount")
    if (
        mount is None
        or subprocess.run(
            [mount, "-t", "tmpfs", "-o", "size=1m", "none", str(folder)], capture_output=True, check=False
        ).returncode
    ):
        pytest.skip("needs the right to mount a file system")
    monkeypatch.chdir(folder)
    try:
        yield folder
    finally:
        monkeypatch.chdir(tmp_path)
        gc.collect()  # a design that is read as it is looked at keeps its file open as long as it is there
        subprocess.run(["umount", str(folder)], check=True)


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.is_file() and path.name != "fill"}


@pytest.mark.slow
def test_a_full_disk_loses_nothing_and_what_is_missing_comes_when_there_is_room(small_disk, capsys):
    for path in PAIR.glob("*.stl"):
        shutil.copy(path, small_disk / path.name)
    manifest = small_disk / "m.toml"
    shutil.copy(PAIR / "revolute_collars.toml", manifest)
    assert main(["run", "m.toml", "-o", "r.h5", "-q"]) == 0
    assert main(["lock", "r.h5", "-o", "l.json", "-q"]) == 0
    manifest.write_text(manifest.read_text().replace('"steel"', '"brass"'))
    with (small_disk / "fill").open("wb", buffering=0) as fill, contextlib.suppress(OSError):
        while fill.write(bytes(4096)):
            pass
    os.sync()
    before = contents(small_disk)
    for arguments in WRITING:
        capsys.readouterr()
        assert main([*arguments, "-q"]) == 2, arguments
        assert os.strerror(errno.ENOSPC) in capsys.readouterr().err, arguments
        assert contents(small_disk) == before, arguments
    (small_disk / "fill").unlink()
    assert main(["run", "m.toml", "-o", "r.h5", "-q"]) == 0
    assert main(["run", "m.toml", "-o", "fresh.h5", "-q"]) == 0
    assert (small_disk / "r.h5").read_bytes() == (small_disk / "fresh.h5").read_bytes()

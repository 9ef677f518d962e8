"""What never ends, or waits for somebody, in the place of a file: refused by name, and nothing is opened."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.command_line import environment, ran_here
from support.places import FIXTURES

from kinform import catalog, results

PAIR = FIXTURES / "pairs" / "revolute_collars"
NAME = "revolute_collars.toml"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, derive_design) -> Path:
    """The hinge with its results, a catalog of it, and pipes with the names of everything that is read."""
    tmp_path = tmp_path_factory.mktemp("pipes")
    if not hasattr(os, "mkfifo"):
        pytest.skip("this system has no pipes with names")
    shutil.copytree(PAIR, tmp_path, dirs_exist_ok=True)
    results.write(derive_design(PAIR / NAME), tmp_path / "r.h5")
    for suffix in ("toml", "stl", "obj", "h5", "json", "sqlite", "urdf", "d", "html"):
        os.mkfifo(tmp_path / f"pipe.{suffix}")
    text = (tmp_path / NAME).read_text()
    (tmp_path / "mesh.toml").write_text(text.replace("shaft.stl", "pipe.stl"))
    (tmp_path / "sub.toml").write_text(
        'schema = 1\n[assembly]\nname = "x"\nunits = "mm"\n[[subassembly]]\nname = "s"\nfile = "pipe.toml"\n'
    )
    (tmp_path / "from.toml").write_text('schema = 1\n[assembly]\nname = "x"\nunits = "mm"\nfrom = "pipe.urdf"\n')
    if Path("/dev/zero").exists():
        (tmp_path / "endless.toml").symlink_to("/dev/zero")
        (tmp_path / "endless.h5").symlink_to("/dev/zero")
        (tmp_path / "endless.stl").symlink_to("/dev/zero")
    return tmp_path


WAITING = {
    "manifest": (("run", "pipe.toml"), "pipe.toml"),
    "manifest to watch": (("watch", "pipe.toml", "-o", "n.h5"), "pipe.toml"),
    "robot description to watch": (("watch", "pipe.urdf", "-o", "n.h5"), "pipe.urdf"),
    "device to watch": (("watch", "endless.toml", "-o", "n.h5"), "endless.toml"),
    "sub-assembly": (("import", "sub.toml", "-o", "n.h5"), "pipe.toml"),
    "robot description": (("run", "pipe.urdf"), "pipe.urdf"),
    "description of a manifest": (("run", "from.toml"), "pipe.urdf"),
    "mesh of a manifest": (("run", "mesh.toml"), "pipe.stl"),
    "mesh": (("run", "pipe.stl", "shaft.stl", "--units", "mm"), "pipe.stl"),
    "mesh to begin with": (("init", "pipe.obj", "--units", "mm"), "pipe.obj"),
    "results": (("show", "pipe.h5"), "pipe.h5"),
    "results to check": (("check", "pipe.h5"), "pipe.h5"),
    "results to compare": (("diff", "r.h5", "pipe.h5"), "pipe.h5"),
    "results of a stage": (("mass", "pipe.h5", "-o", "n.h5"), "pipe.h5"),
    "results to write": (("run", NAME, "-o", "pipe.h5"), "pipe.h5"),
    "baseline": (("check", "r.h5", "--baseline", "pipe.json"), "pipe.json"),
    "lock": (("check", "r.h5", "--lock", "pipe.json"), "pipe.json"),
    "lock to write": (("lock", "r.h5", "-o", "pipe.json"), "pipe.json"),
    "page to write": (("report", "r.h5", "-o", "pipe.html"), "pipe.html"),
    "rule to write": (("run", NAME, "-o", "n.h5", "--depfile", "pipe.d"), "pipe.d"),
    "catalog": (("catalog", "find", "-c", "pipe.sqlite"), "pipe.sqlite"),
    "catalog to add to": (("catalog", "add", "r.h5", "-c", "pipe.sqlite"), "pipe.sqlite"),
    "results for a catalog": (("catalog", "add", "pipe.h5", "-c", "c.sqlite"), "pipe.h5"),
    "device for a manifest": (("run", "endless.toml"), "endless.toml"),
    "device for results": (("show", "endless.h5"), "endless.h5"),
    "device for a mesh": (("run", "endless.stl", "shaft.stl", "--units", "mm"), "endless.stl"),
}


@pytest.mark.parametrize("what", WAITING)
def test_a_pipe_or_a_device_is_refused_by_name(what: str, folder: Path) -> None:
    words, name = WAITING[what]
    if "endless" in name and not (folder / name).exists():
        pytest.skip("needs /dev/zero")
    before = sorted(folder.iterdir())
    ran = ran_here(*words, cwd=folder)
    assert (ran.returncode, ran.stdout) == (2, "")
    assert name in ran.stderr
    if name.endswith((".toml", ".urdf", ".stl", ".obj")):
        assert "remedy: " in ran.stderr
    assert sorted(folder.iterdir()) == before


def test_a_pipe_among_the_designs_of_a_folder_is_no_design(folder: Path) -> None:
    ran = ran_here("catalog", "add", ".", cwd=folder)
    assert ran.returncode == 0
    assert len(catalog.read(folder / "catalog.sqlite").entries) == 1


def test_a_mesh_that_became_a_pipe_after_a_run_is_not_waited_for(tmp_path: Path) -> None:
    folder = shutil.copytree(PAIR, tmp_path / "pair")
    assert ran_here("run", NAME, "-o", "n.h5", "-q", cwd=folder).returncode == 0
    (folder / "shaft.stl").unlink()
    os.mkfifo(folder / "shaft.stl")
    ran = ran_here("run", NAME, "-o", "n.h5", cwd=folder)
    assert ran.returncode == 2
    assert "shaft.stl" in ran.stderr
    assert "pipe" in ran.stderr


def test_a_manifest_that_another_program_writes_into_a_pipe_is_refused_and_that_program_ends(folder: Path) -> None:
    """As bash's `kinform run <(generate)`."""
    reading, writing = os.pipe()
    ran = subprocess.run(
        [sys.executable, "-m", "kinform_cli", "run", f"/dev/fd/{reading}"],
        cwd=folder, env=environment(), capture_output=True, text=True, timeout=60, pass_fds=[reading],
    )  # fmt: skip
    os.close(reading)
    os.close(writing)
    assert ran.returncode == 2
    assert "pipe" in ran.stderr

"""Bad input: a message with file, line and remedy, exit 2, and nothing overwritten."""

from __future__ import annotations

import shutil
import signal
import struct
import subprocess
import sys

import pytest
from support.command_line import at_work, environment, listening
from support.places import FIXTURES

from kinform.results.seal import seal

PAIR = FIXTURES / "pairs" / "revolute_collars"
NAME = "revolute_collars.toml"


@pytest.fixture
def folder(tmp_path):
    """The hinge, and results of it that must survive."""
    shutil.copytree(PAIR, tmp_path, dirs_exist_ok=True)
    return tmp_path


def edited(folder, old, new):
    text = (folder / NAME).read_text()
    assert old in text
    (folder / "edited.toml").write_text(text.replace(old, new, 1))
    return "edited.toml"


def line_of(folder, manifest, word):
    return next(k for k, line in enumerate((folder / manifest).read_text().splitlines(), 1) if word in line)


def broken_mesh(folder, name, data):
    (folder / name).write_bytes(data)
    return edited(folder, "shaft.stl", name)


def refused(ran, *told):
    assert ran.returncode == 2
    assert ran.stdout == ""
    assert "remedy:" in ran.stderr
    assert "Traceback" not in ran.stderr
    for text in told:
        assert text in ran.stderr


def patched(folder, start, data):
    whole = bytearray((folder / "shaft.stl").read_bytes())
    whole[start : start + len(data)] = data
    return bytes(whole)


MESHES = {
    "truncated": (lambda f: (f / "shaft.stl").read_bytes()[:300], ""),
    "a billion facets": (lambda f: patched(f, 80, struct.pack("<I", 10**9)), "1000000000"),
    "not a number": (lambda f: patched(f, 96, struct.pack("<f", float("nan"))), "facet 1"),
    "empty": (lambda f: b"", ""),
}


@pytest.mark.parametrize("case", MESHES)
def test_a_broken_mesh_is_named_with_the_line_that_states_it(folder, command, case):
    make, word = MESHES[case]
    manifest = broken_mesh(folder, "broken.stl", make(folder))
    line = line_of(folder, manifest, "broken.stl")
    refused(command("run", manifest, "-o", "r.h5"), f"{manifest}:{line}", "broken.stl", word)
    assert not (folder / "r.h5").exists()


def test_an_index_out_of_range_is_named_with_the_line_of_the_obj(folder, command):
    manifest = broken_mesh(folder, "bad.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")
    refused(command("run", manifest, "-o", "r.h5"), "bad.obj:4")


def test_a_part_without_thickness(folder, command):
    manifest = broken_mesh(folder, "flat.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n")
    refused(command("run", manifest, "-o", "r.h5"), "solid = false")


def test_a_missing_mesh_and_a_near_name(folder, command):
    manifest = edited(folder, "shaft.stl", "shaf.stl")
    line = line_of(folder, manifest, "shaf.stl")
    refused(command("run", manifest, "-o", "r.h5"), f"{manifest}:{line}", '"shaft.stl"')


def test_all_errors_of_a_manifest_come_at_once_with_their_lines(folder, command):
    (folder / "m.toml").write_text(
        'schema = 1\n[assembly]\nname = "x"\n[[part]]\nname = "a"\nshade = 1\n[[part]]\nname = "a"\nmesh = "no.stl"\n'
    )
    refused(command("run", "m.toml", "-o", "r.h5"), "m.toml:2", "units", "m.toml:6", "shade", "m.toml:8", "m.toml:9")


def test_a_cycle_of_sub_assemblies(folder, command):
    for name, other in (("one", "two"), ("two", "one")):
        (folder / f"{name}.toml").write_text(
            f'schema = 1\n[assembly]\nname = "{name}"\nunits = "mm"\n'
            f'[[part]]\nname = "p"\n[[subassembly]]\nname = "s"\nfile = "{other}.toml"\n'
        )
    refused(command("run", "one.toml", "-o", "r.h5"), "two.toml:9", "one.toml → two.toml → one.toml")


def test_a_mesh_outside_the_folder_needs_permission(folder, command):
    inner = folder / "inner"
    inner.mkdir()
    shutil.copy(folder / NAME, inner / "m.toml")
    text = (inner / "m.toml").read_text().replace('"shaft.stl"', '"../shaft.stl"').replace("block.stl", "../block.stl")
    (inner / "m.toml").write_text(text)
    refused(command("import", "inner/m.toml", "-o", "r.h5"), "--allow-outside")
    assert command("import", "inner/m.toml", "-o", "r.h5", "--allow-outside").returncode == 0


def test_what_is_no_results_file_is_neither_read_nor_overwritten(folder, command):
    (folder / "text.h5").write_text("precious")
    refused(command("show", "text.h5"), "text.h5")
    refused(command("run", NAME, "-o", "text.h5"))
    assert (folder / "text.h5").read_text() == "precious"
    (folder / "newer.h5").write_bytes(seal(b"of another form", "kinform/results/9"))
    refused(command("show", "newer.h5"), "kinform/results/9", "kinform/results/3")


def test_a_place_where_nothing_can_be_written(folder, command):
    refused(command("run", NAME, "-o", "nowhere/r.h5"), "nowhere", "mkdir")
    refused(command("run", NAME, "-o", "block.stl/r.h5"), "block.stl")


def test_meshes_need_a_unit(folder, command):
    refused(command("run", "shaft.stl", "block.stl"), "--units")
    assert command("import", "shaft.stl", "block.stl", "--units", "mm", "-o", "r.h5").returncode == 0


INTERRUPTED = """
import sys
from pathlib import Path
from kinform import stages
from kinform_cli.main import entry
found = stages.contacts
def contacts(*given, **named):
    Path("begun").touch()
    return found(*given, **named)
stages.contacts = contacts
entry()
"""


DROPPED = """
import os, signal, weakref
from kinform import stages
from kinform_cli.main import entry
found = stages.contacts
class Thing:
    pass
def contacts(*given, **named):
    thing = Thing()
    held = weakref.ref(thing, lambda _: os.kill(os.getpid(), signal.SIGINT))
    del thing
    open("dropped", "w").close()
    return found(*given, **named)
stages.contacts = contacts
entry()
"""


def test_an_interruption_that_python_drops_in_a_callback_is_heard_at_the_next_step(folder):
    done = subprocess.run(
        [sys.executable, "-c", DROPPED, "run", NAME, "-o", "r.h5", "--jobs", "1"],
        cwd=folder, env=environment(), capture_output=True, text=True, preexec_fn=listening, timeout=60,
    )  # fmt: skip
    assert (folder / "dropped").exists()
    assert "Exception ignored" not in done.stderr
    assert "Traceback" not in done.stderr
    assert done.returncode == 2
    assert not (folder / "r.h5").exists()


def test_an_interrupted_run_leaves_the_old_results_as_they_were(folder, command):
    assert command("import", NAME, "-o", "r.h5").returncode == 0
    old = (folder / "r.h5").read_bytes()
    platform = FIXTURES / "mechanisms" / "stewart_platform" / "stewart_platform.toml"
    command = [sys.executable, "-c", INTERRUPTED, "run", str(platform), "-o", "r.h5", "--jobs", "1"]
    running = at_work(command, folder, (folder / "begun").exists)
    running.send_signal(signal.SIGINT)
    out, error = running.communicate(timeout=60)
    assert running.returncode == 2
    assert out == ""
    assert "Traceback" not in error
    assert (folder / "r.h5").read_bytes() == old
    assert not [p for p in folder.iterdir() if p.suffix == ".tmp"]

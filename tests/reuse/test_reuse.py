"""`run` computes what a change affects and nothing else, and the file is the same as one made from nothing."""

from __future__ import annotations

import dataclasses
import functools
import os
import re
import shutil
import struct
import subprocess
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import pytest
from support.short_four_bar import four_bar, run

import kinform
from kinform import results, stages
from kinform.design import Design
from kinform.model.fingerprints import Fingerprints

STAGES = ("surfaces", "contacts", "joints", "mass", "simulation", "findings")


def _replaced(old: str, new: str) -> Callable[[Path], None]:
    """An edit of the manifest."""

    def edit(folder: Path) -> None:
        manifest = folder / "four_bar.toml"
        text = manifest.read_text()
        assert old in text
        manifest.write_text(text.replace(old, new, 1))

    return edit


def _lengthen(folder: Path) -> None:
    """Make a pin longer, keeping the size and the time of its file."""
    path = folder / "pin_b.stl"
    data, before = bytearray(path.read_bytes()), path.stat()
    top = max(
        struct.unpack_from("<f", data, 84 + 50 * i + 12 + 4 * k)[0]
        for i in range(len(data) // 50 - 1)
        for k in (2, 5, 8)
    )
    for i in range((len(data) - 84) // 50):
        for k in (2, 5, 8):
            at = 84 + 50 * i + 12 + 4 * k
            if struct.unpack_from("<f", data, at)[0] == top:
                struct.pack_into("<f", data, at, top + 1.0)
    path.write_bytes(data)
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))


def _reordered(folder: Path) -> None:
    """Put the first part last."""
    manifest = folder / "four_bar.toml"
    head, first, rest = manifest.read_text().split("[[part]]", 2)
    parts, tail = rest.split("[[group]]", 1)
    manifest.write_text(f"{head}[[part]]{parts}[[part]]{first}[[group]]{tail}")


def counts(sentences: tuple[str, ...]) -> dict[str, int | None]:
    """Of sentences such as "contacts of 6 pairs of parts": results by their word, and how many where it is said."""
    out = {}
    for sentence in sentences:
        word, many = re.match(r"(\w+)(?: of (\d+))?", sentence).groups()
        out[word] = many and int(many)
    return out


EDITS = {
    "nothing": (lambda folder: None, ""),
    "new times": (lambda folder: [os.utime(path) for path in folder.iterdir()], ""),
    "lines move": (_replaced("schema = 1", "\n# one\n# two\nschema = 1"), "findings"),
    "mobility": (_replaced("mobility = 1", "mobility = 2"), "findings"),
    "range": (_replaced("point = [0, 0, 0]", "point = [0, 0, 0]\nrange = [-90, 90]"), "simulation findings"),
    "drive": (_replaced("rate = 180", "rate = 90"), "simulation findings"),
    "intended axis": (_replaced("axis = [0, 0, 1]", "axis = [0, 1, 0]"), "joints simulation findings"),
    "material": (_replaced('material = "steel"', 'material = "brass"'), "mass simulation findings"),
    "moved": (_replaced("position = [15, 25.980762114, 8.1]", "position = [15, 25.98, 8.1]"),
              "contacts joints mass simulation findings"),
    "tolerance": (_replaced("[function]", "[tolerances]\ncontact = 0.2\n\n[function]"),
                  "surfaces contacts joints mass simulation findings"),
    "group": (_replaced('["rocker", "pin_c", "pin_d"]', '["rocker", "pin_d"]'),
              "contacts joints mass simulation findings"),
    "new shape": (_lengthen, "surfaces contacts joints mass simulation findings"),
    "renamed": (_replaced('name = "four_bar"', 'name = "linkage"'), "findings"),
    "intended type": (_replaced('type = "revolute"', 'type = "cylindrical"'), "joints simulation findings"),
    "parts in another order": (_reordered, "findings"),
}  # fmt: skip


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("first") / "four_bar"
    four_bar(folder)
    run(folder / "four_bar.toml", folder / "r.h5")
    return folder


NIGHTLY = (
    "new times", "range", "drive", "group", "renamed", "intended type", "a part by another name", "surfaces only",
    "another file of the same shape", "lines move", "moved", "tolerance", "parts in another order", "a unit",
)  # fmt: skip
"""Edits whose effects others have too."""


def _daily(names: Iterable[str]) -> list[Any]:
    return [pytest.param(name, marks=pytest.mark.sweep if name in NIGHTLY else []) for name in names]


@pytest.mark.parametrize("name", _daily(EDITS))
def test_a_change_recomputes_what_depends_on_it_and_gives_the_bytes_of_a_fresh_run(
    name: str, first: Path, tmp_path: Path
) -> None:
    edit, expected = EDITS[name]
    folder = tmp_path / "copy"
    shutil.copytree(first, folder)
    edit(folder)
    again = run(folder / "four_bar.toml", folder / "r.h5")
    run(folder / "four_bar.toml", folder / "fresh.h5")
    assert (folder / "r.h5").read_bytes() == (folder / "fresh.h5").read_bytes()
    computed = counts(again.recomputed).keys()
    assert computed == set(expected.split())
    assert counts(again.reused).keys() >= set(STAGES) - computed


def _without_a_pin(folder: Path) -> None:
    _replaced('[[part]]\nname = "pin_d"\nmesh = "pin_d.stl"\nmaterial = "steel"\nposition = [100, 0, 0]\n', "")(folder)
    _replaced('["rocker", "pin_c", "pin_d"]', '["rocker", "pin_c"]')(folder)


def _another_name(folder: Path) -> None:
    manifest = folder / "four_bar.toml"
    manifest.write_text(manifest.read_text().replace('"pin_c"', '"bolt"'))


OTHER_PARTS = {
    "a unit": _replaced('mesh = "pin_b.stl"', 'mesh = "pin_b.stl"\nunits = "cm"'),
    "a part less": _without_a_pin,
    "a part by another name": _another_name,
    "surfaces only": _replaced('mesh = "pin_a.stl"', 'mesh = "pin_a.stl"\nsolid = false'),
    "another file of the same shape": lambda folder: (
        shutil.copy(folder / "pin_a.stl", folder / "pin_e.stl"),
        _replaced('mesh = "pin_a.stl"', 'mesh = "pin_e.stl"')(folder),
    ),
}


@pytest.mark.parametrize("name", _daily(OTHER_PARTS))
def test_other_parts_keep_what_they_do_not_touch_and_give_the_bytes_of_a_fresh_run(
    name: str, first: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "copy"
    shutil.copytree(first, folder)
    OTHER_PARTS[name](folder)
    again = run(folder / "four_bar.toml", folder / "r.h5")
    run(folder / "four_bar.toml", folder / "fresh.h5")
    assert (folder / "r.h5").read_bytes() == (folder / "fresh.h5").read_bytes()
    reused = counts(again.reused)
    assert 5 <= reused["surfaces"] <= 8
    assert reused["contacts"] > 0
    assert again.recomputed


def test_changes_one_after_the_other_and_back_give_the_bytes_of_the_beginning(first: Path, tmp_path: Path) -> None:
    folder = tmp_path / "copy"
    shutil.copytree(first, folder)
    files = {path.name: path.read_bytes() for path in folder.iterdir()}
    for edit in (EDITS["moved"][0], EDITS["new shape"][0], OTHER_PARTS["a part less"]):
        edit(folder)
        run(folder / "four_bar.toml", folder / "r.h5")
    assert (folder / "r.h5").read_bytes() != files["r.h5"]
    for name, data in files.items():
        if name != "r.h5":
            (folder / name).write_bytes(data)
    run(folder / "four_bar.toml", folder / "r.h5")
    assert (folder / "r.h5").read_bytes() == files["r.h5"]


def test_only_the_pairs_of_a_part_that_moved_are_computed_again(first: Path, tmp_path: Path) -> None:
    shutil.copytree(first, tmp_path / "copy")
    EDITS["moved"][0](tmp_path / "copy")
    again = run(tmp_path / "copy/four_bar.toml", tmp_path / "copy/r.h5")
    pairs = again.contacts.candidates
    of_coupler = [pair for pair in pairs if "coupler" in pair]
    assert 0 < len(of_coupler) < len(pairs)
    assert counts(again.reused)["contacts"] == len(pairs) - len(of_coupler)
    assert counts(again.recomputed)["contacts"] == len(of_coupler)
    assert counts(again.reused)["surfaces"] == 6


def test_a_part_that_is_added_leaves_the_pairs_of_the_others(first: Path, tmp_path: Path) -> None:
    folder = tmp_path / "copy"
    shutil.copytree(first, folder)
    added = '[[part]]\nname = "spare"\nmesh = "pin_a.stl"\nmaterial = "steel"\nposition = [100, 0, 0]\n\n[[group]]'
    _replaced("[[group]]", added)(folder)
    again = run(folder / "four_bar.toml", folder / "r.h5")
    run(folder / "four_bar.toml", folder / "fresh.h5")
    assert (folder / "r.h5").read_bytes() == (folder / "fresh.h5").read_bytes()
    of_spare = [pair for pair in again.contacts.candidates if "spare" in pair]
    assert counts(again.recomputed)["contacts"] == len(of_spare) > 0
    assert counts(again.reused)["surfaces"] == 6


def test_other_code_recomputes_its_stage_and_keeps_the_later_ones_when_it_gives_the_same(
    first: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(first, tmp_path / "copy")
    monkeypatch.setattr("kinform.contacts.CODE_VERSION", 1000)
    again = run(tmp_path / "copy/four_bar.toml", tmp_path / "copy/r.h5")
    # collisions and the rules call the code of contacts as well
    assert list(counts(again.recomputed)) == ["contacts", "simulation", "findings"]
    assert {"joints", "mass"} <= set(again.reused)


def test_results_without_fingerprints_are_not_reused(first: Path, tmp_path: Path) -> None:
    design = results.read(first / "r.h5")
    bare = dataclasses.replace(design, fingerprints=Fingerprints())
    results.write(bare, tmp_path / "r.h5")
    again = run(first / "four_bar.toml", tmp_path / "r.h5")
    assert again.reused == ()
    assert (tmp_path / "r.h5").read_bytes() == (first / "r.h5").read_bytes()


def test_the_stages_one_by_one_through_files_give_the_file_of_a_run(first: Path, tmp_path: Path) -> None:
    path = tmp_path / "stage.h5"
    results.write(stages.import_(first / "four_bar.toml"), path)
    simulate = functools.partial(stages.simulate, ranges=False)
    for stage in (stages.contacts, stages.joints, stages.mass, simulate, stages.check):
        results.write(stage(results.read(path)), path)
    assert path.read_bytes() == (first / "r.h5").read_bytes()


def test_a_stage_that_is_run_again_drops_what_comes_after_it(first: Path) -> None:
    design = results.read(first / "r.h5")
    again = stages.mass(design)
    assert again.kinematics is design.kinematics
    assert again.mass is not None
    assert again.simulation is None
    assert again.report is None
    assert set(again.fingerprints.stages) == {"assembly", "surfaces", "contacts", "joints", "mass"}
    start = stages.contacts(design)
    assert start.kinematics is None
    assert start.mass is None


@pytest.mark.parametrize(
    ("stage", "missing", "needs"),
    [
        (stages.joints, "contacts", "contacts"),
        (stages.mass, "kinematics", "joints"),
        (stages.simulate, "mass", "mass"),
        (stages.check, "simulation", "simulate"),
    ],
)
def test_a_stage_names_the_command_that_it_misses(
    stage: Callable[[Design], Design], missing: str, needs: str, first: Path
) -> None:
    design = dataclasses.replace(results.read(first / "r.h5"), **{missing: None})
    with pytest.raises(kinform.StageError) as caught:
        stage(design)
    assert caught.value.needs == needs


def test_the_bytes_do_not_depend_on_folder_process_threads_jobs_or_memory(first: Path, tmp_path: Path) -> None:
    folder = tmp_path / "elsewhere" / "deeper"
    four_bar(folder)
    code = "import kinform; kinform.run('deeper/four_bar.toml', 'r.h5', jobs=2, ranges=False)"
    surroundings = {"PYTHONHASHSEED": "7", "OPENBLAS_NUM_THREADS": "2", "MALLOC_PERTURB_": "165", "TZ": "Asia/Tokyo"}
    subprocess.run([sys.executable, "-c", code], check=True, cwd=folder.parent, env=os.environ | surroundings)
    assert (folder.parent / "r.h5").read_bytes() == (first / "r.h5").read_bytes()


def test_a_bad_output_is_refused_before_the_manifest_is_read(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(kinform.ResultsError):
        run(tmp_path / "absent.toml", tmp_path / "notes.txt")


def test_an_interrupted_run_leaves_the_old_results(
    first: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "copy"
    shutil.copytree(first, folder)
    EDITS["moved"][0](folder)
    before = (folder / "r.h5").read_bytes()

    def stop(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("kinform.consistency.check", stop)
    with pytest.raises(KeyboardInterrupt):
        run(folder / "four_bar.toml", folder / "r.h5")
    assert (folder / "r.h5").read_bytes() == before
    assert sorted(path.name for path in folder.iterdir()) == sorted(path.name for path in first.iterdir())


def test_progress_counts_up_to_the_whole_of_each_stage(first: Path) -> None:
    said: list[tuple[str, int, int]] = []
    run(first / "four_bar.toml", progress=lambda *step: said.append(step))
    counts = [(done, total) for stage, done, total in said if stage == "contacts"]
    assert (6, 6) in counts
    assert counts[-1][0] == counts[-1][1]
    assert {stage for stage, _, _ in said} <= {"contacts", "simulation"}

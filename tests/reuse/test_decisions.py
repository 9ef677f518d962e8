"""Decisions that a results file keeps are found by all that decides them, and believed only with their seal."""

from __future__ import annotations

import dataclasses
import json
import math
import shutil
from pathlib import Path

import numpy as np
import pytest
from support.short_four_bar import four_bar, run

from kinform import kinematics, results
from kinform.model.kinematics import Release
from kinform.reuse.packing import pack, seal, unpack


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("built") / "four_bar"
    four_bar(folder)
    run(folder / "four_bar.toml", folder / "r.h5")
    return folder


@pytest.fixture
def folder(built: Path, tmp_path: Path) -> Path:
    shutil.copytree(built, tmp_path / "copy")
    return tmp_path / "copy"


def changed(folder: Path, old: str, new: str) -> None:
    text = (folder / "four_bar.toml").read_text()
    assert old in text
    (folder / "four_bar.toml").write_text(text.replace(old, new, 1))


def decisions(path: Path) -> dict[str, tuple[str, str]]:
    return results.read(path).fingerprints.decisions


FROM_NOTHING: dict[tuple[str, int], bytes] = {}
"""Results by the manifest and the version of what derives joints: those of several tests are the same."""


def from_nothing(folder: Path) -> bytes:
    key = (folder / "four_bar.toml").read_text(), kinematics.CODE_VERSION
    if key not in FROM_NOTHING:
        run(folder / "four_bar.toml", folder / "fresh.h5")
        FROM_NOTHING[key] = (folder / "fresh.h5").read_bytes()
    return FROM_NOTHING[key]


def as_from_nothing(folder: Path) -> bool:
    run(folder / "four_bar.toml", folder / "r.h5")
    return (folder / "r.h5").read_bytes() == from_nothing(folder)


def test_a_part_that_moved_keeps_the_decisions_about_the_others(folder: Path) -> None:
    before = decisions(folder / "r.h5")
    changed(folder, "position = [15, 25.980762114, 8.1]", "position = [15, 25.9807, 8.1]")
    assert as_from_nothing(folder)
    after = decisions(folder / "r.h5")
    assert set(before) & set(after)
    assert set(after) - set(before)
    assert all(after[key] == before[key] for key in set(before) & set(after))


@pytest.mark.parametrize("forged", [False, True])
def test_what_was_tampered_with_is_not_believed(folder: Path, forged: bool) -> None:
    design = results.read(folder / "r.h5")
    spoiled = {}
    for key, (text, own) in design.fingerprints.decisions.items():
        # a lie that its seal gives away, and rubbish with a seal of its own
        told = '{"@":"Nothing","fields":{}}' if forged else text.replace('"revolute"', '"fixed"').replace("1", "2")
        assert told != text or not forged
        spoiled[key] = told, seal(key, told) if forged else own
    assert spoiled != design.fingerprints.decisions
    marks = dataclasses.replace(design.fingerprints, decisions=spoiled)
    results.write(dataclasses.replace(design, fingerprints=marks), folder / "r.h5")
    changed(folder, "axis = [0, 0, 1]", "axis = [0, 1, 0]")  # so that joints are asked for again
    assert as_from_nothing(folder)


def test_decisions_of_other_code_are_not_found(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = decisions(folder / "r.h5")
    monkeypatch.setattr("kinform.kinematics.CODE_VERSION", 1000)
    assert as_from_nothing(folder)
    assert decisions(folder / "r.h5").keys().isdisjoint(before)


def test_a_tolerance_that_changed_decides_anew(folder: Path) -> None:
    before = decisions(folder / "r.h5")
    changed(folder, "[function]", "[tolerances]\nalignment = 0.4\n\n[function]")
    assert as_from_nothing(folder)
    pairs = [key for key, (text, _) in decisions(folder / "r.h5").items() if json.loads(text) and '"Answer"' in text]
    assert pairs
    assert set(pairs).isdisjoint(before)


def test_a_file_from_before_decisions_were_kept_is_read_and_gives_the_same(folder: Path) -> None:
    design = results.read(folder / "r.h5")
    marks = dataclasses.replace(design.fingerprints, decisions={}, inputs={})
    results.write(dataclasses.replace(design, fingerprints=marks), folder / "r.h5")
    changed(folder, "axis = [0, 0, 1]", "axis = [0, 1, 0]")
    again = run(folder / "four_bar.toml", folder / "r.h5")
    assert again.recomputed
    assert (folder / "r.h5").read_bytes() == from_nothing(folder)


def test_what_is_packed_comes_back_to_the_last_bit() -> None:
    numbers = np.array([0.1, -0.0, math.inf, -math.inf, math.nan, 5e-324, 1e308])
    release = Release("slide", numbers, np.zeros((0, 6)), None, True, 'quotes " and é and \n')
    value = (None, True, 3, -0.0, (release, ()), np.arange(6, dtype=np.int64).reshape(2, 3), np.float64(0.3))
    text = pack(value)
    found = unpack(text, {"Release": Release})
    assert pack(found) == text
    assert found[4][0].twist.tobytes() == numbers.tobytes()
    assert found[4][0].direction.shape == (0, 6)
    assert not found[5].flags.writeable
    assert math.copysign(1.0, found[3]) == -1.0


def test_only_named_classes_and_plain_values_are_packed() -> None:
    release = Release("slide", np.zeros(6), np.zeros(3), None, True, "")
    with pytest.raises(LookupError):
        unpack(pack(release), {})
    with pytest.raises(TypeError):
        pack(object())
    with pytest.raises(ValueError, match="O"):
        unpack('{"#": "|O", "shape": [1], "values": [1]}', {})

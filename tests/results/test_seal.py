"""A results file proves that it is whole: whatever is changed in it is refused before HDF5 sees it, and made again."""

from __future__ import annotations

import hashlib
import io
import random
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from support.command_line import ran_here
from support.places import FIXTURES
from support.sealing import editing

from kinform import results
from kinform.errors import ResultsError
from kinform.results import opening
from kinform.results.seal import BLOCK, read_seal, seal

PAIR = FIXTURES / "pairs" / "revolute_collars"
NAME = "revolute_collars.toml"


@pytest.fixture(scope="module")
def good(derive_design) -> bytes:
    return results.to_bytes(derive_design(PAIR / NAME))


@pytest.fixture
def folder(tmp_path: Path, good: bytes) -> Path:
    """The hinge with its results."""
    shutil.copytree(PAIR, tmp_path, dirs_exist_ok=True)
    (tmp_path / "r.h5").write_bytes(good)
    return tmp_path


def flipped(data: bytes, place: int, bit: int = 0) -> bytes:
    whole = bytearray(data)
    whole[place] ^= 1 << bit
    return bytes(whole)


def test_the_digest_is_that_of_all_bytes_after_the_block_as_any_program_computes_it(good: bytes, tmp_path) -> None:
    lines = dict(line.split(" ", 1) for line in good[:BLOCK].decode().splitlines()[1:4])
    assert lines["schema"] == results.SCHEMA
    assert int(lines["bytes"]) == len(good) - BLOCK
    assert lines["sha256"] == hashlib.sha256(good[BLOCK:]).hexdigest()
    if shutil.which("sha256sum"):
        (tmp_path / "r.h5").write_bytes(good)
        told = subprocess.run(
            f"tail -c +{BLOCK + 1} r.h5 | sha256sum",
            shell=True,
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=True,
        )
        assert told.stdout.split()[0] == lines["sha256"]


def test_other_programs_read_the_file_as_before(good: bytes, tmp_path: Path) -> None:
    with h5py.File(io.BytesIO(good)) as file:
        assert file.userblock_size == BLOCK
        assert file.attrs["schema"] == results.SCHEMA
        assert len(file["mass/bodies"]) == 2
    if shutil.which("h5dump") is None:
        pytest.skip("needs h5dump for the rest")
    (tmp_path / "r.h5").write_bytes(good)
    told = subprocess.run(["h5dump", "-n", "r.h5"], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "/mass/bodies" in told.stdout


def test_no_bit_of_the_file_can_change_unseen(good: bytes) -> None:
    """All bits of the block and of the first of HDF5, and some of all the others."""
    dice = random.Random(3)
    places = [*range(BLOCK + 96), *(dice.randrange(len(good)) for _ in range(300)), len(good) - 1]
    with tempfile.TemporaryFile() as stream:
        stream.write(good)
        assert read_seal(stream).fault is None
        for place in places:
            bit = dice.randrange(8)
            stream.seek(place)
            stream.write(bytes([good[place] ^ 1 << bit]))
            stream.flush()
            seen = read_seal(stream)
            told = seen is None or seen.fault is not None or seen.schema != results.SCHEMA  # of another one: refused
            assert told, (place, bit)
            stream.seek(place)
            stream.write(good[place : place + 1])
        assert read_seal(stream).fault is None


@pytest.mark.parametrize("length", [1, 15, 16, 100, 511, 512, 513, 520, 2048, -1])
def test_a_file_cut_off_anywhere_is_refused_and_may_be_made_again(good: bytes, length: int, tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    path.write_bytes(good[:length])
    with pytest.raises(ResultsError) as caught:
        results.read(path)
    assert caught.value.problem.remedy
    if length >= 16 or length < 0:
        results.check_output(path)


def test_hdf5_sees_no_byte_of_a_file_that_is_not_whole(good: bytes, tmp_path: Path, monkeypatch) -> None:
    def no(*_: object, **__: object) -> None:
        raise AssertionError("HDF5 was given the file")

    path = tmp_path / "r.h5"
    monkeypatch.setattr(opening.h5py, "File", no)
    for data in (flipped(good, len(good) // 2), good[:-1], good + b"\0", b"\x89HDF\r\n\x1a\n" + good):
        path.write_bytes(data)
        with pytest.raises(ResultsError) as caught:
            results.read(path)
        assert caught.value.problem.remedy


def test_masses_that_somebody_multiplied_are_refused_by_every_command_and_made_again_by_a_run(folder, good) -> None:
    with h5py.File(folder / "r.h5", "r+") as file:
        rows = file["mass/bodies"][()]
        rows["mass"] *= 10
        file["mass/bodies"][...] = rows
    spoilt = (folder / "r.h5").read_bytes()
    (folder / "good.h5").write_bytes(good)
    for words in (
        ("check", "r.h5"),
        ("show", "r.h5"),
        ("query", "r.h5", "--intended"),
        ("report", "r.h5", "-o", "r.html"),
        ("export", "r.h5", "--to", "json", "-o", "out"),
        ("lock", "r.h5", "-o", "r.lock"),
        ("diff", "good.h5", "r.h5"),
        ("catalog", "add", "r.h5"),
        ("contacts", "r.h5", "-o", "r.h5"),
        ("mass", "r.h5", "-o", "new.h5"),
        ("simulate", "r.h5", "-o", "new.h5"),
    ):
        ran = ran_here(*words, cwd=folder)
        assert (ran.returncode, ran.stdout) == (2, ""), words
        assert "r.h5: error: " in ran.stderr, words
        assert "kinform run MANIFEST -o FILE" in ran.stderr, words
    assert (folder / "r.h5").read_bytes() == spoilt
    ran = ran_here("run", NAME, "-o", "r.h5", cwd=folder)
    assert ran.returncode == 0
    assert "warning: r.h5: " in ran.stderr
    assert (folder / "r.h5").read_bytes() == good


STAGES = (
    "import",
    "contacts",
    *(pytest.param(stage, marks=pytest.mark.sweep) for stage in ("joints", "mass", "simulate", "check")),
)


@pytest.mark.parametrize("stage", STAGES)
def test_a_damaged_target_of_a_stage_counts_as_absent_with_a_warning(stage: str, folder: Path, good: bytes) -> None:
    source = NAME if stage == "import" else "good.h5"
    (folder / "good.h5").write_bytes(good)
    ran = {}
    for name, data in (("fresh", None), ("damaged", flipped(good, 9000))):
        if data is not None:
            (folder / f"{name}.h5").write_bytes(data)
        ran[name] = ran_here(stage, source, "-o", f"{name}.h5", cwd=folder)
        assert ran[name].returncode == 0
    assert "warning" not in ran["fresh"].stderr
    assert "warning: damaged.h5: " in ran["damaged"].stderr
    assert (folder / "damaged.h5").read_bytes() == (folder / "fresh.h5").read_bytes()


def test_what_is_watched_and_found_damaged_is_made_again(folder: Path, good: bytes) -> None:
    (folder / "r.h5").write_bytes(flipped(good, len(good) - 3))
    ran = ran_here("watch", NAME, "-o", "r.h5", "--max-runs", "1", cwd=folder)
    assert ran.returncode == 0
    assert "warning: r.h5: " in ran.stderr
    assert (folder / "r.h5").read_bytes() == good


def test_a_catalog_leaves_out_what_is_damaged_and_says_so(folder: Path, good: bytes) -> None:
    (folder / "spoilt.h5").write_bytes(flipped(good, 5000))
    ran = ran_here("catalog", "add", ".", cwd=folder)
    assert ran.returncode == 0
    assert "spoilt.h5" in ran.stderr


def _external_link(file: h5py.File) -> None:
    file["mass/more"] = h5py.ExternalLink("/etc/other.h5", "/secret")


def _soft_link(file: h5py.File) -> None:
    file["assembly/more"] = h5py.SoftLink("/mass")


def _cycle(file: h5py.File) -> None:
    file["assembly/again"] = file["/"]


def _second_name(file: h5py.File) -> None:
    file["assembly/again"] = file["assembly/parts"]


def _external_storage(file: h5py.File) -> None:
    file.create_dataset("assembly/more", (8,), "u1", external=[("/etc/hostname", 0, 8)])


def _virtual(file: h5py.File) -> None:
    layout = h5py.VirtualLayout((4,), "f8")
    layout[:] = h5py.VirtualSource("/etc/other.h5", "x", (4,))
    file.create_virtual_dataset("assembly/more", layout)


def _reference(file: h5py.File) -> None:
    file["assembly/more"] = np.array([file["mass"].ref], h5py.ref_dtype)


def _reference_in_a_table(file: h5py.File) -> None:
    file.create_dataset("assembly/more", (3,), [("a", "f8"), ("b", h5py.ref_dtype)])


def _reference_in_an_attribute(file: h5py.File) -> None:
    file["assembly"].attrs["more"] = file["mass"].ref


def _declared_and_not_there(file: h5py.File) -> None:
    file.create_dataset("assembly/more", (1 << 40,), "f8")


def _packed(file: h5py.File) -> None:
    file.create_dataset("assembly/more", data=np.zeros(1 << 20), compression="gzip")


def _type_of_its_own(file: h5py.File) -> None:
    file["assembly/more"] = np.dtype("f8")


FOREIGN: tuple[Callable[[h5py.File], None], ...] = (
    _external_link, _soft_link, _cycle, _second_name, _external_storage, _virtual, _reference, _reference_in_a_table,
    _reference_in_an_attribute, _declared_and_not_there, _packed, _type_of_its_own,
)  # fmt: skip


@pytest.mark.parametrize("spoil", FOREIGN)
def test_what_kinform_never_writes_is_refused_before_anything_is_read(spoil, folder: Path, good: bytes) -> None:
    with editing(folder / "r.h5") as file:
        spoil(file)
    with pytest.raises(ResultsError) as caught:
        results.read(folder / "r.h5")
    assert caught.value.problem.remedy
    told: list[str] = []
    assert results.earlier(folder / "r.h5", told.append) is None
    assert len(told) == 1


def test_texts_longer_than_the_file_are_refused(folder: Path, good: bytes) -> None:
    """Each of them says its own length; HDF5 would take memory for what it says."""
    with h5py.File(folder / "r.h5", "r") as file:
        offset = file["assembly/files"].id.get_offset()
    image = bytearray(good)
    image[offset : offset + 4] = (0x7FFF_FFFF).to_bytes(4, "little")
    (folder / "r.h5").write_bytes(seal(bytes(image[BLOCK:]), results.SCHEMA))
    with pytest.raises(ResultsError):
        results.read(folder / "r.h5")


@pytest.mark.parametrize("code", ["../../evil", "KF403\n::error::x", "=1"])
def test_codes_of_rules_that_are_no_words_of_kinform_are_refused(folder: Path, code: str) -> None:
    with editing(folder / "r.h5") as file:
        rules = file["findings/rules"][()]
        rules["code"][0] = code
        file["findings/rules"][...] = rules
    ran = ran_here("check", "r.h5", cwd=folder)
    assert ran.returncode == 2
    assert "findings/rules.code" in ran.stderr and "internal error" not in ran.stderr

"""A file that cannot be read is named, with what is wrong and what to do."""

from __future__ import annotations

from pathlib import Path

import h5py
import pytest
from support.places import FIXTURES

from kinform import results
from kinform.errors import ResultsError


@pytest.fixture(scope="module")
def good(derive_design) -> bytes:
    return results.to_bytes(derive_design(FIXTURES / "pairs/revolute_collars/revolute_collars.toml"))


def _refused(path: Path, words: str) -> None:
    with pytest.raises(ResultsError) as caught:
        results.read(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert words in message
    assert "\n  remedy: " in message


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    _refused(tmp_path / "r.h5", "no such file")


def test_a_folder(tmp_path: Path) -> None:
    _refused(tmp_path, "directory")


@pytest.mark.parametrize("content", [b"", b"solid cube\n", b"\x89PNG\r\n\x1a\n0000"])
def test_a_file_that_is_not_hdf5(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "r.h5").write_bytes(content)
    _refused(tmp_path / "r.h5", "not HDF5")


def test_hdf5_of_another_program(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "r.h5", "w") as file:
        file["x"] = [1.0]
    _refused(tmp_path / "r.h5", "another program")


@pytest.mark.parametrize("schema", ["kinform/results/3", "kinform/results/0"])
def test_another_schema_names_both_schemas_and_the_version_that_wrote_it(
    schema: str, good: bytes, tmp_path: Path
) -> None:
    path = tmp_path / "r.h5"
    path.write_bytes(good)
    with h5py.File(path, "r+") as file:
        file.attrs["schema"] = schema
        file.attrs["kinform"] = "7.8.9"
    before = path.read_bytes()
    for words in (schema, "kinform/results/2", "7.8.9"):
        _refused(path, words)
    with pytest.raises(ResultsError, match="not overwritten"):
        results.check_output(path)
    assert path.read_bytes() == before


def test_a_file_cut_off_anywhere(good: bytes, tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    for length in [8, 9, 50, 100, 512, 2048, len(good) // 2, len(good) - 1]:
        path.write_bytes(good[:length])
        _refused(path, "truncated or damaged")


@pytest.mark.parametrize(
    "name", ["assembly", "assembly/parts", "assembly/faces_offset", "contacts/samples", "joints/twists", "mobility"]
)
def test_a_file_with_a_missing_piece(name: str, good: bytes, tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    path.write_bytes(good)
    with h5py.File(path, "r+") as file:
        del file[name]
    _refused(path, "damaged")


def test_a_file_with_a_table_of_other_columns(good: bytes, tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    path.write_bytes(good)
    with h5py.File(path, "r+") as file:
        del file["mass/summary"]
        file["mass/summary"] = [1.0]
    _refused(path, "damaged")


def test_overwritten_bytes_are_refused_or_leave_a_design(good: bytes, tmp_path: Path) -> None:
    """Damage in the middle: whatever HDF5 notices is a ResultsError, never another exception."""
    path, refused = tmp_path / "r.h5", 0
    for start in range(0, len(good), len(good) // 40):
        path.write_bytes(good[:start] + b"\xaa" * 16 + good[start + 16 :])
        try:
            results.read(path)
        except ResultsError as error:
            refused += 1
            assert "remedy:" in str(error)
    assert refused > 0

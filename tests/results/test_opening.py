"""A file that cannot be read is named, with what is wrong and what to do."""

from __future__ import annotations

from pathlib import Path

import h5py
import pytest
from support.places import FIXTURES
from support.sealing import editing

from kinform import results
from kinform.errors import ResultsError
from kinform.results.seal import BLOCK, seal


@pytest.fixture(scope="module")
def good(derive_design) -> bytes:
    return results.to_bytes(derive_design(FIXTURES / "pairs/revolute_collars/revolute_collars.toml"))


def _refused(path: Path, *schemas: str) -> None:
    with pytest.raises(ResultsError) as caught:
        results.read(path)
    problem = caught.value.problem
    assert problem.file == str(path)
    assert problem.remedy
    assert all(schema in problem.message for schema in schemas)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    _refused(tmp_path / "r.h5")


def test_a_folder(tmp_path: Path) -> None:
    _refused(tmp_path)


@pytest.mark.parametrize("content", [b"", b"solid cube\n", b"\x89PNG\r\n\x1a\n0000", bytes(5000)])
def test_a_file_that_is_no_results_file(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "r.h5").write_bytes(content)
    _refused(tmp_path / "r.h5")


def test_hdf5_of_another_program_or_of_kinform_before_there_were_digests(tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    with h5py.File(path, "w") as file:
        file["x"] = [1.0]
    before = path.read_bytes()
    _refused(path)
    with pytest.raises(ResultsError):
        results.check_output(path)
    assert path.read_bytes() == before


@pytest.mark.parametrize("schema", ["kinform/results/4", "kinform/results/0"])
def test_another_schema_is_named_with_ours_and_never_overwritten(schema: str, good: bytes, tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    path.write_bytes(seal(good[BLOCK:], schema))
    before = path.read_bytes()
    _refused(path, schema, results.SCHEMA)
    assert results.fault_of(path) is None
    with pytest.raises(ResultsError):
        results.check_output(path)
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    "name", ["assembly", "assembly/parts", "assembly/faces_offset", "contacts/samples", "joints/twists", "mobility"]
)
def test_a_file_with_a_missing_piece(name: str, good: bytes, tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    path.write_bytes(good)
    with editing(path) as file:
        del file[name]
    _refused(path)


def test_a_file_with_a_table_of_other_columns(good: bytes, tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    path.write_bytes(good)
    with editing(path) as file:
        del file["mass/summary"]
        file["mass/summary"] = [1.0]
    _refused(path)

"""A results file that is only looked at is read as far as it is looked at: what is said of it stays the same."""

from __future__ import annotations

import pickle
from dataclasses import fields

import numpy as np
import pytest
from support.places import FIXTURES
from support.sealing import editing

from kinform import results
from kinform.errors import ResultsError
from kinform.model.kinematics import ConstraintMatrix
from kinform.results import at_need
from kinform.results.opening import SCHEMA


@pytest.fixture
def path(derive_design, tmp_path):
    design = derive_design(FIXTURES / "mechanisms" / "four_bar" / "four_bar.toml")
    results.write(design, tmp_path / "r.h5")
    return tmp_path / "r.h5"


def _values(matrix):
    return [getattr(matrix, field.name) for field in fields(ConstraintMatrix)]


def test_the_matrix_is_read_when_it_is_looked_at_and_is_the_same(path, monkeypatch):
    read = []
    codec = at_need.codec
    monkeypatch.setattr(at_need, "codec", lambda name: read.append(name) or codec(name))
    found = results.read_at_need(path)
    assert found.kinematics is not None and found.kinematics.joints
    assert "joints" in read and "constraints" not in read
    for got, expected in zip(
        _values(found.kinematics.matrix), _values(results.read(path).kinematics.matrix), strict=True
    ):
        np.testing.assert_array_equal(got, expected)
    assert read.count("constraints") == 2, "once for each of the two designs"
    assert isinstance(found.kinematics.matrix, ConstraintMatrix)


def test_another_process_is_given_a_plain_matrix(path):
    matrix = results.read_at_need(path).kinematics.matrix
    again = pickle.loads(pickle.dumps(matrix))
    assert type(again) is ConstraintMatrix
    for got, expected in zip(_values(again), _values(matrix), strict=True):
        np.testing.assert_array_equal(got, expected)
    with pytest.raises(AttributeError, match="rows"):
        _ = matrix.rows


def test_how_many_contacts_and_what_is_there_is_told_without_reading_it(path, monkeypatch):
    whole = results.read(path)
    looked = results.read_at_need(path)
    monkeypatch.setattr(at_need, "codec", lambda name: pytest.fail(f"{name} was read"))
    assert (
        looked.contact_counts
        == (len(whole.contacts.patches), len(whole.contacts.interferences))
        == whole.contact_counts
    )
    for field in fields(whole):
        if field.name not in ("surfaces", "fingerprints"):
            assert looked.has(field.name) == whole.has(field.name), field.name


def test_a_matrix_that_makes_no_sense_is_told_by_who_looks_at_it(path):
    assert SCHEMA in str(path.read_bytes()[:200])
    with editing(path) as file:
        del file["constraints/indptr"]
    looked = results.read_at_need(path)
    assert looked.kinematics.joints
    with pytest.raises(ResultsError):
        _ = looked.kinematics.matrix.indptr
    with pytest.raises(ResultsError):
        results.read(path)

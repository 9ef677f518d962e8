"""Catalogues that kinform did not write as they are: refused as damaged, or as no catalogue."""

from __future__ import annotations

import sqlite3

import pytest

from kinform.catalog import Catalog, read, write
from kinform.errors import InputError


@pytest.fixture
def catalog(tmp_path):
    """An empty catalogue."""
    write(Catalog(("a.h5",)), tmp_path / "c.db")
    return tmp_path / "c.db"


DESIGN = (
    "INSERT INTO designs VALUES ('a.h5', 'd', {name}, 'mm', {bodies}, 1, 1, 1, 0, 0, {mass}, 1.0, 1.0, {z}, NULL, 'g')"
)


def edited(catalog, *statements):
    with sqlite3.connect(catalog) as database:
        for statement in statements:
            database.execute(statement)
    database.close()
    return catalog


def test_a_design_comes_back(catalog):
    (entry,) = read(edited(catalog, DESIGN.format(name="'n'", bodies=2, mass=9, z=1.0))).entries
    assert (entry.name, entry.bodies, entry.mass, entry.size) == ("n", 2, 9.0, (1.0, 1.0, 1.0))


@pytest.mark.parametrize(
    "changed", [{"name": "x'00ff'"}, {"bodies": "'many'"}, {"mass": "'heavy'"}, {"z": "x'00'"}, {"bodies": "1.5"}]
)
def test_values_of_another_kind_are_damage(catalog, changed):
    values = {"name": "'n'", "bodies": 2, "mass": 9, "z": 1.0} | changed
    with pytest.raises(InputError):
        read(edited(catalog, DESIGN.format(**values)))


def test_a_view_that_never_ends_is_not_looked_into(catalog):
    endless = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT x AS path FROM n"
    edited(catalog, "DROP TABLE sources", f"CREATE VIEW sources AS {endless}")
    with pytest.raises(InputError):
        read(catalog)


@pytest.mark.parametrize("wrong", ["intendXd TEXT", "axi\xff_x REAL"])
def test_columns_of_other_names(catalog, wrong):
    right = b"intended TEXT" if "intend" in wrong else b"axis_x REAL"
    data = catalog.read_bytes()
    assert right in data
    catalog.write_bytes(data.replace(right, wrong.encode("latin-1")))
    with pytest.raises(InputError):
        read(catalog)


def test_text_that_is_none(catalog):
    edited(catalog, DESIGN.format(name="CAST(x'ff41' AS TEXT)", bodies=2, mass=9, z=1.0))
    with pytest.raises(InputError):
        read(catalog)


@pytest.mark.parametrize("at", ["sqlite_master", "FROM designs"])
def test_sizes_beyond_all_memory_are_damage(catalog, monkeypatch, at):
    """As SQLite answers where a length in the file was overwritten by bytes 0xff."""

    class Hungry(sqlite3.Connection):
        def execute(self, sql, *more):
            if at in sql:
                raise MemoryError
            return super().execute(sql, *more)

    connect = sqlite3.connect
    read(catalog)  # what is expected of a catalogue is known from here on
    monkeypatch.setattr(sqlite3, "connect", lambda *words, **more: connect(*words, **more, factory=Hungry))
    with pytest.raises(InputError):
        read(catalog)

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


DESIGN = "INSERT INTO designs VALUES ('a.h5', 'd', {name}, 'mm', {bodies}, 1, 1, 1, 0, 0, {mass}, 1.0, 1.0, {z}, NULL)"


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
    with pytest.raises(InputError, match="the catalog is damaged: it has a"):
        read(edited(catalog, DESIGN.format(**values)))


def test_a_view_that_never_ends_is_not_looked_into(catalog):
    endless = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT x AS path FROM n"
    edited(catalog, "DROP TABLE sources", f"CREATE VIEW sources AS {endless}")
    with pytest.raises(InputError, match="this is not a catalog of kinform"):
        read(catalog)

"""Copies in one place are found inside groups and sub-assemblies as well as outside; what only overlaps is none."""

from __future__ import annotations

import pytest

from kinform import form, stages
from kinform.consistency.questions.copies_in_place import copies_in_place

HEAD = 'schema = 1\n[assembly]\nname = "w"\nunits = "mm"\n'
BOX = 'shape = {type = "box", size = [100, 60, 10]}\nmaterial = "steel"\n'
GROUP = '[[group]]\nname = "g"\nparts = ["a", "b"]\n'
MASS = "mass = 1\ncentre_of_mass = [0, 0, 0]\ninertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n"


def two(first="", second="", rest=GROUP):
    return f'{HEAD}[[part]]\nname = "a"\n{BOX}{first}[[part]]\nname = "b"\n{BOX}{second}{rest}'


def pairs(folder, text):
    (folder / "m.toml").write_text(text)
    return [(first.name, second.name) for first, second in copies_in_place(form.load(folder / "m.toml"))]


@pytest.mark.parametrize(
    "text",
    [
        two(), two(rest=""), two(second="position = [1e-3, 0, 0]\n"), two(second="rpy = [0, 0, 180]\n"),
        two(rest=GROUP + '[[assume]]\nbetween = ["a", "b"]\nignore = true\nreason = "meant"\n'),
    ],
    ids=["group", "alone", "beside", "turned", "assumed"],
)  # fmt: skip
def test_copies_in_one_place_are_found(tmp_path, text):
    assert pairs(tmp_path, text) == [("a", "b")]


@pytest.mark.parametrize(
    "text",
    [
        two(second="position = [1, 0, 0]\n"), two(second="rpy = [0, 0, 90]\n"), two(rest=GROUP + MASS),
        two(second=MASS), two().replace('[100, 60, 10]}\nmaterial = "steel"\n[[group]]', "[100, 60, 11]}\n[[group]]"),
    ],
    ids=["moved", "turned", "mass of the group", "mass of the part", "another shape"],
)  # fmt: skip
def test_what_is_no_copy_or_weighs_nothing_is_none(tmp_path, text):
    assert pairs(tmp_path, text) == []


def test_copies_of_two_sub_assemblies_are_found(tmp_path):
    (tmp_path / "below.toml").write_text(two(second="position = [0, 0, 20]\n"))
    placed = "".join(f'[[subassembly]]\nname = "s{k}"\nfile = "below.toml"\n' for k in (1, 2))
    assert pairs(tmp_path, HEAD + placed) == [("s1/a", "s2/a"), ("s1/b", "s2/b")]


def judged(path):
    found = stages.import_(path)
    for stage in (stages.contacts, stages.joints, stages.mass, stages.simulate, stages.check):
        found = stage(found)
    return found.report


def test_copies_in_a_group_are_an_error(tmp_path):
    (tmp_path / "m.toml").write_text(two())
    errors = [(f.code, f.subject) for f in judged(tmp_path / "m.toml").findings if f.severity == "error"]
    assert errors == [("KF201", ("a", "b"))]


def test_two_sticks_with_a_mobility_alone_are_judged(tmp_path):
    sticks = '[[part]]\nname = "a"\n[[part]]\nname = "b"\n[function]\nmobility = 1\n'
    (tmp_path / "m.toml").write_text(HEAD + sticks)
    assert [f.code for f in judged(tmp_path / "m.toml").findings] == ["KF301"]

"""The stage as a whole: which pairs are looked at, reuse, progress, and the number of jobs."""

from __future__ import annotations

import dataclasses
import importlib
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.analytic_solids import MM, assembly, box_loop, extrusion, pose, round_loop
from support.diagonal import first
from support.places import FIXTURES

from kinform.contacts import find
from kinform.contacts.search.candidates import candidate_pairs
from kinform.form.readers.assembly import load
from kinform.foundation import processes
from kinform.surfaces import recover

# the package gives the function of the same name in its place
stage = importlib.import_module("kinform.contacts.find")


@cache
def cube():
    return extrusion(box_loop(0, 0, 10 * MM, 10 * MM), z0=0.0, z1=10 * MM)


@cache
def pin():
    return extrusion(round_loop(3 * MM, 24, centre=(5 * MM, 5 * MM)), z0=0.0, z1=10 * MM)


def row(**options):
    """Four cubes in a row, each touching the next, and a pin on the last."""
    parts = {name: (cube(), pose(translation=(10 * MM * k, 0, 0))) for k, name in enumerate("abcd")}
    parts["pin"] = (pin(), pose(translation=(30 * MM, 0, 10 * MM)))
    return assembly(parts, **options)


def same(first, second):
    """Whether two contacts are equal in every byte."""
    return (
        first.candidates == second.candidates
        and first.tolerance == second.tolerance
        and len(first.patches) == len(second.patches)
        and all(
            np.asarray(getattr(p, f.name)).tobytes() == np.asarray(getattr(q, f.name)).tobytes()
            for p, q in zip(first.patches, second.patches, strict=True)
            for f in dataclasses.fields(p)
        )
        and all(
            np.asarray(getattr(p, f.name)).tobytes() == np.asarray(getattr(q, f.name)).tobytes()
            for p, q in zip(first.interferences, second.interferences, strict=True)
            for f in dataclasses.fields(p)
        )
    )


def test_pairs_and_patches_are_sorted_and_each_patch_names_its_surfaces():
    design, surfaces = row()
    found = find(design, surfaces)
    assert found.candidates == (("a", "b"), ("b", "c"), ("c", "d"), ("d", "pin"))
    assert [p.parts for p in found.patches] == list(found.candidates)
    for patch in found.patches:
        kinds = [
            surfaces[design.part(name).mesh.digest].surfaces[k].kind
            for name, k in zip(patch.parts, patch.surfaces, strict=True)
        ]
        assert kinds == ["plane", "plane"]
        assert not patch.points.flags.writeable


def test_pairs_inside_a_group_are_not_looked_at():
    found = find(*row(groups=[("left", ("a", "b")), ("right", ("c", "d"))]))
    assert found.candidates == (("b", "c"), ("d", "pin"))


def test_pairs_that_an_assumption_ignores_are_not_looked_at_even_by_group():
    found = find(*row(groups=[("left", ("a", "b"))], ignore=[("c", "left"), ("pin", "d")]))
    assert found.candidates == (("c", "d"),)


def test_parts_without_a_mesh_are_skipped():
    design, surfaces = row()
    stick = dataclasses.replace(design.parts[1], mesh=None)
    design = dataclasses.replace(design, parts=(design.parts[0], stick, *design.parts[2:]))
    assert find(design, surfaces).candidates == (("c", "d"), ("d", "pin"))


def test_an_assembly_of_one_part_has_no_contacts():
    found = find(*assembly({"only": (cube(), pose())}))
    assert (found.candidates, found.patches, found.interferences) == ((), (), ())


def test_progress_counts_every_pair():
    seen = []
    find(*row(), progress=lambda done, total: seen.append((done, total)))
    assert seen == [(k, 4) for k in range(1, 5)]


def test_two_jobs_give_the_same_bytes_as_one(monkeypatch):
    monkeypatch.setattr(processes, "_threaded", False)  # else both would be done in this process
    design, surfaces = row()
    assert same(find(design, surfaces), find(design, surfaces, jobs=2))


@pytest.mark.parametrize(
    "fixture", first(1, ["mechanisms/table_four_legs", "seekers/seeker_2dof", "mechanisms/ball_bearing"])
)
def test_what_comes_of_a_pair_does_not_depend_on_those_that_are_looked_at_with_it(fixture, monkeypatch):
    design = load(FIXTURES / fixture / f"{Path(fixture).name}.toml")
    surfaces = {part.mesh.digest: recover(part.mesh, design.tolerances) for part in design.parts if part.mesh}
    alone = find(design, surfaces)
    assert len(alone.candidates) > 7
    rng = np.random.default_rng(3)
    for together in (1, 5, 100):
        monkeypatch.setattr(stage, "TOGETHER_PAIRS", together)
        monkeypatch.setattr(stage, "_by_neighbours", lambda pairs: [pairs[k] for k in rng.permutation(len(pairs))])
        assert same(alone, find(design, surfaces))


def test_named_pairs_are_taken_from_earlier_contacts_and_the_others_computed():
    design, surfaces = row()
    earlier = find(design, surfaces)
    counted = []
    again = find(
        design,
        surfaces,
        reuse=earlier,
        reuse_pairs=frozenset({("a", "b"), ("c", "d")}),
        progress=lambda done, total: counted.append(total),
    )
    assert same(earlier, again)
    assert again.patches[0] is earlier.patches[0]
    assert again.patches[1] is not earlier.patches[1]
    assert counted == [2, 2]


def test_pairs_that_no_longer_meet_are_not_reused():
    design, surfaces = row()
    earlier = find(design, surfaces)
    moved = dataclasses.replace(design.parts[0], X_WP=pose(translation=(-20 * MM, 0, 0)))
    design = dataclasses.replace(design, parts=(moved, *design.parts[1:]))
    again = find(design, surfaces, reuse=earlier, reuse_pairs=frozenset(earlier.candidates))
    assert ("a", "b") not in again.candidates
    assert same(find(design, surfaces), again)


@settings(max_examples=25, deadline=None)
@given(st.lists(st.tuples(*[st.integers(-30, 30)] * 3), min_size=2, max_size=9, unique=True))
def test_the_broad_phase_keeps_exactly_the_pairs_whose_boxes_come_within_the_tolerance(corners):
    parts = {f"p{k}": (cube(), pose(translation=np.array(corner) * 0.7 * MM)) for k, corner in enumerate(corners)}
    design, _ = assembly(parts)
    tolerance = design.tolerances.contact_of(*[design.parts[0].mesh.size] * 2)
    expected = {
        (f"p{i}", f"p{j}"): pytest.approx(tolerance)
        for i in range(len(corners))
        for j in range(i + 1, len(corners))
        if np.abs(np.subtract(corners[i], corners[j])).max() * 0.7 * MM - 10 * MM <= 1.02 * tolerance
    }
    found = candidate_pairs(design)
    assert found == expected
    assert list(found) == sorted(found)


def test_what_is_known_of_a_mesh_is_dropped_after_its_last_pair(monkeypatch):
    """Along a row of cubes no two of which are alike, named at random, no more than three are known at a time."""
    names = np.random.default_rng(5).permutation(list("abcdefghij"))
    cubes = [extrusion(box_loop(0, 0, 10 * MM, 10 * MM), z0=0.0, z1=(10 + k) * MM) for k in range(10)]
    made = assembly(
        {
            name: (cube, pose(translation=(10 * MM * k, 0, 0)))
            for k, (name, cube) in enumerate(zip(names, cubes, strict=True))
        }
    )
    known, of_pairs = [], stage.mated_pairs

    def counted(asked, surfaces, store, *rest):
        found = of_pairs(asked, surfaces, store, *rest)
        known.append(len(store.indices))
        return found

    before = find(*made)
    monkeypatch.setattr(stage, "TOGETHER_PAIRS", 1)
    monkeypatch.setattr(stage, "mated_pairs", counted)
    assert same(before, find(*made))
    assert list(before.candidates) == sorted(before.candidates)
    assert len(known) == len(before.candidates) == 9
    assert max(known) <= 3
    monkeypatch.setattr(stage, "_by_neighbours", lambda pairs: pairs[::-1])
    assert same(before, find(*made))

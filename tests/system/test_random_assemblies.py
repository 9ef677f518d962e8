"""A fixed part of the random sweep: every kind of scene, and the generator itself."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from random_assemblies import FAMILIES, case
from random_assemblies.verdict import judge

from kinform import contacts, form, kinematics, surfaces

KINDS = sorted({(family, function.__name__) for family, kinds in FAMILIES.items() for function in kinds})
ONE_OF_EACH = [
    pytest.param(
        1000 + number, *kind, marks=pytest.mark.sweep if number % 2 and KINDS[number - 1][0] == kind[0] else ()
    )
    for number, kind in enumerate(KINDS)
]
"""Every family, and of its kinds about every second; the others nightly."""


@pytest.fixture(scope="module")
def sixty():
    return [case(seed) for seed in range(60)]


def derived(made, folder):
    assembly = form.load(made.write(folder))
    meshes = {part.mesh.digest: part.mesh for part in assembly.parts}
    found = {key: surfaces.recover(mesh, assembly.tolerances) for key, mesh in meshes.items()}
    return kinematics.derive(assembly, found, contacts.find(assembly, found))


@pytest.mark.parametrize("seed, family, kind", ONE_OF_EACH, ids=lambda value: str(value))
def test_a_scene_of_each_kind_gives_its_truth(seed, family, kind, tmp_path):
    made = case(seed, family, kind)
    verdict = judge(made, derived(made, tmp_path))
    assert (verdict.outcome, verdict.why) == ("right", "")


@pytest.mark.parametrize("seed", [2000, *(pytest.param(seed, marks=pytest.mark.sweep) for seed in range(2001, 2008))])
def test_a_chain_gives_its_truth(seed, tmp_path):
    made = case(seed, "chain")
    verdict = judge(made, derived(made, tmp_path))
    assert (verdict.outcome, verdict.why) == ("right", "")


def test_a_case_is_the_same_each_time(tmp_path):
    first, second = case(17).write(tmp_path / "first"), case(17).write(tmp_path / "second")
    for path in sorted(first.parent.iterdir()):
        assert (second.parent / path.name).read_bytes() == path.read_bytes()


def test_sizes_run_from_a_millimetre_to_a_hundred_metres(sixty):
    sizes = [made.size for made in sixty]
    assert 1e-3 <= min(sizes) < 5e-3
    assert 20.0 < max(sizes) <= 100.0


def test_families_take_turns(sixty):
    kinds = Counter(made.kind.partition("/")[0] for made in sixty[:40])
    assert {"cylindrical", "revolute", "prismatic", "spherical", "planar", "fixed", "several", "chain"} <= set(kinds)


@pytest.mark.parametrize("seed", [0, *(pytest.param(s, marks=pytest.mark.sweep) for s in range(5, 40, 5))])
def test_the_judge_tells_a_false_truth(seed, tmp_path):
    """A truth of another kind or at another place is not taken for right."""
    made = case(seed)
    found = derived(made, tmp_path)
    for number, joint in enumerate(made.joints):
        others = [joint.moved(shifted(made.size))] if joint.type in ("revolute", "cylindrical", "spherical") else []
        others += [
            type(joint)(joint.roles, kind, np.array([0.6, 0.0, 0.8]), joint.point) for kind in ("planar", "revolute")
        ]
        for other in others:
            joints = (*made.joints[:number], other, *made.joints[number + 1 :])
            assert judge(type(made)(**{**vars(made), "joints": joints}), found).outcome != "right"


def shifted(size):
    X = np.eye(4)
    X[:3, 3] = 0.1 * size * np.array([0.36, 0.48, 0.8])
    return X

"""The same design at another size, at another place, in other files, with noise: the same joints, or doubt.

What is exact in doubles changes nothing: joints, bodies, patches and findings are those of the original. Files in
float32, and vertices that scatter, may cost certainty; a sure answer that differs is the one thing that must not be.
"""

from __future__ import annotations

import numpy as np
import pytest
from random_assemblies import FAMILIES, Wear, case
from random_assemblies.verdict import judge
from support.copies import Change, answers, axis_errors, bodies_of, checked, copy_of, derived, joints_of, turned
from support.diagonal import diagonal
from support.places import FIXTURES, manifests

FEW = ("pairs/revolute_collars", "pairs/prismatic_dovetail", "pairs/spherical_captive", "mechanisms/slider_crank")
EXACT = {
    "turned and moved": Change(rotation=turned(1), offset=(0.2, -0.1, 0.3), baked=True),
    "a thousandth": Change(scale=1e-3, rotation=turned(2)),
    "a thousandfold": Change(scale=1e3, rotation=turned(3)),
    "1 km away": Change(offset=(800.0, -500.0, 330.0), baked=True),
    "100 km away, by its poses": Change(offset=(8e4, -5e4, 3.3e4)),
    "other names and order": Change(shuffled=True, seed=5),
}
DOUBTFUL = ("ambiguous", "blocked")
ABSOLUTE = ("KF110",)
"""Findings that know absolute size."""


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """Copies that change nothing, derived once a module."""
    known = {}

    def of(name):
        if name not in known:
            path = FIXTURES / name / f"{name.rpartition('/')[2]}.toml"
            known[name] = checked(copy_of(path, tmp_path_factory.mktemp("plain"), Change()).path)
        return known[name]

    return of


def original_names(design):
    names = [part.name for part in design.assembly.parts] + [group.name for group in design.assembly.groups]
    return {name: name for name in names}


def copied(name, change, folder):
    return copy_of(FIXTURES / name / f"{name.rpartition('/')[2]}.toml", folder, change)


def common(answer, scattered):
    """What copies of any size have in common; of meshes whose vertices scatter only that a joint is in doubt, not how:
    growth of their surfaces hangs on the last bits of coordinates."""
    findings = {code: count for code, count in answer["findings"].items() if code not in ABSOLUTE}
    if not scattered:
        return answer | {"findings": findings}
    joints = {between: kind if kind[1] not in DOUBTFUL else DOUBTFUL for between, kind in answer["joints"].items()}
    kept = {code: count for code, count in findings.items() if code not in ("KF204", "KF901")}
    return answer | {"findings": kept, "joints": joints}


def same(plain_design, name, change, folder):
    """Nothing differs but the place."""
    copy = copied(name, change, folder)
    design = checked(copy.path)
    scattered = name.startswith("wild/scattered")
    found = common(answers(design, copy.originals), scattered)
    wanted = common(answers(plain_design, original_names(plain_design)), scattered)
    if scattered:
        del found["patches"], wanted["patches"]
    assert found == wanted
    for tilt, far in axis_errors(plain_design, design, copy, change).values():
        assert tilt < (1e-3 if scattered else 1e-6)
        assert far < (1e-3 if scattered else 1e-6)


def no_other_answer(plain_design, name, change, folder, tilt_most):
    """Each joint is as it was, or one of its readings, or ambiguous; between bodies that had none, none is sure.

    What contact made one body may fall apart into its parts, and be joined as these are.
    """
    copy = copied(name, change, folder)
    design = derived(copy.path)
    before = joints_of(plain_design, original_names(plain_design))
    whole = bodies_of(plain_design, original_names(plain_design)).values()
    for between, joint in joints_of(design, copy.originals).items():
        if joint.status in DOUBTFUL:
            continue
        joined = frozenset(body for body in whole for parts in between if parts & body)
        if joined == between:
            assert between in before, f"{joint.name}: {joint.type}"
            readings = [reading.type for reading in before[between].readings]
            alike = joint.type == "general" and joint.freedoms == before[between].freedoms  # askew by the noise alone
            assert alike or joint.type in (before[between].type, *readings), joint.reason
        elif len(joined) > 1:
            assert joined in before, f"{joint.name}: {joint.type}"
    errors = axis_errors(plain_design, design, copy, change)
    sure = {joint.name for joint in plain_design.kinematics.joints if joint.status == "determined"}
    assert all(tilt < tilt_most for name, (tilt, _) in errors.items() if name in sure)


OFTEN = [
    pytest.param(name, change, marks=() if k % len(FEW) == i and k > 1 else pytest.mark.sweep)
    for i, name in enumerate(FEW)
    for k, change in enumerate(EXACT)
]


@pytest.mark.parametrize(("name", "change"), OFTEN)
def test_what_is_exact_changes_nothing(plain, name, change, tmp_path):
    same(plain(name), name, EXACT[change], tmp_path)


@diagonal(name=FEW[:2], offset=[0.0, 30.0, 3e3])
def test_float32_gives_the_same_joints_or_doubt(plain, name, offset, tmp_path):
    change = Change(files="stl", baked=True, rotation=turned(6), offset=(offset, -0.4 * offset, 0.7 * offset))
    no_other_answer(plain(name), name, change, tmp_path, 5e-3)


@diagonal(name=FEW[:3], noise=[1e-6, 1e-5, 1e-4])
def test_noise_gives_the_same_joints_or_doubt(plain, name, noise, tmp_path):
    no_other_answer(plain(name), name, Change(noise=noise, seed=3), tmp_path, 0.05)


WORN = {"far": Wear(files="obj", far=2e4), "noisy": Wear(noise=3e-4), "coarse": Wear(coarse=True)}


def outcome(made, folder):
    return judge(made, derived(made.write(folder)).kinematics)


@diagonal(family=["cylindrical", "revolute", "prismatic", "stopped"], worn=list(WORN))
def test_a_random_assembly_is_right_or_in_doubt_however_worn(family, worn, tmp_path):
    verdict = outcome(case(301, family, wear=WORN[worn]), tmp_path)
    allowed = ("right",) if WORN[worn].clean else ("right", "ambiguous", "honest", "loose")
    assert verdict.outcome in allowed, verdict.why


ONCE_WRONG = {
    "flats of seven, torn by a relief": (2453, Wear(files="obj", coarse=True)),
    "hexagons whose corners scatter": (2798, Wear(noise=5.281017642622124e-4)),
    "a plate whose corners scatter": (3975, Wear(noise=7.277038425219599e-4)),
    "a shoulder by less than its outline": (1394, Wear(files="obj", far=1e5, coarse=True)),
}
"""Of 3,000 random assemblies, those whose answer was sure and wrong."""


@pytest.mark.parametrize("why", ONCE_WRONG)
def test_what_was_wrong_once_is_in_doubt_or_right(why, tmp_path):
    seed, wear = ONCE_WRONG[why]
    verdict = outcome(case(seed, wear=wear), tmp_path)
    assert verdict.outcome in ("right", "ambiguous"), verdict.why


def test_the_same_case_has_its_answer_at_every_number_of_facets(tmp_path):
    """The seed draws the tessellation anew: one shape in many."""
    for seed in range(2):
        verdict = outcome(case(seed, "cylindrical", "plain"), tmp_path / str(seed))
        assert (verdict.outcome, verdict.why) == ("right", "")


# --- the full set ---------------------------------------------------------------------------------------------------

LEFT_OUT = ("seeker", "single_file", "functional", "broken")
"""Sub-assemblies, several bodies in a file and no meshes: copies are not made of them."""
MANY = [
    f"{path.parent.parent.name}/{path.stem}"
    for path in manifests()
    if not path.parent.parent.name.startswith(LEFT_OUT) and (path.parent / "truth.json").exists()
]


@pytest.mark.sweep
@pytest.mark.parametrize("change", EXACT)
@pytest.mark.parametrize("name", MANY)
def test_every_fixture_is_the_same_in_every_exact_copy(plain, name, change, tmp_path):
    same(plain(name), name, EXACT[change], tmp_path)


@pytest.mark.sweep
@pytest.mark.parametrize("noise", [1e-6, 1e-5, 1e-4])
@pytest.mark.parametrize("name", MANY)
def test_every_fixture_with_noise_is_the_same_or_in_doubt(plain, name, noise, tmp_path):
    no_other_answer(plain(name), name, Change(noise=noise, seed=3), tmp_path, 0.05)


@pytest.mark.sweep
@pytest.mark.parametrize("worn", WORN)
@pytest.mark.parametrize("kind", sorted({(family, f.__name__) for family, kinds in FAMILIES.items() for f in kinds}))
def test_every_kind_of_random_assembly_is_right_or_in_doubt(kind, worn, tmp_path):
    verdict = outcome(case(400 + int(np.sum([ord(c) for c in kind[1]])), *kind, wear=WORN[worn]), tmp_path)
    allowed = ("right",) if WORN[worn].clean else ("right", "ambiguous", "honest", "loose")
    assert verdict.outcome in allowed, verdict.why

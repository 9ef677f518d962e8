"""The library as a notebook uses it."""

from __future__ import annotations

import shutil
import subprocess
import sys

import pytest
from support.places import FIXTURES

import kinform

HINGE = FIXTURES / "pairs" / "revolute_collars"


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    folder = tmp_path_factory.mktemp("api") / "pair"
    shutil.copytree(HINGE, folder)
    return kinform.run(folder / "revolute_collars.toml", folder / "r.h5"), folder


def test_a_run_gives_typed_results_by_name(outcome):
    results, _ = outcome
    joint = results.joints["block~shaft"]
    assert (joint.type, joint.freedoms, joint.status) == ("revolute", 1, "determined")
    assert results.mobility.effective == 1
    assert results.mass["shaft"].mass > 0
    assert set(results.bodies) == {"block", "shaft"}
    assert results.report.ran > 0
    assert "block~shaft" in repr(results)


def test_an_unknown_name_lists_what_there_is(outcome):
    with pytest.raises(KeyError, match="block~shaft"):
        outcome[0].joints["shaft~block"]


def test_opening_the_file_gives_the_same(outcome):
    results, folder = outcome
    again = kinform.open(folder / "r.h5")
    assert [j.name for j in again.joints.values()] == [j.name for j in results.joints.values()]
    assert again.joints["block~shaft"].axis.tolist() == results.joints["block~shaft"].axis.tolist()


def test_a_second_run_reuses_everything_and_writes_the_same_bytes(outcome):
    _, folder = outcome
    before = (folder / "r.h5").read_bytes()
    again = kinform.run(folder / "revolute_collars.toml", folder / "r.h5")
    assert again.recomputed == ()
    assert len(again.reused) == 6
    assert (folder / "r.h5").read_bytes() == before
    kinform.run(folder / "revolute_collars.toml", folder / "fresh.h5")
    assert (folder / "fresh.h5").read_bytes() == before


def test_a_moved_part_recomputes_what_depends_on_it_and_says_why(outcome):
    _, folder = outcome
    text = (folder / "revolute_collars.toml").read_text()
    other = folder / "other.toml"
    other.write_text(text.replace("schema = 1", "schema = 1\n# moved", 1))
    shutil.copy(folder / "r.h5", folder / "o.h5")
    commented = kinform.run(other, folder / "o.h5")
    assert any(sentence.startswith("contacts") for sentence in commented.reused)
    assert not any(sentence.startswith("joints") for sentence in commented.recomputed)


def test_what_is_not_computed_says_which_command_computes_it(outcome):
    from kinform import stages

    results = kinform.Results(stages.import_(outcome[1] / "revolute_collars.toml"))
    with pytest.raises(kinform.StageError) as caught:
        _ = results.joints
    assert caught.value.needs == "joints"


def test_the_public_names_are_there_and_run_is_callable_however_it_is_imported():
    code = (
        "import kinform, sys\n"
        "heavy = {'scipy', 'trimesh', 'numba', 'h5py'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
        "import kinform.method\n"
        "assert callable(kinform.run)\n"
        "assert all(getattr(kinform, name) is not None for name in kinform.__all__)\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_problems_of_the_input_come_all_at_once(tmp_path):
    manifest = tmp_path / "m.toml"
    manifest.write_text('schema = 1\n[assembly]\nname = "x"\n[[part]]\nname = "a"\nmesh = "none.stl"\nshade = 1\n')
    with pytest.raises(kinform.InputError) as caught:
        kinform.run(manifest)
    lines = sorted(p.line for p in caught.value.problems)
    assert lines == [2, 6, 7]

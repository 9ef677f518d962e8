"""kinform from Python: what is public, what it costs to import, and what its objects say."""

from __future__ import annotations

import importlib.resources
import inspect
import json
import subprocess
import sys
import types
from pathlib import Path

import numpy as np
import pytest
from support.places import FIXTURES

import kinform

SEEKER = FIXTURES / "seekers/seeker_1dof/seeker_1dof.toml"


@pytest.fixture(scope="module")
def outcome(tmp_path_factory: pytest.TempPathFactory) -> kinform.Outcome:
    return kinform.run(SEEKER, tmp_path_factory.mktemp("api") / "r.h5")


def _in_fresh_python(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout


@pytest.mark.parametrize(
    "code", ["import kinform", "import kinform, kinform.errors; dir(kinform); kinform.__version__"]
)
def test_importing_kinform_imports_nothing_heavy(code: str) -> None:
    heavy = {"scipy", "trimesh", "numba", "h5py", "fcl", "manifold3d", "pydantic", "matplotlib", "numpy"}
    loaded = _in_fresh_python(f"{code}\nimport sys\nprint(*sys.modules)").split()
    assert "kinform" in loaded
    assert heavy.isdisjoint(loaded)


@pytest.mark.parametrize(
    "code",
    [
        "import kinform",
        "import kinform.method",
        "import kinform; kinform.run; import kinform.method",
        "import kinform.method; import importlib; importlib.reload(kinform)",
        "import kinform; from kinform.method import Progress, run; assert run is kinform.run",
        "import kinform; from kinform import run; assert run is kinform.run",
        "import kinform; import sys; import kinform.stages, kinform.method; assert 'kinform.run' not in sys.modules",
    ],
)
def test_run_is_the_function_whoever_imports_its_module(code: str) -> None:
    check = "import types; assert isinstance(kinform.run, types.FunctionType); print(kinform.run.__module__)"
    assert _in_fresh_python(f"{code}\n{check}") == "kinform.method\n"


def test_every_public_name_is_there_documented_and_listed() -> None:
    assert dir(kinform) == sorted(kinform.__all__)
    for name in kinform.__all__:
        found = getattr(kinform, name)
        assert isinstance(found, str) or (found.__doc__ or "").strip(), name
        assert not isinstance(found, types.ModuleType), name
    with pytest.raises(AttributeError, match="nonsense"):
        kinform.nonsense  # noqa: B018
    assert importlib.resources.files("kinform").joinpath("py.typed").is_file()


def test_public_classes_document_and_annotate_what_they_offer() -> None:
    for cls in (kinform.Results, kinform.Outcome):
        for name, member in inspect.getmembers(cls):
            if name.startswith("_"):
                continue
            function = member.fget if isinstance(member, property) else member
            assert function.__doc__, name
            assert "return" in function.__annotations__, name


def test_run_and_open_give_the_same_results(outcome: kinform.Outcome, tmp_path: Path) -> None:
    outcome.save(tmp_path / "again.h5")
    opened = kinform.open(tmp_path / "again.h5")
    assert opened.summary() == outcome.summary()
    assert isinstance(outcome, kinform.Results)
    assert outcome.reused == ()
    assert [sentence.split()[0].rstrip(":") for sentence in outcome.recomputed] == [
        "surfaces", "contacts", "joints", "mass", "simulation", "findings",
    ]  # fmt: skip


def test_results_are_looked_up_by_name(outcome: kinform.Outcome) -> None:
    (joint,) = outcome.joints.values()
    assert joint.type == "revolute"
    assert outcome.joints[joint.name] is joint
    assert set(joint.bodies) == set(outcome.bodies) == set(outcome.mass)
    assert outcome.mobility.effective == 1
    assert sum(body.mass for body in outcome.mass.values()) == pytest.approx(
        sum(part.mass for part in outcome.part_mass.values())
    )
    assert set(outcome.parts) == {part.name for part in outcome.assembly.parts}
    assert outcome.contacts.patches
    assert outcome.simulation.time[-1] > 0
    assert outcome.findings == outcome.report.findings == ()


def test_a_wrong_name_lists_the_right_ones(outcome: kinform.Outcome) -> None:
    with pytest.raises(KeyError) as caught:
        outcome.bodies["houzing"]
    message = str(caught.value)
    assert "houzing" in message
    assert all(name in message for name in outcome.bodies)


def test_what_is_not_computed_names_the_command_that_computes_it(tmp_path: Path) -> None:
    from kinform import stages

    results = kinform.Results(stages.import_(SEEKER))
    commands = {"contacts": "contacts", "joints": "joints", "bodies": "joints", "mobility": "joints", "mass": "mass",
                "behaviour": "simulate", "simulation": "simulate", "findings": "check"}  # fmt: skip
    for name, command in commands.items():
        with pytest.raises(kinform.StageError) as caught:
            getattr(results, name)
        assert caught.value.needs == command
    assert "seeker_1dof" in repr(results)


def test_a_representation_names_joints_and_counts(outcome: kinform.Outcome) -> None:
    (name,) = outcome.joints
    assert name in repr(outcome)
    assert name in repr(outcome.joints)
    assert "kg" in repr(outcome.mass)
    assert repr(outcome.parts).count("\n") == len(outcome.parts)


def test_meshes_in_place_of_a_manifest_need_their_unit(tmp_path: Path) -> None:
    meshes = sorted((FIXTURES / "pairs/revolute_collars").glob("*.stl"))
    with pytest.raises(kinform.InputError):
        kinform.run(meshes)
    assert len(kinform.run(meshes, units="mm").parts) == 2


class TestSummary:
    """The JSON of `kinform show`."""

    def test_joints_are_as_the_contract_has_them(self, outcome: kinform.Outcome) -> None:
        found = outcome.summary("joints")
        assert found["schema"] == "kinform/joints/1"
        assert (found["assembly"], found["units"]) == ("seeker_1dof", "mm")
        for body in found["bodies"]:
            assert body.keys() >= {"name", "parts", "ground"}
        (joint,) = found["joints"]
        assert joint.keys() >= {
            "name", "bodies", "type", "axis", "point", "pitch", "freedoms", "evidence", "status", "range",
        }  # fmt: skip
        assert joint["pitch"] is None
        assert joint["range"] == {"lower": None, "upper": None, "status": "unbounded"}
        assert joint["freedoms"] == 1
        np.testing.assert_allclose(np.linalg.norm(joint["axis"]), 1.0)
        assert found["mobility"] == {
            "instantaneous": 1, "finite": 1, "effective": 1, "idle": 0, "redundant": 0, "blocked_mobility": 1,
            "contact_mobility": None, "low_mobility": 1, "high_mobility": 1,
        }  # fmt: skip

    def test_general_joints_have_their_twists(self) -> None:
        found = kinform.run(FIXTURES / "pairs/general_ball_on_table/general_ball_on_table.toml").summary("joints")
        (joint,) = found["joints"]
        assert joint["type"] == "general"
        assert np.shape(joint["twists"]) == (joint["freedoms"], 6)

    @pytest.mark.parametrize(
        "topic", ["assembly", "contacts", "joints", "mobility", "mass", "behaviour", "simulation", "findings"]
    )
    def test_every_topic_has_its_schema_and_is_strict_json(self, topic: str, outcome: kinform.Outcome) -> None:
        from kinform import reports

        def refuse(constant: str) -> None:
            raise AssertionError(constant)

        text = reports.summary_json(outcome.design, topic)
        found = json.loads(text, parse_constant=refuse)
        assert found["schema"] == f"kinform/{topic}/1"
        assert found == outcome.summary(topic)
        assert outcome.summary()[topic] == found

    def test_what_has_not_run_is_null_in_the_overview_and_an_error_alone(self) -> None:
        from kinform import stages

        results = kinform.Results(stages.import_(SEEKER))
        assert results.summary()["joints"] is None
        with pytest.raises(kinform.StageError) as caught:
            results.summary("joints")
        assert caught.value.needs == "joints"

    def test_an_unknown_topic_lists_the_known_ones(self, outcome: kinform.Outcome) -> None:
        with pytest.raises(ValueError, match="mobility"):
            outcome.summary("colour")

    def test_numbers_that_are_not_finite_are_null(self) -> None:
        from kinform.reports.values.plain import plain

        assert plain({"a": np.array([1.0, np.nan, -np.inf]), 1: (np.int64(2), -0.0, True)}) == {
            "a": [1.0, None, None], "1": [2, 0.0, True],
        }  # fmt: skip

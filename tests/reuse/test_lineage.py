"""Whether nothing changed is told from files, settings and versions alone, and never told wrongly."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from support.places import FIXTURES

import kinform
from kinform import results, stages
from kinform.api import Outcome
from kinform.foundation.algebra.vectors import cross


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("built") / "pair"
    shutil.copytree(FIXTURES / "pairs/planar_block", folder)
    kinform.run(folder / "planar_block.toml", folder / "r.h5")
    return folder


@pytest.fixture
def pair(built: Path, tmp_path: Path) -> Path:
    shutil.copytree(built, tmp_path / "pair")
    return tmp_path / "pair"


def unchanged(folder: Path) -> Outcome | None:
    return Outcome.unchanged(folder / "planar_block.toml", folder / "r.h5")


def test_what_was_just_run_is_unchanged_and_is_read_when_asked_for(pair: Path) -> None:
    found = unchanged(pair)
    assert found is not None
    assert found.recomputed == ()
    assert found.gist.report == results.read(pair / "r.h5").report
    assert found.gist.assembly.parts == ()
    assert set(found.joints) == {"block~table"}
    assert results.to_bytes(found.design) == (pair / "r.h5").read_bytes()


def test_without_a_stated_ground_the_bodies_are_known_too(pair: Path) -> None:
    manifest = pair / "planar_block.toml"
    lines = [line for line in manifest.read_text().splitlines() if not line.startswith("ground")]
    manifest.write_text("\n".join(lines) + "\n")
    assert unchanged(pair) is None
    kinform.run(manifest, pair / "r.h5")
    found = unchanged(pair)
    assert found is not None
    assert found.gist.kinematics is not None
    assert [body.name for body in found.gist.kinematics.bodies] == ["block", "table"]


def test_results_that_are_replaced_before_they_are_read_are_refused(pair: Path) -> None:
    found = unchanged(pair)
    assert found is not None
    results.write(stages.import_(pair / "planar_block.toml"), pair / "r.h5")
    with pytest.raises(kinform.ResultsError):
        _ = found.joints


def _touch_comment(folder: Path) -> None:
    with open(folder / "planar_block.toml", "a") as file:
        file.write("# a comment\n")


def _flip_header(folder: Path) -> None:
    data = bytearray((folder / "block.stl").read_bytes())
    data[0] ^= 1
    (folder / "block.stl").write_bytes(bytes(data))


def _rewrite(stage: Callable[..., object], **settings: object) -> Callable[[Path], None]:
    def edit(folder: Path) -> None:
        design = stage(results.read(folder / "r.h5"), **settings)
        for later in (stages.simulate, stages.check):
            if later is not stage:
                design = later(design)
        results.write(design, folder / "r.h5")  # type: ignore[arg-type]

    return edit


CHANGES = {
    "a comment": _touch_comment,
    "a header of a mesh": _flip_header,
    "a mesh is gone": lambda folder: (folder / "block.stl").unlink(),
    "the manifest is another": lambda folder: (folder / "planar_block.toml").write_text("schema = 1\n"),
    "simulated at a level": _rewrite(stages.simulate, level="functional"),
    "not checked": lambda folder: results.write(stages.simulate(results.read(folder / "r.h5")), folder / "r.h5"),
    "only imported": lambda folder: results.write(stages.import_(folder / "planar_block.toml"), folder / "r.h5"),
    "no results": lambda folder: (folder / "r.h5").unlink(),
    "torn results": lambda folder: (folder / "r.h5").write_bytes((folder / "r.h5").read_bytes()[:5000]),
}


@pytest.mark.parametrize("change", CHANGES)
def test_any_change_is_looked_at(change: str, pair: Path) -> None:
    CHANGES[change](pair)
    assert unchanged(pair) is None


@pytest.mark.parametrize("package", ["form", "surfaces", "contacts", "kinematics", "mass", "simulation", "consistency"])
def test_other_code_is_looked_at(package: str, pair: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(f"kinform.{package}.CODE_VERSION", 1000)
    assert unchanged(pair) is None


def test_stages_on_results_of_other_code_do_not_pass_for_a_run(pair: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as other:
        other.setattr("kinform.contacts.CODE_VERSION", 1000)
        results.write(stages.contacts(results.read(pair / "r.h5")), pair / "r.h5")
    design = results.read(pair / "r.h5")
    for stage in (stages.joints, stages.mass, stages.simulate, stages.check):
        design = stage(design)
    results.write(design, pair / "r.h5")
    assert unchanged(pair) is None


def test_versions_are_read_without_importing_and_are_those_of_the_packages() -> None:
    import importlib

    from kinform.reuse import dependence, fingerprints

    for packages in dependence.CODE.values():
        for package in packages:
            stated = importlib.import_module(f"kinform.{package}").CODE_VERSION
            assert fingerprints.stated_version(package) == stated


def test_a_mesh_that_changed_while_it_was_read_leaves_no_lineage(pair: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from kinform.form.readers import open_manifest

    parse = open_manifest.parse

    def parse_and_edit(path: Path, *rest: object) -> object:
        found = parse(path, *rest)  # type: ignore[arg-type]
        _touch_comment(path.parent)
        return found

    monkeypatch.setattr("kinform.form.readers.assembly.parse", parse_and_edit)
    marks = stages.import_(pair / "planar_block.toml").fingerprints
    assert (marks.files, marks.lineage) == ({}, {})


@pytest.mark.parametrize(
    "shapes", [((3,), (3,)), ((5, 3), (5, 3)), ((3,), (4, 3)), ((2, 1, 3), (1, 6, 3)), ((0, 3), (3,))]
)
def test_cross_products_are_those_of_numpy_to_the_last_bit(shapes: tuple[tuple[int, ...], ...]) -> None:
    random = np.random.default_rng(3)
    a, b = (random.normal(size=shape) * 10.0 ** random.integers(-9, 9, shape) for shape in shapes)
    mine, theirs = cross(a, b), np.cross(a, b)
    assert mine.tobytes() == theirs.tobytes()
    assert mine.shape == theirs.shape

"""A file that somebody changed and sealed again makes sense, or is refused with the dataset that does not."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from support.command_line import ran_here
from support.diagonal import some
from support.places import FIXTURES
from support.sealing import editing

from kinform import results, stages
from kinform.errors import ResultsError
from kinform.results import schema

MANIFEST = FIXTURES / "functional" / "stick_four_bar" / "stick_four_bar.toml"
HINGE = FIXTURES / "pairs" / "revolute_collars" / "revolute_collars.toml"
COMMANDS = {
    "show": ("show", "r.h5"),
    "show joints": ("show", "r.h5", "joints"),
    "check": ("check", "r.h5"),
    "report": ("report", "r.h5", "-o", "r.html"),
    "export": ("export", "r.h5", "--to", "json", "-o", "m.json"),
    "simulate": ("simulate", "r.h5", "-o", "s.h5"),
    "query": ("query", "r.h5", "block", "shaft", "--slide", "z"),
    "diff": ("diff", "r.h5", "good.h5"),
    "lock": ("lock", "r.h5", "-o", "lock.json"),
    "catalog": ("catalog", "add", "r.h5"),
}


@pytest.fixture(scope="module")
def hinge(derive_design) -> bytes:
    return results.to_bytes(derive_design(HINGE))


def _swap(name: str, change: Callable[[np.ndarray], np.ndarray]) -> Callable[[h5py.File], None]:
    """Another array in place of a dataset."""

    def edit(file: h5py.File) -> None:
        data = change(file[name][()])
        del file[name]
        file[name] = data

    return edit


def _cell(name: str, column: str, value: object, row: int = 0) -> Callable[[h5py.File], None]:
    def edit(file: h5py.File) -> None:
        rows = file[name][()]
        rows[column][row] = value
        file[name][...] = rows

    return edit


def _item(name: str, place: tuple[int, ...], value: float) -> Callable[[h5py.File], None]:
    def edit(file: h5py.File) -> None:
        file[name][place] = value

    return edit


def _drop(name: str) -> Callable[[h5py.File], None]:
    def edit(file: h5py.File) -> None:
        del file[name]

    return edit


EDITS: dict[str, tuple[Callable[[h5py.File], None], str]] = {
    "fewer poses": (_swap("assembly/X_WP", lambda a: a[:1]), "assembly/X_WP"),
    "poses of three rows": (_swap("assembly/X_WP", lambda a: a[:, :3]), "assembly/X_WP"),
    "poses as whole numbers": (_swap("assembly/X_WP", lambda a: a.astype(np.int64)), "assembly/X_WP"),
    "a pose that is no number": (_item("assembly/X_WP", (0, 0, 0), np.nan), "assembly/X_WP"),
    "a vertex at infinity": (_item("assembly/vertices", (0, 0), np.inf), "assembly/vertices"),
    "a corner that is no vertex": (_item("assembly/faces", (0, 0), 10**6), "assembly/faces"),
    "a negative corner": (_item("assembly/faces", (0, 0), -1), "assembly/faces"),
    "offsets that fall": (_item("assembly/faces_offset", (1,), -1), "assembly/faces_offset"),
    "no offsets": (_drop("assembly/faces_offset"), "assembly/faces_offset"),
    "the mesh of nothing": (_cell("assembly/parts", "mesh", 77), "assembly/parts.mesh"),
    "a negative mesh": (_cell("assembly/parts", "mesh", -2), "assembly/parts.mesh"),
    "one part twice": (_cell("assembly/parts", "name", b"shaft", 0), "assembly/parts.name"),
    "texts in place of a table": (_swap("joints/joints", lambda a: np.array([b"x"])), "joints/joints"),
    "no joints": (_drop("joints/joints"), "joints/twists needs joints/joints,"),
    "a type that is none": (_cell("joints/joints", "type", b"magic"), "joints/joints.type"),
    "a body that is none": (_cell("joints/joints", "body_a", b"nobody"), "joints/joints.body_a"),
    "an axis that is no number": (_cell("joints/joints", "axis_x", np.nan), "joints/joints.axis_x"),
    "an axis whose square is no number": (_cell("joints/joints", "axis_x", 1e160), "joints/joints.axis_x"),
    "a vertex whose square is no number": (_item("assembly/vertices", (0, 0), -1e160), "assembly/vertices"),
    "a patch beyond": (_item("joints/patches", (0,), 99), "joints/patches"),
    "a patch before": (_item("joints/patches", (0,), -1), "joints/patches"),
    "samples of no patch": (_cell("contacts/samples", "patch", 99), "contacts/samples.patch"),
    "a label beyond": (_item("surfaces/labels", (0,), 10**6), "surfaces/labels"),
    "a column of J beyond": (_item("constraints/indices", (0,), 12), "constraints/indices"),
    "twists of three": (_swap("joints/twists", lambda a: a[:, :3]), "joints/twists"),
    "freedoms of other bodies": (_swap("mobility/freedoms", lambda a: a[:, :1]), "mobility/freedoms"),
    "two rows of counts": (_swap("mobility/counts", lambda a: np.concatenate([a, a])), "mobility/counts"),
    "mass of nobody": (_cell("mass/bodies", "name", b"nobody"), "mass/bodies.name"),
    "a severity that is none": (_cell("findings/rules", "outcome", b"fine"), "findings/rules.outcome"),
}


@pytest.mark.parametrize("case", some(2, list(EDITS)))
def test_what_makes_no_sense_is_refused_with_the_dataset_and_the_remedy(
    case: str, hinge: bytes, tmp_path: Path
) -> None:
    edit, dataset = EDITS[case]
    (tmp_path / "r.h5").write_bytes(hinge)
    with editing(tmp_path / "r.h5") as file:
        edit(file)
    with pytest.raises(ResultsError) as caught:
        results.read(tmp_path / "r.h5")
    problem = caught.value.problem
    assert problem.file == str(tmp_path / "r.h5")
    assert f"({dataset} " in problem.message
    assert problem.remedy


@pytest.mark.parametrize("command", some(3, list(COMMANDS)))
def test_every_command_says_so_in_one_line_and_exits_with_2(command: str, hinge: bytes, tmp_path: Path) -> None:
    for name in ("r.h5", "good.h5"):
        (tmp_path / name).write_bytes(hinge)
    with editing(tmp_path / "r.h5") as file:
        EDITS["a patch beyond"][0](file)
    ran = ran_here(*COMMANDS[command], cwd=tmp_path)
    assert ran.returncode == 2, ran.stdout + ran.stderr
    assert "r.h5" in ran.stderr
    assert "joints/patches" in ran.stderr
    assert "Traceback" not in ran.stderr
    assert "internal" not in ran.stderr


@pytest.mark.parametrize("manifest", [MANIFEST, HINGE], ids=lambda path: path.stem)
def test_every_array_of_numbers_has_its_form(manifest: Path, derive_design, tmp_path: Path) -> None:
    results.write(derive_design(manifest), tmp_path / "r.h5")
    arrays: list[str] = []

    def note(name: str, item: object) -> None:
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu":
            arrays.append(name)

    with h5py.File(tmp_path / "r.h5") as file:
        file.visititems(note)
    known = {*schema.ARRAYS, *schema.RAGGED, *(f"{name}_offset" for name in schema.RAGGED)}
    assert arrays
    assert [name for name in arrays if name not in known] == []


@pytest.mark.parametrize(("colour", "good"), [(b"#00fF0a", True), (b"//", False), (b"#12345", False), (b"red", False)])
def test_a_colour_is_six_digits(colour: bytes, good: bool, hinge: bytes, tmp_path: Path) -> None:
    """Exports read it as numbers, the page puts it into a style."""
    (tmp_path / "r.h5").write_bytes(hinge)
    with editing(tmp_path / "r.h5") as file:
        _cell("assembly/parts", "colour", colour)(file)
    if good:
        assert colour.decode() in {part.colour for part in results.read(tmp_path / "r.h5").assembly.parts}
        return
    with pytest.raises(ResultsError) as caught:
        results.read(tmp_path / "r.h5")
    assert "(assembly/parts.colour " in caught.value.problem.message


@pytest.mark.parametrize("case", ["an axis whose square is no number", "a vertex whose square is no number"])
def test_numbers_have_squares(case: str, hinge: bytes, tmp_path: Path) -> None:
    edit, dataset = EDITS[case]
    (tmp_path / "r.h5").write_bytes(hinge)
    with editing(tmp_path / "r.h5") as file:
        edit(file)
    with pytest.raises(ResultsError) as caught:
        results.read(tmp_path / "r.h5")
    assert f"({dataset} " in caught.value.problem.message


def test_the_largest_number_stays_where_a_description_states_no_bound_by_it(tmp_path: Path) -> None:
    most = 1.7976931348623157e308
    links = "".join(f'<link name="{k}"><visual><geometry><box size="1 1 1"/></geometry></visual></link>' for k in "ab")
    limit = f'<limit lower="-{most}" upper="{most}" effort="{most}" velocity="{most}"/>'
    joint = f'<joint name="j" type="prismatic"><parent link="a"/><child link="b"/>{limit}</joint>'
    (tmp_path / "a.urdf").write_text(f'<robot name="r">{links}{joint}</robot>')
    results.write(stages.import_(tmp_path / "a.urdf"), tmp_path / "r.h5")
    (description,) = results.read(tmp_path / "r.h5").assembly.descriptions
    (found,) = description.joints
    assert (found.limits, found.effort, found.speed) == ((-most, most), most, most)

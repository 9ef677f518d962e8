"""The results file as other programs see it: groups, units, plain tables, and names that are data."""

from __future__ import annotations

import io
import re
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from support.hostile import DESIGN, REPORT
from support.places import FIXTURES

from kinform import results
from kinform.design import Design
from kinform.function import designers_joints, resolve_joint
from kinform.model.findings import Witness
from kinform.reports.values.runs import simulation_values
from kinform.results.groups import findings
from kinform.results.held import hold
from kinform.results.records import columns_of, hint

GROUPS = {
    "assembly", "surfaces", "contacts", "constraints", "joints", "mobility", "mass", "behaviour", "simulation",
    "findings",
}  # fmt: skip


@pytest.fixture(scope="module")
def design(derive_design) -> Design:
    return derive_design(FIXTURES / "seekers/seeker_2dof/seeker_2dof.toml")


@pytest.fixture(scope="module")
def file(design: Design) -> h5py.File:
    return h5py.File(io.BytesIO(results.to_bytes(design)), "r")


def _datasets(file: h5py.File) -> dict[str, h5py.Dataset]:
    found = {}
    file.visititems(lambda name, item: found.update({name: item}) if isinstance(item, h5py.Dataset) else None)
    return found


def test_the_root_says_schema_and_version_and_every_group_schema_and_fingerprint(file: h5py.File) -> None:
    assert file.attrs["schema"] == "kinform/results/3"
    assert re.fullmatch(r"\d+\.\d+.*", file.attrs["kinform"])
    assert set(file) == GROUPS
    for name, group in file.items():
        assert group.attrs["schema"] == f"kinform/results/3/{name}"
        assert re.fullmatch("[0-9a-f]{64}", group.attrs["fingerprint"])


def test_every_dataset_has_units_and_every_table_one_per_column(file: h5py.File) -> None:
    for name, dataset in _datasets(file).items():
        units = dataset.attrs["units"]
        if dataset.dtype.names:
            assert len(units) == len(dataset.dtype.names), name
        else:
            assert isinstance(units, str), name


def test_tables_hold_one_scalar_per_column_so_that_data_frames_take_them(file: h5py.File) -> None:
    tables = {name: dataset for name, dataset in _datasets(file).items() if dataset.dtype.names}
    assert len(tables) > 20
    for name, table in tables.items():
        assert table.ndim == 1, name
        for column in table.dtype.names:
            field = table.dtype[column]
            assert field.shape == (), (name, column)
            assert field.kind in "ifb" or h5py.check_string_dtype(field).encoding == "utf-8", (name, column)


def test_numbers_are_little_endian_and_nothing_is_compressed_or_dated(file: h5py.File) -> None:
    for name, dataset in _datasets(file).items():
        kinds = [dataset.dtype[c] for c in dataset.dtype.names] if dataset.dtype.names else [dataset.dtype]
        assert all(kind.newbyteorder("<") == kind for kind in kinds), name
        assert dataset.compression is None
        assert h5py.h5g.get_objinfo(dataset.id).mtime == 0


def test_names_are_data_never_paths(design: Design) -> None:
    part = design.assembly.parts[0]
    odd = replace(design.assembly, parts=(replace(part, name="../é [m6]"), *design.assembly.parts[1:]))
    file = h5py.File(io.BytesIO(results.to_bytes(Design(odd))), "r")
    names: list[str] = []
    file.visit(names.append)
    assert all(re.fullmatch(r"[A-Za-z0-9_/]+", name) for name in names)
    assert file["assembly/parts"][0]["name"].decode() == "../é [m6]"


def test_meshes_are_in_the_file(design: Design, file: h5py.File) -> None:
    (at,) = np.nonzero(file["assembly/parts"]["name"] == b"camera")[0]
    mesh = file["assembly/parts"][at]["mesh"]
    start, end = file["assembly/vertices_offset"][mesh : mesh + 2]
    expected = design.assembly.part("camera").mesh
    np.testing.assert_array_equal(file["assembly/vertices"][start:end], expected.vertices)


def test_constraints_are_csr_with_the_origin_of_each_row(design: Design, file: h5py.File) -> None:
    scipy_sparse = pytest.importorskip("scipy.sparse")
    group, contacts = file["constraints"], design.contacts
    rows, bodies = group["rows"][()], len(group["bodies"])
    J = scipy_sparse.csr_array(
        (group["data"][()], group["indices"][()], group["indptr"][()]), shape=(len(rows), 6 * bodies)
    )
    assert len(rows) > 0
    centre = np.array([group["scaling"][0][f"centre_{axis}"] for axis in "xyz"])
    length = group["scaling"][0]["length"]
    body_of = {part: body.name for body in design.kinematics.bodies for part in body.parts}
    order = [name.decode() for name in group["bodies"][()]]
    for r in range(0, len(rows), 97):
        patch = contacts.patches[rows[r]["patch"]]
        assert (rows[r]["part_a"].decode(), rows[r]["part_b"].decode()) == patch.parts
        point, normal = patch.points[rows[r]["sample"]], patch.normals[rows[r]["sample"]]
        screw = np.concatenate([np.cross(point - centre, normal) / length, normal])
        dense = J[[r]].toarray().reshape(bodies, 6)
        a, b = (order.index(body_of[part]) for part in patch.parts)
        scale = np.abs(dense[b]).max()
        np.testing.assert_allclose(dense[b] / scale, screw / np.abs(screw).max(), atol=1e-9)
        np.testing.assert_allclose(dense[a], -dense[b], atol=1e-9)


def test_the_simulation_has_the_names_and_shapes_of_the_contract(design: Design, file: h5py.File) -> None:
    group = file["simulation"]
    T, B, n = len(group["time"]), len(group["body_names"]), group["joint_offset"][-1]
    assert T > 1
    assert group["p_WB"].shape == (T, B, 3)
    assert group["q_WB"].shape == (T, B, 4)
    for name in ("joint_position", "joint_velocity", "joint_effort"):
        assert group[name].shape == (T, n)
    assert len(group["joint_names"]) == len(group["joint_offset"]) - 1
    assert len(group["energy"]) == len(group["monitors"]) == T
    np.testing.assert_allclose(np.linalg.norm(group["q_WB"], axis=2), 1.0, atol=1e-12)


def test_a_value_that_is_not_known_reads_as_nan_and_a_count_as_minus_one(design: Design) -> None:
    bare = replace(design.assembly.parts[0], density=None, mesh=None)
    file = h5py.File(io.BytesIO(results.to_bytes(Design(replace(design.assembly, parts=(bare,))))), "r")
    row = file["assembly/parts"][0]
    assert np.isnan(row["density"])
    assert row["mesh"] == -1


def test_parts_of_one_mesh_share_it_after_reading(design: Design, tmp_path: Path) -> None:
    results.write(design, tmp_path / "r.h5")
    assembly = results.read(tmp_path / "r.h5").assembly
    assert assembly.part("yaw_motor/stator").mesh is assembly.part("pitch_motor/stator").mesh


@pytest.fixture(scope="module")
def driven(derive_design) -> Design:
    """A run with its own joint called by the designer, about the axis turned round."""
    design = derive_design(FIXTURES / "mechanisms/slider_crank/slider_crank.toml")
    joints = tuple(
        joint if joint.axis is None else replace(joint, axis=-joint.axis) for joint in design.assembly.function.joints
    )
    function = replace(design.assembly.function, joints=joints)
    return replace(design, assembly=replace(design.assembly, function=function))


def test_a_run_in_a_file_has_the_designers_names_and_signs(driven: Design) -> None:
    assert driven.kinematics is not None
    assert driven.simulation is not None
    known = designers_joints(driven.assembly, driven.kinematics)
    file = h5py.File(io.BytesIO(results.to_bytes(driven)), "r")["simulation"]
    derived = [name.decode() for name in file["derived_joints"][()]]
    assert tuple(derived) == driven.simulation.joint_names
    named = [known[name].name if name in known else name for name in derived]
    assert [name.decode() for name in file["joint_names"][()]] == named != derived
    assert -1 in file["joint_signs"][()]
    signs = np.repeat(file["joint_signs"][()], np.diff(file["joint_offset"][()]))
    np.testing.assert_array_equal(file["joint_position"][()] * signs, driven.simulation.joint_position)


def test_a_run_whose_joints_are_called_otherwise_comes_back(driven: Design, tmp_path: Path) -> None:
    results.write(driven, tmp_path / "r.h5")
    again, run = results.read(tmp_path / "r.h5").simulation, driven.simulation
    assert again is not None
    assert run is not None
    assert again.joint_names == run.joint_names
    assert [use.joint for use in again.drives] == [use.joint for use in run.drives]
    for name in ("joint_position", "joint_velocity", "joint_effort", "joint_acceleration"):
        assert getattr(again, name).tobytes() == getattr(run, name).tobytes()


def test_json_keeps_the_derived_joint_and_adds_the_designers_name_and_sense(driven: Design) -> None:
    assert driven.kinematics is not None
    assert driven.simulation is not None
    known = designers_joints(driven.assembly, driven.kinematics)
    told = {item["name"]: item for item in simulation_values(driven)["joints"]}
    senses = set()
    for k, name in enumerate(driven.simulation.joint_names):
        item = told[str(name)]
        values = driven.simulation.joint_position[:, driven.simulation.joint_offset[k]]
        assert (item["start"], item["end"]) == (values[0], values[-1])
        assert item["intended_name"] == known[name].name
        sign = resolve_joint(driven.assembly, driven.kinematics, known[name].name).sign
        senses.add(sign)
        assert item["intended_position"]["end"] == sign * values[-1]
        assert item["intended_position"]["highest"] == (sign * values).max()
    assert -1.0 in senses


def test_findings_of_files_from_before_there_were_witnesses_are_read() -> None:
    later = {label for column in columns_of(hint(Witness)) for label in column.labels}
    with h5py.File(io.BytesIO(), "w") as file:
        findings.write(file.create_group("findings"), replace(DESIGN, report=REPORT))
        assert findings.read(hold(file).group("findings")) == REPORT
        for name in ("findings/findings", "findings/ignored"):
            table, units = file[name][()], file[name].attrs["units"]
            dtype, labels = file[name].dtype, table.dtype.names
            kept = [label for label in labels if label not in later]
            assert len(kept) == len(labels) - len(later)
            older = np.zeros(len(table), [(label, dtype[label]) for label in kept])
            for label in kept:
                older[label] = table[label]
            del file[name]
            made = file.create_dataset(name, data=older)
            made.attrs["units"] = [unit for label, unit in zip(labels, units, strict=True) if label in kept]
        read = findings.read(hold(file).group("findings"))
    assert read.findings == tuple(replace(finding, witness=None) for finding in REPORT.findings)
    assert read.ignored == REPORT.ignored

"""Twins of sound assemblies, each with one cause: it is found, with its vector or factor, and nothing else is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from random_assemblies.draw import Draw
from random_assemblies.machines import machine
from support.solids import block, box, rod

from kinform import stages
from kinform.consistency import adopt, check, with_baseline
from kinform.form import from_meshes


def placed(solids):
    """Meshes about the middles of their boxes, with poses (mm)."""
    out = {}
    for name, solid in solids.items():
        made = solid.to_mesh64()
        mesh = trimesh.Trimesh(np.asarray(made.vert_properties)[:, :3], np.asarray(made.tri_verts), process=False)
        X = np.eye(4)
        X[:3, 3] = mesh.bounds.mean(axis=0)
        out[name] = (trimesh.Trimesh(mesh.vertices - X[:3, 3], mesh.faces, process=False), X)
    return out


def report_of(parts, units="mm"):
    return check(stages.joints(stages.contacts(stages.import_assembly(from_meshes(parts, units=units)))))


def shifted(parts, name, vector):
    mesh, X = parts[name]
    X = X.copy()
    X[:3, 3] += vector
    return parts | {name: (mesh, X)}


def scaled(parts, name, factor):
    mesh, X = parts[name]
    return parts | {name: (trimesh.Trimesh(np.asarray(mesh.vertices) * factor, mesh.faces, process=False), X)}


def serious(report):
    return [finding for finding in report.findings if finding.severity != "note"]


def causes(report):
    return [finding for finding in report.findings if finding.cause is not None]


def hinge():
    """Two leaves with knuckles in turn, and a pin with heads."""
    bore, knuckle = rod(2.5, -40, 40, 64), lambda low, high: rod(5.0, low, high, 64)
    sides = knuckle(-30, -10.3) + knuckle(10.3, 30)
    upright = lambda solid: solid.rotate((90, 0, 0))
    left = (upright(knuckle(-10, 10)) + box(-40, -2, -10, 10, -2, 2) + box(-40, -6, -30, 30, -2, 2)) - upright(bore)
    right = upright(sides) + box(6, 40, -30, 30, -2, 2) + box(2, 8, -30, -10.3, -2, 2) + box(2, 8, 10.3, 30, -2, 2)
    pin = upright(rod(2.5, -30, 30, 64) + rod(4.0, -33, -30, 64) + rod(4.0, 30, 33, 64))
    return placed({"left": left, "right": right - upright(bore), "pin": pin})


MACHINES = {seed: placed(machine(Draw([seed, 77]), decks=2).solids) for seed in (3, 4, 8)}


@pytest.mark.parametrize("seed", MACHINES)
def test_a_sound_machine_states_no_cause(seed):
    report = report_of(MACHINES[seed])
    assert not serious(report) and not causes(report) and not report.members


@pytest.mark.parametrize(
    ("seed", "name", "vector"),
    [(3, "inner_0", (-1.06, 0, 0)), (4, "deck_1_0", (0, 2.54, 0)), (8, "deck_1_0", (0.5, -2.51, 0))],
)
def test_a_part_that_was_moved_is_one_finding_with_the_way_back(seed, name, vector):
    report = report_of(shifted(MACHINES[seed], name, vector))
    (found,) = serious(report)
    assert (found.cause.kind, found.subject) == ("displaced", (name,))
    assert found.cause.shift == pytest.approx(-1e-3 * np.array(vector), abs=2e-6)
    members = report.members_of(found)
    assert found.code == "KF201" and {member.cause for member in members} == {found.cause}
    assert found.severity == max((m.severity for m in members), key=["note", "warning", "error"].index)


@pytest.mark.parametrize("angles", [(0, 0, 0), (20, -50, 110)])
def test_the_way_back_turns_with_the_assembly(angles):
    from scipy.spatial.transform import Rotation

    R = Rotation.from_euler("xyz", angles, degrees=True).as_matrix()
    turned = {}
    for name, (mesh, X) in shifted(hinge(), "right", (0, 0, 0.8)).items():
        Y = np.eye(4)
        Y[:3, :3], Y[:3, 3] = R @ X[:3, :3], R @ X[:3, 3] + (5.0, 3.0, 1.0)
        turned[name] = (mesh, Y)
    (found,) = serious(report_of(turned))
    assert found.cause.kind == "displaced" and found.subject == ("right",)
    assert found.cause.shift == pytest.approx(R @ (0, 0, -8e-4), abs=1e-6)


@pytest.mark.parametrize("factors", [(1.15, 1, 1), (1, 1.15, 1), (1, 1, 1.15)])
@pytest.mark.parametrize("name", ["pin", "left"])
def test_a_part_of_the_wrong_shape_is_not_displaced(name, factors):
    mesh, X = hinge()[name]
    other = trimesh.Trimesh(np.asarray(mesh.vertices) * factors, mesh.faces, process=False)
    report = report_of(hinge() | {name: (other, X)})
    assert {finding.cause.kind for finding in causes(report)} <= {"repeated"}


def test_a_block_too_far_in_is_not_displaced():
    """One plane says how far a block is in the other, and nothing that it should not be longer."""
    parts = placed({"table": block(40, 40, 10), "block": block(10, 10, 10).translate((0, 0, 9.0))})
    assert [f.cause for f in serious(report_of(parts))] == [None]


@pytest.mark.parametrize("factor", [25.4, 1 / 25.4, 1000.0, 0.001])
def test_a_mesh_of_another_unit_is_one_finding_with_its_factor(factor):
    (found,) = serious(report_of(scaled(hinge(), "pin", factor)))
    assert (found.cause.kind, found.subject) == ("scaled", ("pin",))
    assert found.cause.scale == pytest.approx(1.0 / factor)


@pytest.mark.parametrize("names", [("pin",), ("pin", "left", "right")])
def test_parts_that_are_there_twice_are_one_finding(names):
    report = report_of(hinge() | {f"{name}_copy": hinge()[name] for name in names})
    (found,) = serious(report)
    assert found.cause.kind == "duplicated"
    assert {name for name in found.subject if name.endswith("_copy")} == {f"{name}_copy" for name in names}
    assert [f.code for f in report.members_of(found)].count("KF201") >= len(names)


@pytest.mark.parametrize("seed", MACHINES)
def test_parts_at_their_own_origins_are_one_finding(seed):
    report = report_of({name: (mesh, np.eye(4)) for name, (mesh, _) in MACHINES[seed].items()})
    (found,) = serious(report)
    assert found.cause.kind == "unplaced" and set(found.subject) == set(MACHINES[seed])
    assert len(report.members) > len(MACHINES[seed])


@pytest.mark.parametrize("axis", [1, 2])
def test_parts_on_a_print_plate_are_one_finding(axis):
    parts, far = {}, 0.0
    for name, (mesh, _) in MACHINES[4].items():
        X = np.eye(4)
        X[axis, 3] = -mesh.bounds[0, axis]
        X[0, 3] = far - mesh.bounds[0, 0]
        far += float(np.ptp(mesh.bounds[:, 0])) + 7.0
        parts[name] = (mesh, X)
    (found,) = serious(report_of(parts))
    assert found.cause.kind == "laid out" and set(found.subject) == set(parts)
    assert "plate" in found.message


def comb(count, deep=0.1):
    """A bar with holes, and as many pins that are too thick."""
    bar, pins = box(-10, 10 * count, -5, 5, -3, 3), {}
    for k in range(count):
        bar -= rod(2.0, -5, 5, 48).translate((10.0 * k, 0, 0))
        pins[f"pin_{k}"] = rod(2.0 + deep, -4, 4, 48).translate((10.0 * k, 0, 0))
    return placed({"bar": bar, **pins})


def test_the_same_overlap_many_times_is_one_finding_and_stays_with_a_baseline():
    report = report_of(comb(5))
    (found,) = serious(report)
    assert found.cause.kind == "repeated" and found.code == "KF201"
    assert [m.code for m in report.members_of(found)].count("KF201") == 5 and found.found.startswith("5 times")
    # a baseline adopts its members one by one
    baseline = adopt(report)
    assert len([key for key in baseline.keys if key[0] == "KF201"]) == 5
    left, gone = with_baseline(report, baseline)
    assert not serious(left) and not left.members and not gone
    fewer = adopt(report_of(comb(4)))
    assert [f.cause and f.cause.kind for f in serious(with_baseline(report, fewer)[0])] == ["repeated"]


def test_parts_of_two_shapes_are_two_findings():
    parts = comb(5)
    thick = {name: scaled(parts, name, 1.02)[name] for name in ("pin_3", "pin_4")}
    report = report_of(parts | thick)
    assert sorted(f.found[:7] for f in serious(report)) == ["2 times", "3 times"]


def test_a_finding_that_is_ignored_is_no_member():
    from kinform.model.checks import Ignore

    design = stages.joints(stages.contacts(stages.import_assembly(from_meshes(comb(4), units="mm"))))
    ignore = Ignore("KF201", "pin_1", "meant", "", None)
    settings = replace(design.assembly.check, ignore=(ignore,))
    report = check(replace(design, assembly=replace(design.assembly, check=settings)))
    (found,) = serious(report)
    assert found.found.startswith("3 times") and [i.finding.subject for i in report.ignored] == [("bar", "pin_1")]

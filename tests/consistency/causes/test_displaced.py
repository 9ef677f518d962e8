"""Twins of a description in which one thing is in a wrong place or size: what has to be written there is stated."""

from __future__ import annotations

import re

import numpy as np
import pytest
from support.solids import box, rod, save

from kinform import stages
from kinform.consistency import check
from kinform.consistency.causes.displaced import Motion, explains
from kinform.consistency.causes.movable import Movable
from kinform.model.findings import Finding
from kinform.reports import render

SOLIDS = {
    "base": box(-40, 40, -40, 40, 0, 20) + rod(8, 20, 32, 64) + rod(12, 32, 36, 64),
    "upper": box(-14, 114, -14, 14, 20, 32) - rod(8, 0, 40, 64) + rod(6, 32, 44, 64).translate((100, 0, 0)),
    "fore": (box(90, 190, -10, 10, 32, 44) - rod(6, 0, 60, 64).translate((100, 0, 0))),
}
"""As they stand in the world, mm."""
FRAMES = {"base": (0.0, 0.0, 0.0), "upper": (0.0, 0.0, 0.02), "fore": (0.1, 0.0, 0.032)}


def urdf(tmp_path, origins=None, visuals=None, scales=None, rolled=0.0):
    """The arm, each mesh in the frame of its link; what is given stands instead."""
    origins = {"upper": "0 0 0.02", "fore": "0.1 0 0.012"} | (origins or {})
    links = joints = ""
    for name, solid in SOLIDS.items():
        save(solid.translate([-1e3 * x for x in FRAMES[name]]), tmp_path / f"{name}.stl")
        place, factor = (visuals or {}).get(name, "0 0 0"), (scales or {}).get(name, 0.001)
        links += (
            f'<link name="{name}"><visual><origin xyz="{place}" rpy="0 0 0"/><geometry><mesh filename="{name}.stl" '
            f'scale="{factor} {factor} {factor}"/></geometry></visual></link>\n'
        )
    for child, parent in (("upper", "base"), ("fore", "upper")):
        joints += (
            f'<joint name="to_{child}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="{origins[child]}" rpy="0 0 {rolled if child == "fore" else 0}"/><axis xyz="0 0 1"/>'
            '<limit lower="-1" upper="1" effort="5" velocity="3"/></joint>\n'
        )
    path = tmp_path / "arm.urdf"
    path.write_text(f'<robot name="arm">{links}{joints}</robot>')
    return path


def design_of(path):
    return stages.joints(stages.contacts(stages.import_(path)))


def cause_of(path):
    """The finding that states the only cause."""
    (found,) = [finding for finding in check(design_of(path)).findings if finding.severity != "note"]
    assert found.cause is not None
    return found


def test_a_right_description_states_no_cause(tmp_path):
    report = check(design_of(urdf(tmp_path)))
    assert not report.members and all(finding.cause is None for finding in report.findings)
    assert dict(report.answers) == {"agrees": 2} or "not held" in dict(report.answers)


@pytest.mark.parametrize("wrong", ["0.1 0.013 0.012", "0.094 0 0.012"])
def test_the_origin_of_a_joint_is_stated_as_it_should_be(tmp_path, wrong):
    found = cause_of(urdf(tmp_path, origins={"fore": wrong}))
    assert (found.cause.kind, found.subject) == ("displaced", ("fore",))
    shift = [right - float(value) for right, value in zip((0.1, 0.0, 0.012), wrong.split(), strict=True)]
    assert found.cause.shift == pytest.approx(shift, abs=2e-6)
    assert '<origin xyz="0.1 0 0.012" rpy="0 0 0"/>' in found.remedy


@pytest.mark.parametrize("rolled", [0.0, 0.7])
def test_a_mesh_in_the_frame_of_the_assembly_is_said_to_be(tmp_path, rolled):
    path = urdf(tmp_path, rolled=rolled)
    save(SOLIDS["fore"], tmp_path / "fore.stl")
    found = cause_of(path)
    assert (found.cause.kind, found.subject) == ("frame", ("fore",))
    assert found.cause.shift == pytest.approx((-0.1, 0.0, -0.032), abs=1e-6)
    # what it says to write makes the description right
    (origin,) = re.findall(r'<origin xyz="[^"]*" rpy="[^"]*"/>', found.remedy.partition("Or")[0])
    head, tail = path.read_text().split('<link name="fore">')
    path.write_text(head + '<link name="fore">' + tail.replace('<origin xyz="0 0 0" rpy="0 0 0"/>', origin, 1))
    assert not check(design_of(path)).members


@pytest.mark.parametrize("factor", [0.0254, 1.0])
@pytest.mark.parametrize("names", [("fore",), tuple(SOLIDS)])
def test_a_scale_is_stated_as_it_should_be(tmp_path, factor, names):
    found = cause_of(urdf(tmp_path, scales=dict.fromkeys(names, factor)))
    assert found.cause.kind == "scaled" and found.cause.scale == pytest.approx(0.001 / factor)
    assert 'scale="0.001 0.001 0.001"' in found.remedy
    assert len(found.subject) == len(names)


def test_a_gap_that_a_part_of_no_mesh_would_fill_is_no_cause(tmp_path):
    report = check(design_of(urdf(tmp_path, origins={"fore": "0.1 0 0.026"})))
    assert all(finding.cause is None for finding in report.findings)


def test_members_are_told_where_there_is_room(tmp_path):
    path = urdf(tmp_path, scales=dict.fromkeys(SOLIDS, 1.0))
    design = design_of(path)
    report = check(design)
    (found,) = [finding for finding in report.findings if finding.cause is not None]
    brief, full, text = (render(report, design, format) for format in ("brief", "full", "json"))
    codes = {member.code for member in report.members_of(found)} - {found.code}
    assert codes and all(code in full and code in text for code in codes)
    assert not any(code in brief for code in codes)


@pytest.mark.parametrize(
    ("codes", "confirmed", "cause"),
    [(["KF407"], True, False), (["KF407"] * 3, True, False), (["KF201"], True, True), (["KF201"], False, False),
     (["KF201", "KF407"], False, True)],
)  # fmt: skip
def test_what_a_motion_resolves_has_to_tell_that_the_part_is_in_a_wrong_place(codes, confirmed, cause):
    """Contact that is not meant vanishes wherever the part goes, and so does one overlap."""
    motion = Motion(Movable("crank", frozenset({"crank"})), np.eye(4), confirmed=confirmed)
    resolved = tuple(Finding(code, "rule", "warning", ("crank", "yoke"), "…") for code in codes)
    assert explains(motion, resolved) == cause

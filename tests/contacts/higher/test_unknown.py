"""Parts that come as near each other as parts that touch do, in a way that is no contact that is known (KF209): it is
said, and denies nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold
from support.assemblies import assembly
from support.diagonal import diagonal, first
from support.solids import part, random_pose

from kinform import contacts, kinematics, surfaces
from kinform.consistency import check
from kinform.design import Design


def ellipsoid(segments=48):
    return Manifold.sphere(10, segments).scale((1, 0.7, 0.5))


def plate():
    return Manifold.cube((40, 40, 4), True).translate((0, 0, -2))


def cube(side=5):
    return Manifold.cube((side, side, side), True)


def edge_on_shaft(gap=0.0):
    """A cube that stands with an edge across the side of a lying shaft of radius 6, askew."""
    turned = cube().rotate((0, 45, 0)).rotate((0, 0, 30)).translate((0, 0, 5 / np.sqrt(2) + 6 + gap))
    return turned, Manifold.cylinder(30, 6, 6, 96, True).rotate((90, 0, 0))


def design_of(X=None, scale=1e-3, groups=(), **solids):
    X = np.eye(4) if X is None else X
    made = assembly(*(part(name, solid, X, scale) for name, solid in solids.items()), groups=groups)
    found = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    touching = contacts.find(made, found)
    derived = kinematics.derive(made, found, touching)
    return Design(assembly=made, surfaces=found, contacts=touching, kinematics=derived)


UNKNOWN = {
    "freeform on a plane": lambda gap: (ellipsoid().translate((0, 0, 5 + gap)), plate()),
    "an edge on a shaft": edge_on_shaft,
    "edges side by side": lambda gap: (cube(), cube().translate((5 + gap, 5, 0))),
    "corners": lambda gap: (cube(), cube().translate((5 + gap, 5, 5))),
}


def unknown(made):
    return [patch for patch in made.contacts.patches if patch.unknown]


@diagonal(name=list(UNKNOWN), gap=[1e-6, 0.002, 0.008])
def test_parts_that_touch_in_an_unknown_way_are_in_doubt_and_not_free(name, gap):
    first, second = UNKNOWN[name](gap)
    made = design_of(a=first, b=second)
    (patch,) = unknown(made)
    assert patch.parts == ("a", "b")
    assert patch.gap == pytest.approx(gap * 1e-3, abs=1e-8)
    (joint,) = made.kinematics.joints
    assert joint.status == "ambiguous"
    report = check(made)
    (finding,) = (f for f in report.findings if f.code == "KF209")
    assert finding.severity == "warning"
    assert finding.subject == ("a", "b")
    assert finding.place == pytest.approx(patch.point)
    assert not [f for f in report.findings if f.code == "KF203"]
    assert next(rule for rule in report.rules if rule.code == "KF203").outcome == "inconclusive"


@diagonal(name=list(UNKNOWN), gap=[0.2, 1.0])
def test_parts_farther_apart_than_that_touch_nothing(name, gap):
    first, second = UNKNOWN[name](gap)
    made = design_of(a=first, b=second)
    assert not made.contacts.patches
    assert not made.kinematics.joints
    codes = {finding.code for finding in check(made).findings}
    assert "KF203" in codes
    assert "KF209" not in codes


@diagonal(name=list(UNKNOWN), seed=range(3))
def test_neither_pose_nor_size_nor_names_change_it(name, seed):
    rng = np.random.default_rng(seed)
    scale = 1e-3 if seed == 0 else 10.0 ** rng.uniform(-4, -2)
    X = random_pose(rng, 10 * scale)
    gap = 1e-4
    first, second = UNKNOWN[name](gap)
    for names in (("a", "b"), ("b", "a")):
        made = design_of(X, scale, **dict(zip(names, (first, second), strict=True)))
        (patch,) = unknown(made)
        assert patch.gap == pytest.approx(gap * scale, abs=1e-3 * gap * scale)
        assert [joint.status for joint in made.kinematics.joints] == ["ambiguous"]


@pytest.mark.parametrize("segments", [24, 48, 96])
def test_how_finely_a_freeform_face_is_meshed_says_nothing(segments):
    made = design_of(a=ellipsoid(segments).translate((0, 0, 5.01)), b=plate())
    (patch,) = unknown(made)
    assert abs(patch.normals[0, 2]) == pytest.approx(1.0, abs=1e-6)
    assert [joint.status for joint in made.kinematics.joints] == ["ambiguous"]


def test_contact_that_is_known_decides_and_the_rest_is_a_note():
    """A shaft in its bore, with a pebble on the shaft that touches the face of the block."""
    solids = {
        "block": Manifold.cube((60, 60, 20), True) - Manifold.cylinder(30, 5, 5, 96, True),
        "shaft": Manifold.cylinder(60, 5, 5, 96, True),
    }
    pebble = ellipsoid().scale((0.5, 0.5, 0.5)).translate((15, 3, 12.51))
    alone = design_of(**solids)
    made = design_of(groups=(("turner", ("pebble", "shaft")),), pebble=pebble, **solids)
    assert [patch.parts for patch in unknown(made)] == [("block", "pebble")]
    assert [(j.type, j.status) for j in alone.kinematics.joints] == [("cylindrical", "determined")]
    assert [(j.type, j.status) for j in made.kinematics.joints] == [("cylindrical", "determined")]
    (finding,) = (f for f in check(made).findings if f.code == "KF209")
    assert finding.severity == "note"


def test_within_one_body_there_is_nothing_to_say():
    first, second = edge_on_shaft(0.001)
    made = design_of(groups=(("both", ("a", "b")),), a=first, b=second)
    assert "KF209" not in {finding.code for finding in check(made).findings}


def test_parts_that_overlap_are_not_said_to_touch_nothing():
    made = design_of(a=ellipsoid(), b=ellipsoid().translate((0, 0, 9)))
    assert made.contacts.interferences
    assert not [f for f in check(made).findings if f.code == "KF203"]


@pytest.mark.parametrize("lean", first(2, [0.0, 2.5, 0.5, 1.0, 2.0]))
def test_an_ellipse_in_a_bore_it_does_not_fit_touches_where_it_is_nearest(lean):
    oval = Manifold.extrude(CrossSection.circle(5, 96).scale((1.4, 1.0)), 10)
    tube = Manifold.cylinder(20, 20, 20, 96) - Manifold.cylinder(20, 7.02, 7.02, 96)
    made = design_of(a=oval.rotate((lean, 0, 0)).translate((0, 0, 4)), b=tube)
    assert made.contacts.patches
    assert all(joint.status == "ambiguous" or joint.freedoms < 6 for joint in made.kinematics.joints)


def test_a_report_without_unknown_contact_passes_the_rule():
    made = design_of(a=cube(), b=cube().translate((0, 0, 5)))
    assert next(rule for rule in check(made).rules if rule.code == "KF209").outcome == "passed"
    other = replace(made, contacts=replace(made.contacts, patches=()))
    assert next(rule for rule in check(other).rules if rule.code == "KF209").outcome == "passed"


def test_parts_that_touch_each_other_alone_are_not_said_to_have_no_contact():
    far = plate().translate((0, 0, 80))
    made = design_of(base=plate(), under=plate().translate((0, 0, -60)), upper=far, on=far.translate((0, 0, 4)))
    assert {len(finding.subject) for finding in check(made).findings if finding.code == "KF203"} == {1, 2}

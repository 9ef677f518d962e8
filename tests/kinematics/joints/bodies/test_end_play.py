"""Twins of the collared pairs: a translation that faces of both bodies end soon, on both sides, is end play."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from generators.profiles import circle, rectangle
from generators.solids import AXIS_X, join, prism, rod, transformed
from manifold3d import CrossSection, Manifold
from support.assemblies import assembly, intended
from support.solids import part, random_pose
from support.touching import touching

from kinform.kinematics import derive
from kinform.kinematics.joints.bodies.end_faces import Outline
from kinform.kinematics.joints.bodies.end_play import MOST_PLAY, EndPlays, without_translation

BLOCK = prism(rectangle(-20, 20, -20, 20), -15, 15, [circle(10.05, 24, 3.7)]).manifold
EYE = transformed(prism(circle(14.0, 30, 1.0), -6.0, 6.0, [circle(5.05, 26, 2.0)]), AXIS_X).manifold


def collared(below, above):
    """A shaft of 20 mm with a collar that stands off each side of `BLOCK` by so much (mm); None: without it."""
    low, high = -15.0 - (below or 0.0), 15.0 + (above or 0.0)
    pieces = [rod(10.0, -40.0, low - 4.0, 32), rod(10.0, low, high, 32), rod(10.0, high + 4.0, 50.0, 32)]
    pieces += [rod(10.0 if below is None else 14.0, low - 4.0, low, 32)]
    pieces += [rod(10.0 if above is None else 14.0, high, high + 4.0, 32)]
    return join(*pieces).manifold


def fork(play):
    """A clevis whose cheeks stand off `EYE` by so much (mm) on each side, on a pin of 10 mm."""
    cheeks = [prism(circle(12.0, 48), *span) for span in ((6.0 + play, 14.0), (-14.0, -6.0 - play))]
    return join(*(transformed(s, AXIS_X) for s in (*cheeks, rod(5.0, -6.0 - play, 6.0 + play, 40, 4.0)))).manifold


def sectors(radius, low, high, wide, start=0.0, count=2, segments=72):
    """So many equal sectors of a rod about z, each `wide` degrees."""
    cut = []
    for k in range(count):
        angles = np.radians(start + 360.0 * k / count + np.linspace(0.0, wide, 9))
        cut.append(np.array([(0.0, 0.0), *(4.0 * radius * np.stack([np.cos(angles), np.sin(angles)], axis=1))]))
    flat = CrossSection([np.array(circle(radius, segments).points)]) ^ CrossSection(cut)
    return Manifold.extrude(flat, high - low).translate((0.0, 0.0, low))


class Scene:
    """Solids under one pose at one scale, with the joint that is found between the two bodies."""

    def __init__(self, X=None, scale=1e-3, groups=(), joints=(), complete=False, change=None, **solids):
        X = np.eye(4) if X is None else X
        parts = [part(name, solid, X, scale) for name, solid in solids.items()]
        made = assembly(*(parts if change is None else map(change, parts)), groups=groups, joints=joints)
        if complete:
            made = replace(made, function=replace(made.function, complete=("",)))
        self.assembly, (self.surfaces, self.contacts) = made, touching(made)
        self.kinematics = derive(made, self.surfaces, self.contacts)
        (self.joint,) = self.kinematics.joints

    @property
    def play(self):
        """What is found of the joint, taken as cylindrical."""
        plays = EndPlays(self.assembly, self.surfaces, self.kinematics.bodies)
        of_joint = [self.contacts.patches[k] for k in self.joint.patches]
        return plays.of(replace(self.joint, type="cylindrical"), of_joint)

    @property
    def found(self):
        return self.joint.type, self.joint.status, self.kinematics.mobility.instantaneous


REVOLUTE, CYLINDRICAL = ("revolute", "determined", 1), ("cylindrical", "determined", 2)


@pytest.mark.parametrize("scale", [1e-4, 1e-3, 1e-2, 1e-1])
@pytest.mark.parametrize("play", [0.1, 0.5, 1.0, 2.0])
def test_twins_of_the_collared_pairs_turn_and_do_nothing_else(play, scale):
    rng = np.random.default_rng([int(10 * play), int(1e5 * scale)])
    for solids in ({"block": BLOCK, "shaft": collared(play, play)}, {"eye": EYE, "fork": fork(play)}):
        scene = Scene(random_pose(rng), scale, **solids)
        assert scene.found == REVOLUTE
        assert scene.joint.freedoms == len(scene.joint.twists) == 1
        assert scene.play.travel == pytest.approx(2.0 * play * scale, rel=1e-6)


def test_each_end_has_its_own_travel_and_its_faces():
    scene = Scene(block=BLOCK, shaft=collared(1.1, 2.1))
    assert scene.found == REVOLUTE
    down, up = scene.play.ends
    # the shaft is the second body: against +z its upper collar comes to the block
    assert (down.travel, up.travel) == (pytest.approx(2.1e-3), pytest.approx(1.1e-3))
    assert down.parts == up.parts == (("block",), ("shaft",))
    assert scene.play.journal == pytest.approx(20.1e-3, rel=1e-3)
    assert "3.2 mm" in scene.joint.reason and "'block' and 'shaft'" in scene.joint.reason


def test_which_body_is_the_first_changes_only_the_order_of_the_ends():
    one = Scene(a=BLOCK, b=collared(1.1, 2.1))
    other = Scene(b=BLOCK, a=collared(1.1, 2.1))
    assert one.found == other.found == REVOLUTE
    assert [end.travel for end in one.play.ends] == pytest.approx([end.travel for end in other.play.ends][::-1])


@pytest.mark.parametrize("ends", [(1.0, None), (None, 1.0), (None, None), (6.0, 6.0), (1.0, 20.0)])
def test_open_on_one_side_or_with_a_longer_travel_it_stays_cylindrical(ends):
    scene = Scene(block=BLOCK, shaft=collared(*ends))
    assert scene.found == CYLINDRICAL and scene.play is None


@pytest.mark.parametrize(("share", "found"), [(0.99, REVOLUTE), (1.01, CYLINDRICAL)])
def test_both_senses_together_count_by_the_journal(share, found):
    most = share * MOST_PLAY * 20.1
    assert Scene(block=BLOCK, shaft=collared(0.2 * most, 0.8 * most)).found == found


def test_other_parts_of_a_body_end_it_too():
    plain = rod(10.0, -40.0, 50.0, 32).manifold
    ring = lambda low, high: prism(circle(13.0, 40), low, high, [circle(10.02, 30)]).manifold
    parts = {"block": BLOCK, "pin": plain, "clip_1": ring(-18.0, -16.0), "clip_2": ring(16.0, 18.0)}
    assert Scene(groups=[("shaft", ["clip_1", "clip_2", "pin"])], **parts).found == REVOLUTE
    assert Scene(groups=[("shaft", ["clip_1", "pin"])], **{k: v for k, v in parts.items() if k != "clip_2"}).found == (
        CYLINDRICAL
    )


def test_a_body_of_many_parts_is_looked_at_where_the_other_may_come():
    frame = {f"stud_{k:02}": rod(2.0, -3.0, 3.0, 12).at(60.0 + 10.0 * k, 30.0, 40.0 * k).manifold for k in range(12)}
    pin = rod(10.0, -40.0, 40.0, 32).manifold
    caps = {"cap_1": rod(15.0, 41.0, 44.0, 40).manifold, "cap_2": rod(15.0, -44.0, -41.5, 40).manifold}
    scene = Scene(groups=[("frame", ["block", *frame, *caps])], block=BLOCK, pin=pin, **frame, **caps)
    assert scene.found == REVOLUTE and scene.play.travel == pytest.approx(2.5e-3)


def test_half_rings_with_a_gap_are_one_face():
    plain = rod(10.0, -40.0, 50.0, 32).manifold
    hollow = rod(10.02, -60.0, 60.0, 30).manifold
    halves = {f"half_{k}{n}": sectors(14.0, *z, 170.0, 180.0 * k + 5.0, 1) - hollow
              for k in (0, 1) for n, z in enumerate(((-18.0, -16.0), (16.0, 18.0)))}  # fmt: skip
    assert Scene(groups=[("shaft", [*halves, "pin"])], block=BLOCK, pin=plain, **halves).found == REVOLUTE


def lathed(points, segments=60):
    """The solid of a closed outline of (r, z) about z."""
    return Manifold.revolve(CrossSection([np.array(points, dtype=float)]), segments)


def wire(radius, at, thick, steps=24):
    """A ring of round wire, `thick` across its section, about z."""
    turn = 2.0 * np.pi * np.arange(steps) / steps
    return lathed(np.stack([radius + 0.5 * thick * np.cos(turn), at + 0.5 * thick * np.sin(turn)], axis=1))


def test_rings_of_round_wire_end_it():
    shaft = rod(10.0, -40.0, 50.0, 60).manifold + wire(10.2, -17.5, 2.0) + wire(10.2, 17.2, 2.0)
    scene = Scene(block=BLOCK, shaft=shaft)
    assert scene.found == REVOLUTE
    # bounded by where the wire stops to look at the wall, at 60 degrees: a quarter of it deeper
    assert 2.7e-3 <= scene.play.travel <= 2.7e-3 + 4 * 0.5e-3


def test_cones_end_it_by_their_whole_height_and_no_less():
    flared = lambda slope: join(
        rod(10.0, -40.0, -20.0, 32), rod(14.0, -20.0, -16.5, 32), rod(10.0, -16.5, 16.5, 32),
    ).manifold + lathed([(0, 16.5), (10.0, 16.5), (14.0, 16.5 + slope), (14.0, 24.0), (0, 24.0)], 32)  # fmt: skip
    scene = Scene(block=BLOCK, shaft=flared(2.0))
    assert scene.found == REVOLUTE and scene.play.travel == pytest.approx(5.0e-3)
    assert Scene(block=BLOCK, shaft=flared(8.0)).found == CYLINDRICAL


@pytest.mark.parametrize(("wide", "found"), [(60.0, CYLINDRICAL), (95.0, REVOLUTE)])
def test_lugs_end_it_only_where_they_never_pass_between_those_of_the_other(wide, found):
    """A bore with two pads of 100 degrees and two reliefs of 80 between them: narrower lugs go through at a quarter
    turn, and a joint that they end at this pose alone would be none at others."""
    hub = rod(20.0, -15.0, 15.0, 64).manifold - sectors(16.0, -20.0, 20.0, 80.0, 10.0)
    hub -= rod(10.05, -20.0, 20.0, 36).manifold
    shaft = rod(10.0, -40.0, 40.0, 48).manifold
    for low in (-20.0, 16.0):
        shaft += sectors(14.0, low, low + 4.0, wide, 140.0 - 0.5 * wide)
    scene = Scene(hub=hub, shaft=shaft)
    assert scene.found == found


def test_facets_of_one_circle_that_cross_end_nothing():
    """A shaft of 32 facets ends in a groove of a bore of 24, of the same radius: outlines of the two cross."""
    groove = rod(12.0, 3.0, 6.0, 48).manifold
    hub = rod(20.0, -15.0, 15.0, 64).manifold - rod(10.0, -20.0, 20.0, 24, 3.7).manifold - groove
    shaft = rod(10.0, -25.0, 5.0, 32).manifold + rod(14.0, -20.0, -16.0, 32).manifold
    scene = Scene(hub=hub, shaft=shaft)
    assert scene.joint.type == "cylindrical" and scene.play is None


@pytest.mark.parametrize("stated", ["cylindrical", "prismatic"])
def test_a_stated_motion_along_the_axis_stays_and_the_other_reading_is_kept(stated):
    joints = [intended("stroke", "block", "shaft", stated)]
    scene = Scene(joints=joints, block=BLOCK, shaft=collared(1.0, 1.0))
    assert scene.joint.type == "cylindrical" and scene.kinematics.mobility.instantaneous == 2
    assert [reading.type for reading in scene.joint.readings] == ["revolute"]
    across = [intended("stroke", "block", "shaft", stated, axis=(1, 0, 0))]
    assert Scene(joints=across, block=BLOCK, shaft=collared(1.0, 1.0)).found == REVOLUTE


@pytest.mark.parametrize("complete", [False, True])
def test_a_stated_rotation_is_what_contact_determines(complete):
    joints = [intended("hinge", "block", "shaft", "revolute")]
    scene = Scene(joints=joints, complete=complete, block=BLOCK, shaft=collared(1.0, 1.0))
    assert scene.found == REVOLUTE and not scene.joint.readings
    # without its collars contact leaves more than is stated, which is taken as stated
    loose = Scene(joints=joints, complete=complete, block=BLOCK, shaft=collared(None, None)).joint
    assert (loose.type, loose.status) == (("revolute", "stated") if complete else ("cylindrical", "determined"))


def test_a_stated_stroke_of_a_complete_function_stays():
    joints = [intended("stroke", "block", "shaft", "prismatic")]
    scene = Scene(joints=joints, complete=True, block=BLOCK, shaft=collared(1.0, 1.0))
    assert (scene.joint.type, scene.joint.status) == ("prismatic", "stated")


def test_a_journal_between_bottom_and_cap_is_no_piston():
    """On the bottom of its bore it may be a piston as well; under a cap with 1 mm to spare it is a pivot."""
    cup = rod(16.0, -20.0, 20.0, 64).manifold - rod(10.05, -15.0, 30.0, 36).manifold
    pivot = rod(10.0, -15.0, 19.0, 32).manifold + rod(4.0, 19.0, 40.0, 32).manifold
    cap = prism(circle(16.0, 64), 20.0, 23.0, [circle(6.0, 32)]).manifold
    assert Scene(cup=cup, pivot=pivot).joint.status == "ambiguous"
    assert Scene(groups=[("housing", ["cap", "cup"])], cap=cap, cup=cup, pivot=pivot).found == REVOLUTE


def test_scattered_vertices_change_nothing():
    rng = np.random.default_rng(5)

    def worn(one):
        off = 2e-6 * rng.normal(size=one.mesh.vertices.shape)
        return replace(one, mesh=replace(one.mesh, vertices=one.mesh.vertices + off, digest=one.mesh.digest[::-1]))

    scene = Scene(change=worn, block=BLOCK, shaft=collared(1.0, 1.5))
    assert scene.joint.type == "revolute"
    assert scene.play.travel == pytest.approx(2.5e-3, abs=2e-5)


def test_faces_that_end_the_play_of_two_journals_hold_nothing_twice():
    bores = [(-48.0, 10.05), (40.0, 8.05)]
    plates = [prism(rectangle(-20, 20, -30, 20), z, z + 8.0, [circle(bore, 24)]) for z, bore in bores]
    frame = join(prism(rectangle(-20, 20, -40, -30), -48.0, 48.0), *plates).manifold

    def shaft(play):
        ends = (-70.0, -52.0 - play, -48.0 - play, 0.0, 48.0 + play, 52.0 + play, 70.0)
        return join(*map(rod, (10, 14, 10, 8, 14, 8), ends, ends[1:], [32] * 6)).manifold

    near, loose = (Scene(frame=frame, shaft=shaft(play)) for play in (0.05, 2.0))
    assert near.found == loose.found == REVOLUTE
    # each site holds four directions, and with its collar in contact the axial one as well
    for scene, twice in ((near, 5), (loose, 4)):
        (within,) = (one for one in scene.kinematics.mobility.redundancies if one.kind == "pair")
        assert within.rows == twice


@pytest.mark.parametrize("far", [0.0, 1e5])
def test_motions_without_a_translation_keep_what_turns_about_the_axis_or_goes_across_it(far):
    axis, point = np.array([0.0, 0.6, 0.8]), far + np.array([0.1, 0.2, 0.3])
    turn, slide = np.r_[axis, np.cross(point, axis)], np.r_[0.0, 0.0, 0.0, axis]
    across, screw = np.r_[0.0, 0.0, 0.0, 1.0, 0.0, 0.0], turn + 0.01 * slide
    left = lambda *twists: without_translation(np.array(twists), axis, point, 0.01)
    assert np.array_equal(left(turn), [turn]) and np.array_equal(left(turn, across), [turn, across])
    assert left(slide).shape == left(screw).shape == (0, 6)
    for kept in (left(turn, slide), left(screw, slide)):
        assert np.abs(np.abs(kept / np.linalg.norm(kept[0, :3])) - np.abs(turn)).max() < 1e-9 * (1.0 + far)


def ring(inner, outer, start=0.0, wide=360.0, steps=72):
    """A sector of a ring as the outline of a face (n, 2, 2)."""
    angles = np.radians(start + np.linspace(0.0, wide, steps + 1))
    unit = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    loops = (
        [outer * unit[:-1], inner * unit[:-1][::-1]]
        if wide == 360.0
        else [np.concatenate([outer * unit, inner * unit[::-1]])]
    )
    return np.concatenate([np.stack([loop, np.roll(loop, -1, axis=0)], axis=1) for loop in loops])


@pytest.mark.parametrize("start", [-170.0, 0.0, 33.0, 90.0, 181.0])
@pytest.mark.parametrize("wide", [40.0, 170.0, 359.0])
def test_openings_and_pieces_of_a_sector(start, wide):
    face = Outline(ring(1.0, 2.0, start, wide), 0.0)
    assert np.degrees(face.on_circle(1.5)) == pytest.approx((360.0 - wide, wide))
    assert np.degrees(face.on_circle(2.1)) == pytest.approx((360.0, 0.0))
    assert face.span == pytest.approx((1.0, 2.0), rel=2e-3)


def test_a_whole_ring_has_no_opening_and_a_disc_begins_on_the_axis():
    face = Outline(ring(1.0, 2.0), 0.0)
    assert face.on_circle(1.5) == (0.0, 2.0 * np.pi) and face.on_circle(0.5) == (2.0 * np.pi, 0.0)
    assert face.sagitta == pytest.approx(2.0 * (1.0 - np.cos(np.pi / 72)))
    assert Outline(ring(1.0, 2.0)[:72], 0.0).span[0] == 0.0

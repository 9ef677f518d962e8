"""End play: the translation of a shaft in its bearing that collars, lugs or circlips end on both sides.

Contact that is farther off than the contact tolerance holds nothing, so a pin between collars with 1 mm to spare is
cylindrical by its contact. Nobody means that translation as a motion: the joint is revolute where the faces of its two
bodies end it in both senses after a small share of the journal. On one side open, or with a longer travel, it stays
cylindrical, and so it does where the function states a motion along the axis.

`end_faces` has the faces, and which two meet in every position of the rotation. The first such pair ends the
translation, or something does before: what is found bounds the travel from above.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from kinform.foundation.algebra.screws import Frame, scaled
from kinform.foundation.algebra.subspaces import null_space
from kinform.foundation.algebra.vectors import cross, lengths, norm, sine
from kinform.foundation.records import altered
from kinform.foundation.rounding import SINGLE
from kinform.foundation.words import quoted
from kinform.frozen import dataclass
from kinform.kinematics.constants import INTENDED_AXIS
from kinform.kinematics.joints.bodies.end_faces import EndSurfaces, Face, Line, Outline, always_meet, joined
from kinform.kinematics.joints.bodies.stated_joints import Pair, pair_between
from kinform.kinematics.joints.pair.joint import twists_of
from kinform.kinematics.joints.pair.question import Answer
from kinform.kinematics.screws.wording import motions_in_words
from kinform.mechanism.constants import SIGMAS
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly, Part
from kinform.model.contacts import Patch
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import FREEDOMS, Body, Joint, Reading, body_of_part
from kinform.model.names import BodyName, PartName
from kinform.model.surfaces import MeshSurfaces

MOST_PLAY = 0.5
"""Share of the journal's diameter up to which travel along it, in both senses together, is end play. Lugs with 2 mm to
spare on either side of a pin of 10 mm leave 0.4; the shortest stroke of the fixtures that faces end in both senses is
6.5. Half is where a guide begins: shorter than half of its width it jams (the rule for bushings)."""
FEW_PARTS = 8
"""Parts of a body that are looked at as quickly as sorted out. Chosen, not measured."""
LEVEL = 0.01
"""Share of the greatest play by which faces that stand at one height may differ: two half rings are one. Chosen, not
measured."""


@dataclass(frozen=True)
class End:
    """Where a translation ends."""

    travel: float
    """m, at most."""
    parts: tuple[tuple[PartName, ...], tuple[PartName, ...]]
    """Of the first body and of the second."""


@dataclass(frozen=True)
class EndPlay:
    """The translation of the second body along the axis of a joint, against and along it."""

    ends: tuple[End, End]
    journal: float
    """m: its diameter."""

    @property
    def travel(self) -> float:
        """m, in both senses together."""
        return self.ends[0].travel + self.ends[1].travel


class EndPlays:
    """Finds the end play of journals, by the planes across their axes."""

    def __init__(self, assembly: Assembly, surfaces: Mapping[str, MeshSurfaces], bodies: Sequence[Body]):
        self._assembly, self._bodies = assembly, {body.name: body for body in bodies}
        self._balls: dict[BodyName, _Balls] = {}
        self._surfaces, self._ends = surfaces, dict[str, EndSurfaces]()
        self._outlines: dict[tuple[object, ...], Outline] = {}
        self._meet: dict[tuple[Outline, Outline, float], bool] = {}

    def of(self, joint: Joint, patches: Sequence[Patch]) -> EndPlay | None:
        """The end play of a cylindrical joint, carried by `patches`; None where nothing ends its translation on both
        sides within `MOST_PLAY` of the journal."""
        journals = [p for p in patches if p.kind == "cylinder" and joint.axis is not None]
        if joint.type != "cylindrical" or joint.axis is None or joint.point is None or not journals:
            return None
        largest = max(journals, key=lambda patch: patch.area)
        diameter = 2.0 * max(largest.radii)
        most = MOST_PLAY * diameter
        slack = max(abs(patch.gap) for patch in journals)
        line = Line(joint.axis, joint.point)
        # against the axis the faces of the second body that look back meet those of the first that look along it
        sides = [self._balls_of(name) for name in joint.bodies]
        first, second = (
            self._faces(side.beside(other, line, most), line, LEVEL * most) for side, other in (sides, sides[::-1])
        )
        down = self._first_end(first[1], second[-1], slack, most)
        if down is None:
            return None
        up = self._first_end(second[1], first[-1], slack, most - down.travel)
        if up is None:
            return None
        return EndPlay((down, End(up.travel, (up.parts[1], up.parts[0]))), diameter)

    def _balls_of(self, body: BodyName) -> _Balls:
        if body not in self._balls:
            parts = [self._assembly.part(name) for name in self._bodies[body].parts]
            known = (part for part in parts if part.mesh is not None and part.mesh.digest in self._surfaces)
            self._balls[body] = _Balls([part for part in known if part.mesh is not None and len(part.mesh.faces)])
        return self._balls[body]

    def _faces(self, parts: Sequence[Part], line: Line, level: float) -> dict[int, list[Face]]:
        """The faces of parts of a body across a line, by the sense in which they look along it; those within `level`
        (m) of each other, and what vertices scatter, are one."""
        pieces = [piece for part in parts for piece in self._ends_of(part).across(part, line)]
        level += SIGMAS * max((piece.ends.noise for piece in pieces), default=0.0)
        return {sense: joined([p for p in pieces if p.sense == sense], level) for sense in (-1, 1)}

    def _ends_of(self, part: Part) -> EndSurfaces:
        assert part.mesh is not None
        if part.mesh.digest not in self._ends:
            self._ends[part.mesh.digest] = EndSurfaces(part.mesh, self._surfaces[part.mesh.digest])
        return self._ends[part.mesh.digest]

    def _first_end(self, lower: Sequence[Face], upper: Sequence[Face], slack: float, most: float) -> End | None:
        """Where faces that look along the axis first meet others that look against it, no farther than `most` (m)
        away: the one before the other as a whole."""
        apart = [(-other.levels[0] - face.levels[0], face, other) for face in lower for other in upper]
        for travel, face, other in sorted((one for one in apart if one[0] <= most), key=lambda one: one[0]):
            if -other.levels[1] - face.levels[1] < -LEVEL * most:
                continue
            first, second = self._outline(face), self._outline(other)
            key = first, second, float(f"{slack:.6e}")
            if key not in self._meet:
                self._meet[key] = always_meet(first, second, slack)
            if self._meet[key]:
                return End(max(travel, 0.0), (face.parts, other.parts))
        return None

    def _outline(self, face: Face) -> Outline:
        """The outline of a face; of one surface one for all parts of the same mesh that lie alike to the axis, as
        how it is turned about it does not matter."""
        if len(face.pieces) > 1:
            return face.outline
        key = face.pieces[0].likeness
        if key not in self._outlines:
            self._outlines[key] = face.outline
        return self._outlines[key]


class _Balls:
    """Balls about the parts of a body: which of many parts come near another body."""

    def __init__(self, parts: Sequence[Part]):
        self._parts = parts

    @cached_property
    def _known(self) -> tuple[Array, Array]:
        """(n, 3) m: their centres; (n,) m: their radii."""
        meshes = [(part.X_WP, part.mesh) for part in self._parts if part.mesh is not None]
        middles = [X_WP[:3, :3] @ (0.5 * sum(mesh.box)) + X_WP[:3, 3] for X_WP, mesh in meshes]
        return np.array(middles).reshape(-1, 3), np.array([0.5 * mesh.diagonal for _, mesh in meshes])

    def beside(self, other: _Balls, line: Line, most: float) -> Sequence[Part]:
        """The parts that may share a circle about a line with one of another body that is moved by `most` (m) along
        it at most, and few others."""
        if len(self._parts) <= FEW_PARTS or not other._parts:
            return self._parts
        (from_axis, along, radii), (others, heights, theirs) = self._to(line), other._to(line)
        near = from_axis - radii <= (others + theirs).max()
        near &= along + radii >= (heights - theirs).min() - most
        near &= along - radii <= (heights + theirs).max() + most
        return [self._parts[k] for k in np.flatnonzero(near).tolist()]

    def _to(self, line: Line) -> tuple[Array, Array, Array]:
        """(n,) m: distances from a line, places along it, and radii."""
        centres, radii = self._known
        away = centres - line.point
        along = away @ line.axis
        return lengths(away - along[:, None] * line.axis), along, radii


def without_end_play(
    assembly: Assembly,
    surfaces: Mapping[str, MeshSurfaces],
    bodies: Sequence[Body],
    decided: Mapping[Pair, tuple[Answer, Joint]],
    patches: Sequence[Patch],
) -> dict[Pair, tuple[Answer, Joint]]:
    """The decided pairs, those whose translation along a journal is end play as revolute; `patches` are those of the
    joints. Where the function states a motion along the axis that reading is kept beside the joint."""
    plays = EndPlays(assembly, surfaces, bodies)
    wanted: dict[Pair, list[IntendedJoint]] = {}
    of_part = body_of_part(bodies)
    out = dict(decided)
    for pair, (answer, joint) in decided.items():
        loose = _cylindrical(answer, joint)
        play = None if loose is None else plays.of(loose, [patches[k] for k in loose.patches])
        if loose is None or play is None:
            continue
        if not wanted:
            for one in assembly.function.joints:
                between = pair_between(assembly, of_part, one.between)
                if between is not None:
                    wanted.setdefault(between, []).append(one)
        stated = next((one for one in wanted.get(pair, ()) if _goes_along(one, loose)), None)
        if stated is None:
            out[pair] = _held(answer, joint, play, patches)
        elif all(reading.type != "revolute" for reading in joint.readings):
            out[pair] = answer, altered(joint, readings=(*joint.readings, _as_revolute(loose, play)))
    return out


def _cylindrical(answer: Answer, joint: Joint) -> Joint | None:
    """The joint, or its other reading, as cylindrical; None where it is not, or where contact may mean something
    else than a rotation about that axis, with or without the translation."""
    both = (joint,) if joint.status != "ambiguous" or answer.other is None else (joint, answer.other)
    loose = next((one for one in both if one.type == "cylindrical"), None)
    if loose is None or loose.axis is None or any(one.type not in ("cylindrical", "revolute") for one in both):
        return None
    parallel = all(one.axis is not None and sine(one.axis, loose.axis) <= INTENDED_AXIS for one in both)
    return loose if parallel else None


def _goes_along(intended: IntendedJoint, joint: Joint) -> bool:
    """Whether an intended joint has a motion along the axis of this one."""
    if intended.type not in ("cylindrical", "prismatic", "screw") or joint.axis is None:
        return False
    return intended.axis is None or sine(intended.axis / norm(intended.axis), joint.axis) <= INTENDED_AXIS


def _held(answer: Answer, joint: Joint, play: EndPlay, patches: Sequence[Patch]) -> tuple[Answer, Joint]:
    """A joint that turns about its axis, and moves along it by no more than end play."""
    assert joint.axis is not None and joint.point is not None
    open_ = joint.status == "ambiguous" and bool(joint.readings)
    if answer.strict is not None:
        answer = replace(answer, strict=without_translation(answer.strict, joint.axis, joint.point, play.journal))
    turn = twists_of("revolute", joint.axis, joint.point)
    frame = Frame.of(np.concatenate([patches[k].points for k in joint.patches]))
    return answer, altered(
        joint,
        type="revolute",
        freedoms=FREEDOMS["revolute"],
        twists=turn,
        at_rest=without_translation(joint.at_rest, joint.axis, joint.point, play.journal),
        closed=without_translation(joint.closed, joint.axis, joint.point, play.journal),
        evidence=tuple(sorted({*joint.evidence, "plane"})),
        status="determined" if open_ else joint.status,
        readings=() if open_ else joint.readings,
        reason=f"{joint.reason}; {_in_words(play)}",
        motion=motions_in_words(scaled(turn.T, frame), frame),
    )


def without_translation(twists: Array, axis: Array, point: Array, length: float) -> Array:
    """(m, 6) basis of those of the motions (k, 6) (ω; v at the world's origin) that do not move a point of the axis
    along it; `length` (m), of the journal, makes rotations and translations alike."""
    velocities = twists[:, 3:] + cross(twists[:, :3], point[None])
    along = velocities @ axis
    if norm(along) <= SINGLE * (norm(velocities) + length * norm(twists[:, :3])):
        return twists
    return null_space(along[None], SINGLE) @ twists


def _in_words(play: EndPlay) -> str:
    faces = [f"{quoted(end.parts[0])} and {quoted(end.parts[1])}" for end in play.ends]
    where = f"{faces[0]} meet on both sides" if faces[0] == faces[1] else f"{faces[0]}, or {faces[1]} meet"
    return (
        f"along the axis it moves at most {1e3 * play.travel:.3g} mm in all, until faces of {where}: end play of a "
        f"journal of {1e3 * play.journal:.3g} mm"
    )


def _as_revolute(joint: Joint, play: EndPlay) -> Reading:
    """The reading of a cylindrical joint as one with end play."""
    words = f"revolute, if the {1e3 * play.travel:.3g} mm that it moves along its axis are end play"
    return Reading("revolute", joint.axis, joint.point, None, FREEDOMS["revolute"], "", words)

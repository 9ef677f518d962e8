"""Joints that may be meant, where no function is stated: axes of journals that part the assembly.

Every axis on which journals lie is a candidate. Along it, pairs may part whose contact its turn leaves free and that
go round it (`split_prices`), and no others: flats beside it, holes that line up and everything that it does not move
hold. An axis is proposed where that leaves two substantial bodies on either side of it, by itself or, in loops,
together with all other candidates. Two axes between the same two bodies hold each other: neither is proposed, nor is
one that only screws, pins or balls turn about. Sliders are not looked for.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.vectors import canonical_sign, norm
from kinform.foundation.words import counted, quoted
from kinform.frozen import dataclass
from kinform.kinematics.joints.bodies.extents import part_volumes
from kinform.kinematics.joints.bodies.stated_joints import joint_twists
from kinform.kinematics.partition.bodies import partition
from kinform.kinematics.partition.constants import FASTENED, SAME_AXIS
from kinform.kinematics.partition.contact import ROUND, Asked, Contact, PartPair, contact_of_pairs, near_each
from kinform.kinematics.partition.known_axes import KnownAxes
from kinform.kinematics.partition.sides import Sides, TouchingParts
from kinform.kinematics.partition.split_prices import hints_of
from kinform.kinematics.partition.standard_parts import HOLDERS, standard_parts
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts, Patch
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import JointType
from kinform.model.names import PartName
from kinform.model.surfaces import MeshSurfaces

PROPOSED = (100.0, 310.0, np.inf)
"""Greatest prices of parting a pair at which a joint is looked for where no function is: journals, faces round the axis
and serrations; where that parts nothing, flats beside it, too; then all that the turn leaves free."""
BESIDE = 0.1
"""Of several pairs of bodies on one axis, those are proposed whose smaller side is at least this share of the largest
such: legs on one hip axis, and not the rings of their bearings. Chosen, not measured."""
SAME_AXIS_OFF = 0.02
"""Distance of journals that are on one axis, as a share of the smaller one's reach. Chosen, not measured."""
SAME_CENTRE = 1e-6
"""m: balls on one pin that differ by less are one, seen from two contacts. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class Proposal:
    """A joint that may be meant."""

    type: JointType
    """revolute or spherical."""
    axis: Array | None
    """(3,) unit; None of spherical ones."""
    point: Array
    """(3,) m."""
    sides: Sides
    """The parts that would move relative to each other: first the side with the ground, where that is stated, else the
    larger one."""
    share: float
    """Volume of the smaller side, of all."""
    moved: float
    """Volume of the second side, of all."""
    borne: frozenset[PartName]
    """Parts that touch about the axis."""

    @property
    def words(self) -> str:
        """What it would move."""
        moving = sorted(self.sides[1])
        return f"moves {counted(len(moving), 'part')}, {100 * self.moved:.2g} % of the volume: {quoted(moving)}"

    def between(self, volume: Mapping[PartName, float]) -> tuple[PartName, PartName]:
        """The largest part of either side that touches about the axis: other joints may part the side further."""
        first, second = (max(self.borne & set(side), key=lambda name: (volume[name], name)) for side in self.sides)
        return first, second


def propose(
    assembly: Assembly,
    surfaces: Mapping[str, MeshSurfaces],
    contacts: Contacts,
    together: Sequence[Sequence[PartName]] = (),
) -> list[Proposal]:
    """Joints that may be meant, the largest smaller side first. `together`: parts that are one anyway."""
    volume = part_volumes(assembly)
    parts = sorted(volume)
    pairs = contact_of_pairs(contacts.patches)
    hints = hints_of(contacts.suggestions)
    axes = _candidates(contacts.patches)
    screws = {pair: 0.0 if worth <= FASTENED["spigot"] else worth for pair, worth in hints.items()}
    free = _freed_near(axes, pairs, screws, PROPOSED[0])
    known = [[name for name in names if name in volume] for names in together]
    graph = TouchingParts(parts, sorted(pairs), volume, [names for names in known if len(names) > 1])
    standard = standard_parts(assembly, surfaces)
    holders = {name for name, one in standard.items() if one.kind in HOLDERS}
    journals = [frozenset(p for p in cut if pairs[p].journal(axis)) for axis, cut in zip(axes, free, strict=True)]
    screwed = [all(holders & set(pair) for pair in own) for own in journals]
    borne = [{name for pair in own for name in pair} for own in journals]
    found: dict[int, list[Sides]] = {}

    def bearing(number: int, several: list[Sides]) -> list[Sides]:
        """Those where either side has a part that touches about the axis, no screw that only holds it, and more than
        standard parts."""
        own = borne[number] - holders
        return [both for both in several if all(own & set(s) and not standard.keys() >= set(s) for s in both)]

    for most in PROPOSED:
        first = most == PROPOSED[0]
        # a screw may be a pivot, but nothing that holds may be parted for that
        wanted = [
            number
            for number, own in enumerate(journals)
            if own and not found.get(number) and (first or not screwed[number])
        ]
        cuts = [free[k] for k in wanted] if first else _freed_each([axes[k] for k in wanted], pairs, hints, most)
        for number, cut in zip(wanted, cuts, strict=True):
            found[number] = bearing(number, graph.sides(free[number], cut))
    for number in range(len(axes)):
        if len(found.get(number, ())) > 1 and not _unhinted(journals[number], hints):
            # a motor between, whose own screw holes are no firmer: one joint
            found[number] = [max(found[number], key=lambda both: min(graph.size(side) for side in both))]
    every = frozenset().union(*free)
    for number in range(len(axes)):
        if not found.get(number) and not screwed[number]:
            found[number] = bearing(number, graph.sides(free[number], every))
    ways = [
        (_as_ball(axes[number], sides, free[number], pairs), sides, frozenset(borne[number]))
        for number, several in sorted(found.items())
        for sides in several
    ]
    ground = set() if assembly.ground is None else set(assembly.parts_of(assembly.ground))
    total = sum(volume.values()) or 1.0  # parts without any volume: nothing is substantial
    shares = [min(sum(volume[name] for name in side) for side in sides) / total for _, sides, _ in ways]
    alike, of_one = graph.alike([sides for _, sides, _ in ways]), _of_one([joint for joint, _, _ in ways])
    out = []
    for k, ((joint, sides, touching), share) in enumerate(zip(ways, shares, strict=True)):
        largest, twice = max(shares[other] for other in of_one[k]), alike[k] - of_one[k]
        if not twice and share >= BESIDE * largest:
            assert joint.point is not None
            turned = sides if not ground & set(sides[1]) else sides[::-1]
            moved = graph.size(turned[1]) / total
            out.append(Proposal(joint.type, joint.axis, joint.point, turned, share, moved, touching))
    return _once(sorted(out, key=lambda one: (-one.share, one.sides)))


def proposed_joints(
    assembly: Assembly, surfaces: Mapping[str, MeshSurfaces], contacts: Contacts
) -> list[tuple[IntendedJoint, str]]:
    """Joints that may be meant as a function states them, each with what it would move."""
    return [(joint, one.words) for joint, one in stated_proposals(assembly, surfaces, contacts)]


def stated_proposals(
    assembly: Assembly, surfaces: Mapping[str, MeshSurfaces], contacts: Contacts
) -> list[tuple[IntendedJoint, Proposal]]:
    """Joints that may be meant as a function states them, named joint_1, joint_2 …, each with its proposal.

    Their sides are named by the largest part of the body that all of them together make of what touches about the axis.
    """
    volume = part_volumes(assembly)
    ways = propose(assembly, surfaces, contacts)
    joints = [
        IntendedJoint(f"joint_{number}", one.between(volume), one.type, one.axis, None, one.point, None, None, "", None)
        for number, one in enumerate(ways, 1)
    ]
    found = partition(assembly, contacts, joints, surfaces)
    largest = [max(names, key=lambda name: (volume.get(name, 0.0), name)) for names in found.parts]
    out = []
    for one, joint in zip(ways, joints, strict=True):
        bodies = [found.placed[PartName(name)].body for name in joint.between]
        first, second = (largest[body] for body in bodies) if bodies[0] != bodies[1] else joint.between
        out.append((replace(joint, between=(first, second)), one))
    return out


def _as_ball(
    joint: IntendedJoint, sides: Sides, cut: frozenset[PartPair], pairs: Mapping[PartPair, Contact]
) -> IntendedJoint:
    """The joint, or the ball joint that it is where all that is round about one of its sides is one sphere: the axis
    is that of a pin then, which holds the ball."""
    for side in sides:
        own = sorted(pair for pair in cut if len(set(side) & set(pair)) == 1)
        patches = [patch for pair in own for patch in pairs[pair].patches if patch.kind in ROUND]
        balls = [_joint("spherical", None, patch.point) for patch in patches if patch.kind == "sphere"]
        reach = max((max(patch.radii) for patch in patches), default=0.0)
        one = all(_same(balls[0], other, SAME_AXIS_OFF * reach) for other in balls)
        if balls and one and len(balls) == len(patches):
            return balls[0]
    return joint


def _unhinted(pairs: frozenset[PartPair], hints: Mapping[PartPair, float]) -> list[PartPair]:
    """Those that nothing suggests to be fastened."""
    return [pair for pair in sorted(pairs) if not hints.get(pair)]


def _once(proposals: Sequence[Proposal]) -> list[Proposal]:
    """Of balls with one centre that have the same side, the first."""
    out: list[Proposal] = []
    for one in proposals:
        balls = [other for other in out if one.axis is None and other.axis is None]
        balls = [other for other in balls if float(np.linalg.norm(one.point - other.point)) <= SAME_CENTRE]
        if not any(set(one.sides) & set(other.sides) for other in balls):
            out.append(one)
    return out


def _of_one(joints: Sequence[IntendedJoint]) -> list[set[int]]:
    """Where each joint is once more, itself included: the same one, or balls with the same centre."""
    places: dict[int, set[int]] = {}
    for k, joint in enumerate(joints):
        places.setdefault(id(joint), set()).add(k)
    balls = [k for k, joint in enumerate(joints) if joint.axis is None]
    return [
        places[id(joint)] | {k for k in balls if joint.axis is None and _same(joint, joints[k], SAME_CENTRE)}
        for joint in joints
    ]


def _candidates(patches: Sequence[Patch]) -> list[IntendedJoint]:
    """The axes of all journals, each once, and the centres of ball joints."""
    out: list[IntendedJoint] = []
    known = KnownAxes(len(patches))
    for patch in sorted(patches, key=lambda patch: -patch.area):
        if patch.narrow or patch.kind not in ROUND:
            continue
        reach = norm(np.ptp(patch.points, axis=0)) or 1e-6
        axis = None if patch.kind == "sphere" else patch.axis * canonical_sign(patch.axis)
        joint = _joint("spherical" if axis is None else "revolute", axis, patch.point)
        off = SAME_AXIS_OFF * reach
        if not any(_same(joint, out[k], off) for k in known.near(patch.point, axis, off)):
            out.append(joint)
            known.add(patch.point, axis)
    return out


def _joint(type_: JointType, axis: Array | None, point: Array) -> IntendedJoint:
    return IntendedJoint("", ("", ""), type_, axis, None, point, None, None, "", None)


def _same(one: IntendedJoint, other: IntendedJoint, off: float) -> bool:
    assert one.point is not None and other.point is not None
    apart = one.point - other.point
    if one.axis is None or other.axis is None:
        return one.type == other.type and norm(apart) <= off
    if abs(float(one.axis @ other.axis)) < np.cos(SAME_AXIS):
        return False
    return norm(apart - (apart @ other.axis) * other.axis) <= off


def _freed_near(
    joints: Sequence[IntendedJoint], pairs: Mapping[PartPair, Contact], hints: Mapping[PartPair, float], most: float
) -> list[frozenset[PartPair]]:
    """Pairs near its axis, or centre, that each joint may part at `most` at this price."""
    every, out = list(pairs.items()), []
    for joint, near in zip(joints, near_each(joints, list(pairs.values())), strict=True):
        out += _freed_each([joint], dict(every[k] for k in np.flatnonzero(near).tolist()), hints, most)
    return out


def _freed_each(
    joints: Sequence[IntendedJoint], pairs: Mapping[PartPair, Contact], hints: Mapping[PartPair, float], most: float
) -> list[frozenset[PartPair]]:
    """Pairs that each joint may part at `most` at this price."""
    asked = Asked.of(joints, [joint_twists(joint) for joint in joints])
    out: list[list[PartPair]] = [[] for _ in joints]
    for pair, contact in pairs.items():
        for k, price in contact.costs(asked).items():
            if price + hints.get(pair, 0.0) <= most:
                out[k].append(pair)
    return [frozenset(freed) for freed in out]

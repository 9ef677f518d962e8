"""Where the reactions of a run would pull contacts apart.

Joints hold both ways in the simulation, their contacts push only. Patches go along with the smaller of their two
surfaces, and where a joint slides with the overlap of both along its axis. Friction and fasteners are not counted.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cached_property

import numpy as np

from kinform.design import Design
from kinform.foundation.algebra.displacements import inverse, poses
from kinform.foundation.algebra.screws import Frame
from kinform.foundation.algebra.vectors import cross
from kinform.foundation.rounding import SINGLE
from kinform.frozen import dataclass
from kinform.kinematics.mobility.guides import span_along
from kinform.kinematics.separation.contact_rows import ContactRows, is_stated
from kinform.model.arrays import Array
from kinform.model.kinematics import Joint, Kinematics
from kinform.model.simulation import Simulation
from kinform.statics.carrying import pushes_at, uncarried
from kinform.statics.disengaging import SLIDES, slide_of
from kinform.statics.sharing import axes_of, decidable, self_stresses

APART = 1e-2
"""Share of a wrench that contacts cannot carry, beyond which no tessellation of their borders explains it: a circle of
24 edges is 1 % smaller than it."""
CLOSE = 1e-3
"""Share below which it is rounding and what fitted axes are off; in between it is undetermined. A choice."""
LOOKS = 200
"""Output times at which loads that redundant constraints share are looked at, besides those before a finding: a
choice."""


@dataclass(frozen=True, eq=False)
class Lift:
    """A joint whose contacts would have to pull."""

    joint: Joint
    time: float
    certain: bool
    force: float
    """N that contacts cannot give."""
    torque: float
    """N·m, about the middle of the contact."""


@dataclass(frozen=True)
class Sharing:
    """Joints whose reactions redundancy leaves open, and whether their contacts can carry the run by pushing."""

    joints: tuple[str, ...]
    time: float | None
    """s, of the first output time at which they cannot; None where they always can."""
    certain: bool
    """False: by hardly more than tessellation explains, or too large to be looked at (then time is None)."""


@dataclass(frozen=True, eq=False)
class _Reactions:
    """A run with reactions, beside the contacts that have to give them."""

    design: Design
    run: Simulation
    kinematics: Kinematics
    rows: ContactRows

    @staticmethod
    def of(design: Design) -> _Reactions:
        """Those of a design with contacts, kinematics and a dynamic run."""
        run, kinematics, contacts = design.simulation, design.kinematics, design.contacts
        assert run is not None and kinematics is not None and contacts is not None
        return _Reactions(design, run, kinematics, ContactRows(kinematics.matrix, kinematics.bodies, contacts.patches))

    @cached_property
    def nothing(self) -> float:
        """N below which a wrench is none."""
        return SINGLE * float(np.linalg.norm(self.run.F_B[..., 3:], axis=2).max(initial=0.0))


@dataclass(frozen=True, eq=False)
class _Patch:
    """Extreme points of a patch at the pose of the meshes, and who carries them."""

    points: Array
    normals: Array
    with_second: bool
    spans: tuple[tuple[float, float], tuple[float, float]] | None
    """m along the axis: of the surface on the first body and of that on the second, where the joint slides."""


@dataclass(frozen=True, eq=False)
class _JointContact:
    """The contact of one joint along a run of T output times; wrenches of it are as its first body sees them, about
    the frame's centre, torques over its length."""

    joint: Joint
    patches: Sequence[_Patch]
    frame: Frame
    turns: Array
    """(T, 3, 3) of the first body."""
    across: Array
    """(T, 4, 4) displacement of the second body as the first sees it."""
    slides: Array
    """(T,) m."""

    def seen(self, wrenches: Array, k: int) -> Array:
        """World wrenches (n, 6) about the joint's point, at output time k."""
        out = np.concatenate([wrenches[:, :3] @ self.turns[k], wrenches[:, 3:] @ self.turns[k]], axis=1)
        out[:, :3] = (out[:, :3] + cross(self._arm, out[:, 3:])) / self.frame.length
        return out

    @property
    def _arm(self) -> Array:
        """(3,) m from the frame's centre to the joint's point."""
        return (np.zeros(3) if self.joint.point is None else self.joint.point) - self.frame.centre

    def pushes(self, k: int) -> Array:
        """(n, 6) what the patches can push with on the second body."""
        X, axis, slide = self.across[k], self.joint.axis, float(self.slides[k])
        out = [np.zeros((0, 6))]
        for patch in self.patches:
            points, normals = patch.points, patch.normals
            if patch.with_second:
                points, normals = points @ X[:3, :3].T + X[:3, 3], normals @ X[:3, :3].T
            if patch.spans is not None and axis is not None:
                (a0, a1), (b0, b1) = patch.spans
                low, high = max(a0, b0 + slide), min(a1, b1 + slide)
                if low > high:
                    continue
                heights = points @ axis
                points = points + (np.clip(heights, low, high) - heights)[:, None] * axis
            out.append(pushes_at(points, normals, self.frame.centre, self.frame.length))
        return np.concatenate(out)

    def driven(self, k: int) -> Array:
        """(m, 6) wrenches along the joint's freedoms, through its point: what acts on its shaft is no contact's."""
        turns, slides, screws = axes_of(self.joint, np.eye(3), self.across[k])
        wrenches = [np.concatenate([turn / self.frame.length, np.zeros(3)]) for turn in turns]
        wrenches += [np.concatenate([screw[:3] / self.frame.length, np.zeros(3)]) for screw in screws]
        wrenches += [np.concatenate([cross(self._arm, slide) / self.frame.length, slide]) for slide in slides]
        return np.array(wrenches).reshape(-1, 6)


def lifts(design: Design) -> tuple[tuple[Lift, ...], Sharing | None, tuple[str, ...]]:
    """First lift of each joint; those that redundancy leaves open, together; names of those contact does not decide."""
    reactions = _Reactions.of(design)
    run = reactions.run
    joints = [joint for joint in reactions.kinematics.joints if joint.name in run.joint_names]
    aside = tuple(joint.name for joint in joints if is_stated(joint))
    doubtful = [joint for joint in joints if not is_stated(joint) and joint.held is not True]
    loose = [j for j in doubtful if run.undetermined[run.joint_names.index(j.name)].any()]
    first = [_first_lift(reactions, joint) for joint in doubtful if joint not in loose]
    shared = _shared(reactions, joints, loose) if loose else None
    return tuple(lift for lift in first if lift is not None), shared, aside


def _shared(reactions: _Reactions, joints: Sequence[Joint], loose: Sequence[Joint]) -> Sharing:
    """Whether the contacts of the loose joints, of all `joints` of the run, can carry it together, however the load is
    shared."""
    from scipy.linalg import block_diag

    run, nothing = reactions.run, reactions.nothing
    names = tuple(joint.name for joint in loose)
    contacts = [contact for joint in loose if (contact := _contact_of(reactions, joint)) is not None]
    if len(contacts) < len(loose) or len(joints) != len(run.joint_names) or not decidable(run):
        return Sharing(names, None, False)
    moves = [_relative(run, joint) for joint in joints]
    length = contacts[0].frame.length
    in_joints = [joints.index(joint) for joint in loose]

    def share(k: int) -> float:
        """Of all wrenches that no pushes make at output time k."""
        turns, across = (np.array([pair[n][k] for pair in moves]) for n in (0, 1))
        stresses = self_stresses(reactions.kinematics, run, joints, turns, across, k, length)
        stresses = stresses * np.array([length, length, length, 1.0, 1.0, 1.0])
        of_run = [run.F_B[k, run.joint_names.index(joint.name)] for joint in loose]
        whole = np.concatenate([c.seen(wrench[None], k)[0] for c, wrench in zip(contacts, of_run, strict=True)])
        size = float(np.linalg.norm(whole))
        if size <= nothing:
            return 0.0
        free = np.concatenate([c.seen(stresses[:, n], k) for c, n in zip(contacts, in_joints, strict=True)], axis=1)
        both_ways = np.concatenate([free, block_diag(*(contact.driven(k) for contact in contacts))])
        left = uncarried(block_diag(*(contact.pushes(k) for contact in contacts)), both_ways, whole)
        return float(np.linalg.norm(left)) / size

    last = len(run.time) - 1
    doubt: int | None = None
    before = -1
    for k in np.unique(np.append(np.arange(0, last, max(1, last // LOOKS)), last)).tolist():
        left = share(k)
        if left > APART:
            first = next(n for n in range(before + 1, k + 1) if n == k or share(n) > APART)
            return Sharing(names, float(run.time[first]), True)
        if doubt is None and left > CLOSE:
            doubt = k
        before = k
    return Sharing(names, None if doubt is None else float(run.time[doubt]), doubt is None)


def _first_lift(reactions: _Reactions, joint: Joint) -> Lift | None:
    """The first output time at which the contacts of a joint cannot carry its wrench; else the first doubtful one."""
    run, nothing = reactions.run, reactions.nothing
    contact = _contact_of(reactions, joint)
    if contact is None:
        return None
    doubt: Lift | None = None
    for k, t in enumerate(run.time):
        wrench = contact.seen(run.F_B[None, k, run.joint_names.index(joint.name)], k)[0]
        size = float(np.linalg.norm(wrench))
        if size <= nothing:
            continue
        left = uncarried(contact.pushes(k), contact.driven(k), wrench)
        share = float(np.linalg.norm(left)) / size
        force, torque = float(np.linalg.norm(left[3:])), contact.frame.length * float(np.linalg.norm(left[:3]))
        if share > APART:
            return Lift(joint, float(t), True, force, torque)
        if share > CLOSE and doubt is None:
            doubt = Lift(joint, float(t), False, force, torque)
    return doubt


def _contact_of(reactions: _Reactions, joint: Joint) -> _JointContact | None:
    """The contact of a joint along the run; None where nothing touches."""
    patches = list(_patches(reactions, joint))
    if not patches:
        return None
    frame = Frame.of(np.concatenate([patch.points for patch in patches]))
    return _JointContact(joint, patches, frame, *_relative(reactions.run, joint), slide_of(reactions.run, joint))


def _relative(run: Simulation, joint: Joint) -> tuple[Array, Array]:
    """(T, 3, 3) turn of the first body, and (T, 4, 4) displacement of the second as the first sees it."""
    numbers = [run.body_names.index(name) for name in joint.bodies]
    first, second = (poses(run.p_WB[:, k], run.q_WB[:, k]) for k in numbers)
    return first[:, :3, :3], inverse(first) @ second


def _patches(reactions: _Reactions, joint: Joint) -> Iterator[_Patch]:
    """What touches in a joint, what blocks it included, the first body's side first."""
    design, rows = reactions.design, reactions.rows
    assert design.contacts is not None
    of_first = rows.parts_of(joint.bodies[0])
    for k in joint.touching:
        patch = design.contacts.patches[k]
        turned = patch.parts[0] not in of_first
        points, normals, _ = rows.samples(k, turned=turned)
        sides = list(zip(patch.parts, patch.surfaces, strict=True))[:: -1 if turned else 1]
        areas = [_area(design, name, surface) for name, surface in sides]
        spans = None
        if joint.type in SLIDES and joint.axis is not None:
            assembly, surfaces = design.assembly, design.surfaces
            first, second = (span_along(assembly, surfaces, name, surface, joint.axis) for name, surface in sides)
            spans = None if first is None or second is None else (first, second)
        yield _Patch(points, normals, areas[1] < areas[0], spans)


def _area(design: Design, name: str, surface: int) -> float:
    part = design.assembly.part(name)
    known = None if part.mesh is None else design.surfaces.get(part.mesh.digest)
    return math.inf if known is None or surface >= len(known.surfaces) else known.surfaces[surface].area

"""Where the reactions of a run would pull contacts apart, and where a slider has left what guides it.

Joints hold both ways in the simulation, their contacts push only. Patches go along with the smaller of their two
surfaces, and where a joint slides with the overlap of both along its axis. Friction and fasteners are not counted.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from kinform.design import Design
from kinform.foundation.algebra.screws import Frame
from kinform.kinematics.separation.contact_rows import ContactRows, is_stated
from kinform.model.arrays import Array
from kinform.model.kinematics import Joint
from kinform.model.simulation import Simulation
from kinform.statics.carrying import missing, wrenches_at
from kinform.statics.sharing import decidable, self_stresses

__all__ = ["Lift", "Sharing", "Slip", "lifts", "slips"]


APART = 1e-2
"""Share of a wrench that contacts cannot carry, beyond which no tessellation of their borders explains it."""
CLOSE = 1e-3
"""Share below which it is rounding; in between nobody knows."""
NOTHING = 1e-6
"""Share of the greatest wrench of the run in any joint below which a wrench is none."""
LOOKS = 200
"""Output times at which loads that redundant constraints share are looked at, besides those before a finding."""
SLIDES = {"prismatic": 0, "cylindrical": 1, "screw": 0}
"""Column of the coordinate that slides, by type of joint."""


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


@dataclass(frozen=True, eq=False)
class Slip:
    """A joint whose slider has left all that guides it."""

    joint: Joint
    time: float
    value: float
    """rad or m then."""
    limit: float
    """rad or m at which the last of its patches ends."""


@dataclass(frozen=True, eq=False)
class _Patch:
    """Extreme points of a patch at the pose of the meshes, and who carries them."""

    points: Array
    normals: Array
    with_second: bool
    spans: tuple[tuple[float, float], tuple[float, float]] | None
    """m along the axis: of the surface on the first body and of that on the second, where the joint slides."""


@dataclass(frozen=True)
class Sharing:
    """Joints whose reactions redundancy leaves open, and whether their contacts can carry the run by pushing."""

    joints: tuple[str, ...]
    time: float | None
    """s, of the first output time at which they cannot; None where they always can."""
    certain: bool
    """False: by hardly more than tessellation explains, or too large to be looked at (then time is None)."""


def lifts(design: Design) -> tuple[tuple[Lift, ...], Sharing | None, tuple[str, ...]]:
    """First lift of each joint; those that redundancy leaves open, together; names of those contact does not decide."""
    run, kinematics, contacts = design.simulation, design.kinematics, design.contacts
    assert run is not None and kinematics is not None and contacts is not None
    known = [joint for joint in kinematics.joints if joint.name in run.joint_names]
    aside = tuple(joint.name for joint in known if is_stated(joint))
    doubtful = [joint for joint in known if not is_stated(joint) and joint.held is not True]
    loose = [j for j in doubtful if run.undetermined[run.joint_names.index(j.name)].any()]
    open_ = {j.name for j in loose}
    rows = ContactRows(kinematics.matrix, kinematics.bodies, contacts.patches)
    greatest = float(np.linalg.norm(run.F_B[..., 3:], axis=2).max(initial=0.0))
    found = [_first_lift(design, rows, joint, NOTHING * greatest) for joint in doubtful if joint.name not in open_]
    shared = _shared(design, rows, known, loose, NOTHING * greatest) if loose else None
    return tuple(lift for lift in found if lift is not None), shared, aside


def _shared(design: Design, rows: ContactRows, known: list[Joint], loose: list[Joint], nothing: float) -> Sharing:
    """Whether the contacts of the loose joints can carry the run together, however the load is shared."""
    from scipy.linalg import block_diag

    run, kinematics = design.simulation, design.kinematics
    assert run is not None and kinematics is not None
    names = tuple(joint.name for joint in loose)
    patches = [list(_patches(design, rows, joint)) for joint in loose]
    if not all(patches) or len(known) != len(run.joint_names) or not decidable(run):
        return Sharing(names, None, False)
    frames = [Frame.of(np.concatenate([patch.points for patch in own])) for own in patches]
    points = [np.zeros(3) if joint.point is None else joint.point for joint in loose]
    ends = [[run.body_names.index(name) for name in joint.bodies] for joint in known]
    turned = [_relative(run, first, second) for first, second in ends]
    slides = [_slide(run, joint, run.joint_names.index(joint.name)) for joint in loose]
    length = frames[0].length
    own = [known.index(joint) for joint in loose]

    def share(k: int) -> float:
        """Of all wrenches that no pushes make at output time k."""
        turns, across = (np.array([pair[n][k] for pair in turned]) for n in (0, 1))
        stresses = self_stresses(kinematics, run, known, turns, across, k, length)
        wanted, pushes, given = [], [], []
        for n, joint in enumerate(loose):
            turn, frame, at = turns[own[n]], frames[n], points[n]
            wrench = run.F_B[k, run.joint_names.index(joint.name)]
            wanted.append(_as_seen(wrench[None], turn, at, frame)[0])
            stress = stresses[:, own[n]] * np.array([length, length, length, 1.0, 1.0, 1.0])
            pushes.append(_pushes(patches[n], joint, across[own[n]], float(slides[n][k]), frame))
            given.append((_as_seen(stress, turn, at, frame), _driven(joint, across[own[n]], at, frame)))
        whole = np.concatenate(wanted)
        size = float(np.linalg.norm(whole))
        if size <= nothing:
            return 0.0
        free = np.concatenate([stress for stress, _ in given], axis=1)
        left = missing(block_diag(*pushes), np.concatenate([free, block_diag(*(d for _, d in given))]), whole)
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


def _as_seen(wrenches: Array, turn: Array, at: Array, frame: Frame) -> Array:
    """World wrenches (n, 6) about the joint's point as the first body sees them, about the frame's centre, torques
    over its length."""
    out = np.concatenate([wrenches[:, :3] @ turn, wrenches[:, 3:] @ turn], axis=1)
    out[:, :3] = (out[:, :3] + np.cross(at - frame.centre, out[:, 3:])) / frame.length
    return out


def _first_lift(design: Design, rows: ContactRows, joint: Joint, nothing: float) -> Lift | None:
    """The first output time at which the contacts of a joint cannot carry its wrench; else the first doubtful one."""
    run = design.simulation
    assert run is not None
    patches = list(_patches(design, rows, joint))
    if not patches:
        return None
    frame = Frame.of(np.concatenate([patch.points for patch in patches]))
    index = run.joint_names.index(joint.name)
    first, second = (run.body_names.index(name) for name in joint.bodies)
    R, X = _relative(run, first, second)
    at = np.zeros(3) if joint.point is None else joint.point
    wrench = run.F_B[:, index].copy()
    wrench[:, :3], wrench[:, 3:] = (np.einsum("tji,tj->ti", R, wrench[:, s]) for s in (slice(0, 3), slice(3, 6)))
    wrench[:, :3] = (wrench[:, :3] + np.cross(at - frame.centre, wrench[:, 3:])) / frame.length
    slide = _slide(run, joint, index)
    doubt: Lift | None = None
    for k, t in enumerate(run.time):
        size = float(np.linalg.norm(wrench[k]))
        if size <= nothing:
            continue
        pushes = _pushes(patches, joint, X[k], float(slide[k]), frame)
        left = missing(pushes, _driven(joint, X[k], at, frame), wrench[k])
        share = float(np.linalg.norm(left)) / size
        force, torque = float(np.linalg.norm(left[3:])), frame.length * float(np.linalg.norm(left[:3]))
        if share > APART:
            return Lift(joint, float(t), True, force, torque)
        if share > CLOSE and doubt is None:
            doubt = Lift(joint, float(t), False, force, torque)
    return doubt


def _relative(run: Simulation, first: int, second: int) -> tuple[Array, Array]:
    """(T, 3, 3) turn of the first body, and (T, 4, 4) displacement of the second as the first sees it."""
    from scipy.spatial.transform import Rotation

    turns = [Rotation.from_quat(np.roll(run.q_WB[:, k], -1, axis=1)).as_matrix() for k in (first, second)]
    X = np.zeros((len(run.time), 4, 4))
    X[:, :3, :3] = turns[0].transpose(0, 2, 1) @ turns[1]
    X[:, :3, 3] = np.einsum("tji,tj->ti", turns[0], run.p_WB[:, second] - run.p_WB[:, first])
    X[:, 3, 3] = 1.0
    return turns[0], X


def _slide(run: Simulation, joint: Joint, index: int) -> Array:
    """(T,) m that the joint has slid along its axis; zero for those that do not."""
    if joint.type not in SLIDES:
        return np.zeros(len(run.time))
    values: Array = run.joint_position[:, int(run.joint_offset[index]) + SLIDES[joint.type]]
    return values * (joint.pitch or 0.0) / (2.0 * math.pi) if joint.type == "screw" else values


def _patches(design: Design, rows: ContactRows, joint: Joint) -> Iterator[_Patch]:
    contacts, kinematics = design.contacts, design.kinematics
    assert contacts is not None and kinematics is not None
    own = rows.parts_of(joint.bodies[0])
    for k in sorted({*joint.patches, *(blocker.patch for blocker in joint.blockers)}):
        patch = contacts.patches[k]
        turned = patch.parts[0] not in own
        points, normals, _ = rows.samples(k, turned=turned)
        areas = [_area(design, name, n) for name, n in zip(patch.parts, patch.surfaces, strict=True)]
        second_is_smaller = areas[0] < areas[1] if turned else areas[1] < areas[0]
        spans = None
        if joint.type in SLIDES and joint.axis is not None:
            found = [_span(design, name, n, joint.axis) for name, n in zip(patch.parts, patch.surfaces, strict=True)]
            first, second = reversed(found) if turned else found
            if first is not None and second is not None:
                spans = first, second
        yield _Patch(points, normals, second_is_smaller, spans)


def _pushes(patches: list[_Patch], joint: Joint, X: Array, slide: float, frame: Frame) -> Array:
    """(n, 6) what the patches can push with on the second body, as the first sees it."""
    out = [np.zeros((0, 6))]
    for patch in patches:
        points, normals = patch.points, patch.normals
        if patch.with_second:
            points, normals = points @ X[:3, :3].T + X[:3, 3], normals @ X[:3, :3].T
        if patch.spans is not None and joint.axis is not None:
            (a0, a1), (b0, b1) = patch.spans
            low, high = max(a0, b0 + slide), min(a1, b1 + slide)
            if low > high:
                continue
            heights = points @ joint.axis
            points = points + (np.clip(heights, low, high) - heights)[:, None] * joint.axis
        out.append(wrenches_at(points, normals, frame.centre, frame.length))
    return np.concatenate(out)


def _driven(joint: Joint, X: Array, at: Array, frame: Frame) -> Array:
    """(m, 6) wrenches along the freedoms of a joint, through its point: what acts on its shaft is no contact's."""
    axes = [] if joint.axis is None else [joint.axis]
    turns: list[Array] = axes if joint.type in ("revolute", "cylindrical", "screw", "planar", "universal") else []
    slides: list[Array] = axes if joint.type in ("prismatic", "cylindrical") else []
    if joint.type == "universal" and joint.axis2 is not None:
        turns = [*turns, X[:3, :3] @ joint.axis2]
    if joint.type == "spherical":
        turns = list(np.eye(3))
    if joint.type == "planar" and joint.axis is not None:
        slides = list(np.linalg.svd(joint.axis[None])[2][1:])
    made = [np.concatenate([turn / frame.length, np.zeros(3)]) for turn in turns]
    made += [np.concatenate([np.cross(at - frame.centre, slide) / frame.length, slide]) for slide in slides]
    return np.array(made).reshape(-1, 6)


def _area(design: Design, name: str, surface: int) -> float:
    part = design.assembly.part(name)
    known = None if part.mesh is None else design.surfaces.get(part.mesh.digest)
    return math.inf if known is None or surface >= len(known.surfaces) else known.surfaces[surface].area


def _span(design: Design, name: str, surface: int, axis: Array) -> tuple[float, float] | None:
    """Lowest and highest place (m) along `axis` of a surface of a part; None where the surface is not known."""
    part = design.assembly.part(name)
    known = None if part.mesh is None else design.surfaces.get(part.mesh.digest)
    if part.mesh is None or known is None or surface < 0:
        return None
    corners = part.mesh.vertices[np.unique(part.mesh.faces[known.labels == surface])]
    if not len(corners):
        return None
    heights = (corners @ part.X_WP[:3, :3].T + part.X_WP[:3, 3]) @ axis
    return float(heights.min()), float(heights.max())


def slips(design: Design) -> tuple[Slip, ...]:
    """First time at which each joint with a slide has left the last of the patches along which it slides."""
    from kinform.kinematics.mobility.guides import guide

    run, kinematics, contacts = design.simulation, design.kinematics, design.contacts
    assert run is not None and kinematics is not None and contacts is not None
    parts = {body.name: body.parts for body in kinematics.bodies}
    out = []
    for joint in kinematics.joints:
        if joint.type not in SLIDES or joint.name not in run.joint_names or joint.axis is None or is_stated(joint):
            continue
        index = run.joint_names.index(joint.name)
        values = run.joint_position[:, int(run.joint_offset[index]) + SLIDES[joint.type]]
        low, high = guide(design.assembly, design.surfaces, contacts, _sliding(joint), parts[joint.bodies[1]])
        beyond = np.flatnonzero((values < low) | (values > high))
        if len(beyond):
            value = float(values[beyond[0]])
            out.append(Slip(joint, float(run.time[beyond[0]]), value, low if value < low else high))
    return tuple(out)


def _sliding(joint: Joint) -> Joint:
    """A cylindrical joint as a guide sees it."""
    return replace(joint, type="prismatic") if joint.type == "cylindrical" else joint

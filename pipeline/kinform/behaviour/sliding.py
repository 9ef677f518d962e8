"""What rubs in a joint as its contact patches show it: radii, ends, the angle of a thread, and which materials meet.

A journal is a coaxial cylinder; its ends are those of the overlap of both surfaces, and go along with the shorter one.
A thrust ring is a flat patch across the axis: its mean radius is that of a load spread evenly over it. A thread is a
helicoid: mean radius and lean of the flanks are those of its samples, each as it bears along the axis, which crests and
roots do not. A guide between flat faces has their normals. What several unlike surfaces would share (journals of
different radii, cones, a guide with faces in three directions) is not determined by rigid bodies: then there is no
radius but the reason, and the manifest can state it, each for itself.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field, replace

import numpy as np

from kinform.behaviour.rubbing import Rubs
from kinform.foundation.words import listed
from kinform.frozen import dataclass
from kinform.kinematics.mobility.guides import span_along
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts, Patch
from kinform.model.function import ARMS, Drive, friction_arms
from kinform.model.kinematics import Joint, Kinematics
from kinform.model.names import BodyName
from kinform.model.surfaces import MeshSurfaces

ALONG_AXIS = 0.9998
"""Cosine of the angle (1.1°) up to which a surface counts as along, or across, the axis of its joint for friction: what
contact takes for one axis agrees far better, and other faces stand at degrees."""
ALIKE_RADII = 0.02
"""Share by which radii of journals, or of thrust rings, may differ and count as one; coefficients are known worse."""
MATERIAL_PAIRS: dict[tuple[str, str], tuple[float, float]] = {
    ("aluminium", "steel"): (0.47, 0.61),
    ("brass", "steel"): (0.44, 0.51),
    ("copper", "steel"): (0.36, 0.53),
    ("glass", "glass"): (0.40, 0.94),
    ("ptfe", "ptfe"): (0.04, 0.04),
    ("ptfe", "steel"): (0.04, 0.04),
    ("steel", "steel"): (0.57, 0.74),
}
"""(in motion, at rest) of clean and dry pairs of materials, sorted, as tables of general physics have them (Serway and
Jewett, Physics for Scientists and Engineers, table 5.1; Marks' Standard Handbook for Mechanical Engineers, section 3.2,
for brass and for PTFE on steel). Lubrication, finish and wear change them several times over: runs name what they
took, and a [[friction]] of the manifest goes before."""


@dataclass(frozen=True, eq=False)
class Sliding:
    """What is known of the sliding surfaces of a joint."""

    rubs: Rubs = field(default_factory=Rubs)
    open: Mapping[str, str] = field(default_factory=dict)
    """Why what contact shows does not say what rubs, by the key of the manifest that says it instead."""
    pairs: tuple[tuple[str | None, str | None], ...] = ()
    """Materials that meet, sorted."""
    known: frozenset[tuple[float, float]] = frozenset()
    """(in motion, at rest) of those whose friction is known, ..."""
    unknown: tuple[tuple[str, str], ...] = ()
    """... and those whose friction is not, sorted."""
    riding: bool = False
    """Whether a length that is stated goes along with the second body: the second of `between`."""

    def coefficients(self) -> tuple[float, float]:
        """(in motion, at rest) of the materials. Raises ValueError where they are not known, or differ."""
        if not self.pairs:
            raise ValueError("state its coefficient or its effort: no contact tells which materials meet")
        for first, second in self.pairs:
            if first is None or second is None:
                raise ValueError("state its coefficient: a part in contact has no material")
        for first, second in self.unknown:
            raise ValueError(
                f"the friction of {first} on {second} is not known: state its coefficient, or a [[friction]]"
            )
        if len(self.known) > 1:
            raise ValueError("its contacts are of materials with different friction: state its coefficient")
        (one,) = self.known
        return one

    def stated(self, drive: Drive, kind: str, freedom: str) -> Rubs:
        """What rubs in a joint of this kind, along this freedom, with what the drive states in place of what contact
        shows. Raises ValueError with what neither says, and with what is stated to no effect."""
        acting = friction_arms(kind, freedom)
        idle = sorted(ARMS & drive.parameters.keys() - acting)
        if idle:
            has = f"{listed(sorted(acting))} would" if acting else "no length or radius does"
            raise ValueError(f"{idle[0]} does nothing on the {freedom} of a {kind} joint: {has}")
        given, metres = drive.parameters, drive.metres_per_unit
        open_ = {key if key in acting else "length": why for key, why in self.open.items()}
        missing = [key for key in open_ if key not in given]
        if missing:
            keys = " and ".join(f"its {key}" for key in missing)
            raise ValueError(f"{open_[missing[0]]}: state {keys}, or its friction as an effort")
        out = self.rubs
        if "radius" in given:
            out = replace(out, radius=given["radius"] * metres)
        if "thrust_radius" in given:
            out = replace(out, thrust=given["thrust_radius"] * metres)
        if "flank" in given:
            out = replace(out, flank=math.radians(given["flank"]))
        if "length" in given:
            half = 0.5 * given["length"] * metres
            riding = out.riding if out.upper > out.lower else self.riding
            out = replace(out, lower=-half, upper=half, riding=riding, offset=np.zeros(3))
        return out


def sliding_joints(
    assembly: Assembly, kinematics: Kinematics, contacts: Contacts | None, surfaces: Mapping[str, MeshSurfaces]
) -> dict[str, Sliding]:
    """What rubs in each joint, by its name; nothing where no friction is asked for."""
    if not any(drive.kind == "friction" for drive in assembly.function.drives):
        return {}
    parts = {body.name: body.parts for body in kinematics.bodies}
    turned = _turned(assembly, kinematics)
    out: dict[str, Sliding] = {}
    for joint in kinematics.joints:
        patches = [] if contacts is None else [contacts.patches[k] for k in joint.patches]
        meeting = {(_materials(assembly, patch), _shared_scope(patch)) for patch in patches}
        pairs = {pair for pair, _ in meeting}
        ordered = tuple(sorted(pairs, key=lambda pair: tuple(name or "" for name in pair)))
        found = {(pair, scope): _friction(assembly, pair, scope) for pair, scope in meeting}
        unknown = {(a, b) for ((a, b), _), friction in found.items() if a and b and friction is None}
        known = frozenset(friction for friction in found.values() if friction is not None)
        riding = joint.bodies not in turned
        doubts: dict[str, str] = {}
        rubs = _rubs(assembly, surfaces, joint, patches, parts[joint.bodies[1]], doubts, riding=riding)
        out[str(joint.name)] = Sliding(rubs, doubts, ordered, known, tuple(sorted(unknown)), riding)
    return out


def _turned(assembly: Assembly, kinematics: Kinematics) -> set[tuple[BodyName, BodyName]]:
    """Pairs of bodies whose joint states their first one, by name, as the second of `between`."""
    body_of = {part: body.name for body in kinematics.bodies for part in body.parts}
    both = [joint.between for joint in assembly.function.joints if len(joint.between) == 2]
    sides = [[body_of[assembly.parts_of(name)[0]] for name in names] for names in both]
    return {(second, first) for first, second in sides if second < first}


def _materials(assembly: Assembly, patch: Patch) -> tuple[str | None, str | None]:
    first, second = (assembly.part(name).material for name in patch.parts)
    return (first, second) if (first or "") <= (second or "") else (second, first)


def _shared_scope(patch: Patch) -> str:
    """The prefix of the innermost sub-assembly that has both parts of a patch; empty: that is the whole."""
    one, other = (name.split("/")[:-1] for name in patch.parts)
    shared = 0
    while shared < min(len(one), len(other)) and one[shared] == other[shared]:
        shared += 1
    return "".join(f"{name}/" for name in one[:shared])


def _friction(assembly: Assembly, pair: tuple[str | None, str | None], scope: str) -> tuple[float, float] | None:
    """(in motion, at rest) of materials in a scope: as the innermost of what is about it states it, else as it is built
    in; None where it is not known."""
    stated = [one for one in assembly.function.frictions if tuple(sorted(one.materials)) == pair]
    about = [one for one in stated if scope.startswith(one.prefix)]
    if about:
        one = max(about, key=lambda friction: len(friction.prefix))
        return one.coefficient, one.static
    first, second = pair
    return None if first is None or second is None else MATERIAL_PAIRS.get((first, second))


def _rubs(
    assembly: Assembly,
    surfaces: Mapping[str, MeshSurfaces],
    joint: Joint,
    patches: Sequence[Patch],
    second: Iterable[str],
    doubts: dict[str, str],
    *,
    riding: bool,
) -> Rubs:
    """What rubs in one joint, as far as contact says; Rubs() without patches. `doubts` gets what it leaves open."""
    if not patches or joint.axis is None or joint.type not in ("revolute", "prismatic", "cylindrical", "screw"):
        return Rubs()
    if joint.type == "screw":
        return _thread(joint, [patch for patch in patches if patch.kind == "helicoid"], doubts)
    axis = joint.axis
    round_ = [p for p in patches if p.kind == "cylinder" and abs(float(p.axis @ axis)) > ALONG_AXIS]
    flat = [p for p in patches if p.kind == "plane"]
    rings = [p for p in flat if abs(float(p.axis @ axis)) > ALONG_AXIS]
    faces = [p for p in flat if p not in rings]
    if joint.type == "prismatic" and rings:
        faces, rings = flat, []
    others = [p.kind for p in patches if p not in round_ and p not in flat]
    if others or (faces and joint.type != "prismatic"):
        what = f"{others[0]} contact" if others else "flat faces"
        for key in ("length",) if joint.type == "prismatic" else ("radius", "thrust_radius"):
            doubts[key] = f"what presses on its {what} is not determined"
    bearing = round_ or faces or patches
    weights = np.concatenate([p.weights for p in bearing])
    centre = weights @ np.concatenate([p.points for p in bearing]) / weights.sum()
    base = np.zeros(3) if joint.point is None or not np.all(np.isfinite(joint.point)) else joint.point
    if joint.type != "prismatic":
        centre = base
    ends = _ends(assembly, surfaces, joint, round_ or faces, set(second), centre, riding=riding)
    out = replace(ends, offset=centre - base)
    slides = joint.type == "prismatic"
    if round_:
        apart = max(float(_distance(p.point[None], round_[0].point, axis)[0]) for p in round_)
        key = "length" if slides else "radius"
        if apart > ALIKE_RADII * min(p.radii[0] for p in round_):
            doubts.setdefault(key, "its journals lie on several axes, and how they share loads is open")
        radii = [0.5 * (p.radii[0] + p.radii[1]) for p in round_]
        out = replace(out, radius=_one_radius(radii, "journals", key, doubts))
    if rings:
        means = [float(p.weights @ _distance(p.points, base, axis) / p.weights.sum()) for p in rings]
        out = replace(out, thrust=_one_radius(means, "thrust rings", "thrust_radius", doubts))
    if slides and faces:
        twist, normals = _flat(faces, axis, centre, doubts, round_=bool(round_))
        out = replace(out, twist=twist, faces=normals)
    return out


def _thread(joint: Joint, patches: Sequence[Patch], doubts: dict[str, str]) -> Rubs:
    """Mean radius and lean of the flanks of a thread whose load is spread evenly over their depth, as the mean diameter
    of textbooks has it. A doubt where flanks that face either way lean differently: a saw thread carries on one of
    them."""
    if not patches:
        return Rubs()
    axis, base = joint.axis, joint.point
    assert axis is not None and base is not None
    points, normals, weights = (np.concatenate([getattr(p, name) for p in patches]) for name in _SAMPLES)
    # rings of one depth have areas in proportion to their radii
    away = _distance(points, base, axis)
    along, weights = normals @ axis, weights / away
    bearing = weights * np.abs(along)
    radius = float(bearing @ away / bearing.sum())
    out = points - base - ((points - base) @ axis)[:, None] * axis
    out /= away[:, None]
    pressed = weights * np.abs(np.einsum("ij,ij->i", normals, out))
    sides = [side for side in (along > 0.0, along < 0.0) if side.any()]
    leans = [math.atan(float(pressed[side].sum() / bearing[side].sum())) for side in sides]
    low, high = min(leans), max(leans)
    if 1.0 / math.cos(high) > (1.0 + ALIKE_RADII) / math.cos(low):
        told = f"its flanks lean by {math.degrees(low):.3g}° and {math.degrees(high):.3g}°, and which carries is open"
        doubts.setdefault("flank", told)
    return Rubs(radius=radius, flank=math.atan(float(pressed.sum() / bearing.sum())))


_SAMPLES = ("points", "normals", "weights")


def _distance(points: Array, base: Array, axis: Array) -> Array:
    """(n,) m of points from the axis."""
    return np.asarray(np.linalg.norm(np.cross(points - base, axis), axis=1))


def _one_radius(radii: Sequence[float], what: str, key: str, doubts: dict[str, str]) -> float:
    """The radius that all have; a doubt where they differ."""
    low, high = min(radii), max(radii)
    if high - low > ALIKE_RADII * high:
        told = f"its {what} have radii of {1e3 * low:.4g} to {1e3 * high:.4g} mm, and which carries is open"
        doubts.setdefault(key, told)
    return 0.5 * (low + high)


def _ends(
    assembly: Assembly,
    surfaces: Mapping[str, MeshSurfaces],
    joint: Joint,
    patches: Sequence[Patch],
    second: set[str],
    centre: Array,
    *,
    riding: bool,
) -> Rubs:
    """Both ends of what carries loads across the axis, from `centre`; they go along with the shorter surfaces, and of
    surfaces as long as each other with the second body, or not, as `riding` has it."""
    axis = joint.axis
    assert axis is not None
    low, high, longest = [], [], [0.0, 0.0]
    for patch in patches:
        spans = [span_along(assembly, surfaces, *side, axis) for side in zip(patch.parts, patch.surfaces, strict=True)]
        known = [span for span in spans if span is not None]
        if not known:
            continue
        low.append(max(span[0] for span in known))
        high.append(min(span[1] for span in known))
        for name, span in zip(patch.parts, spans, strict=True):
            if span is not None:
                side = int(name in second)
                longest[side] = max(longest[side], span[1] - span[0])
    if not low or max(high) <= min(low):
        return Rubs()
    at = float(centre @ axis)
    if abs(longest[1] - longest[0]) > ALIKE_RADII * max(longest):
        riding = longest[1] < longest[0]
    return Rubs(lower=min(low) - at, upper=max(high) - at, riding=riding)


def _flat(
    faces: Sequence[Patch], axis: Array, centre: Array, doubts: dict[str, str], *, round_: bool
) -> tuple[float, tuple[Array, Array] | None]:
    """The arm at which flat faces along a slide carry torques, and their normals where they carry forces too. A doubt
    where more than two directions share loads."""
    arm = max(float(np.abs(np.cross(p.points - centre, p.normals) @ axis).max()) for p in faces)
    lines: list[Array] = []
    for patch in faces:
        normal = patch.axis - (patch.axis @ axis) * axis
        normal = normal / np.linalg.norm(normal)
        if all(abs(float(normal @ other)) < ALONG_AXIS for other in lines):
            lines.append(normal)
    if round_:
        return arm, None
    if len(lines) != 2:
        told = f"its faces have normals in {len(lines)} directions, and how they share loads is open"
        doubts.setdefault("length", told)
        return 0.0, None
    return arm, (lines[0], lines[1])

"""What contact lets go in one sense alone, and whether that is a doubt.

The rows of a pair take every patch for a constraint in both senses, so that a face which a slider just touches holds
it. The cone of motions says what is free beside that (`motion_cone`). One sense alone is no doubt: a block rests on a
table, a lid lies in its pocket, a shaft on its collar. Where all contact opens by one motion the joint is what is at
rest. Else it depends on where the faces are that are left:

- A collar or shoulder lies round the guide and beyond it: the motion is meant to be held there.
- A face inside of the guide's own cross-section, at the end of a guide that is long enough to slide in, may be the
  bottom of a bore that a piston has reached, or the step bearing of a shaft. So may a face beside the axis.
- A face that opposes a turn in one sense is what the lever came to rest on.
- A round that holds a pin on one side only may be the end of its slot.
- A rim that stands in a seat beside a guide may be either: the head of a countersunk screw is tightened, a valve opens.

Where it may be either, both readings are kept, and the joint is ambiguous until something else chooses. So it is where
bodies without freedoms may leave each other in several ways, one at a time, as a pin in the corner of a slot does.

Whether a guide is long enough to slide in is the rule for bushings: shorter than half of its width it jams, as friction
at its edges then holds any load beside its axis (W. Beitz, K.-H. Küttner, Dubbel, guides).
"""

from __future__ import annotations

import math

import numpy as np

from kinform.foundation.algebra.vectors import cross, perpendicular, sine, widest_turn
from kinform.frozen import dataclass
from kinform.kinematics.joints.pair.evidence import COAXIAL, Evidence, Item
from kinform.kinematics.joints.pair.freedoms import freedoms_beyond
from kinform.kinematics.joints.pair.in_step import Steps
from kinform.kinematics.joints.pair.lower_pairs import JointForm
from kinform.kinematics.joints.pair.motion_cone import MotionCone
from kinform.model.arrays import Array, Flags
from kinform.model.kinematics import ReadingCause
from kinform.model.tolerances import Tolerances

ONE_WAY = 1.0 - 1e-4
"""Cosine of normals of faces that look one way: 0.8°. Chosen, not measured."""
LEAST_PART = 0.1
"""Share of a candidate motion that is in what is asked about from which on it counts. Chosen, not measured."""
ALIKE = math.cos(math.radians(15.0))
"""Cosine between motions that are one but for slack: rounds have bins of normals of up to 15°."""
ALONG_AXIS = 0.01
"""Normals and axes this near (sine) to an axis are along it. Chosen, not measured."""
OPPOSING_SPEED = 0.05
"""Share of a patch's greatest normal speed that is opposition, and no rounding beside it. Chosen, not measured."""
SLIDES_FROM = 0.5
"""Length of a guide over its width from which on it slides and does not jam. Chosen, not measured."""
RAM_FROM = 2.0
"""The same, from which on a shaft that ends at the bottom of its bore may slide although a collar ends there, too.
Pivots are one to two diameters long, as horns on their servos are; guides that slide are twice as long as wide at
least."""
ONE_SECTION = 0.05
"""Relative difference of radii that are one cross-section. Chosen, not measured."""
INSIDE_GUIDE = 1.05
"""Faces that reach no further than this, in half widths of the guide, are inside of its cross-section. Chosen, not
measured."""
ROUND_FROM = 0.3
"""Points of a face beyond this share of its reach show whether it goes round the axis. Chosen, not measured."""
HALF_ROUND = math.radians(175.0)
"""rad without any normal about the axis up to which a journal goes more than half round: half a turn less 5°, by which
facets of 72 sides round the ends of a half bearing. Chosen, not measured."""
BESIDE_AXIS = math.radians(200.0)
"""rad without any of a face about the axis, beyond which it lies beside it. Half a turn, and 20° for facets."""


ROLES = {
    "stop": "an end stop",
    "sliver": "too slight to decide",
    "flank": "the flank of a tooth or cam, which bears nothing",
    "prism": "those of a prism",
    "pin": "of a pin that has play in its slot",
    "bend": "a line along which a roller lies in its ring",
}
"""What faces are that may not be meant to hold."""


@dataclass(frozen=True, eq=False)
class OtherReading:
    """What the patches say without some that may not be meant."""

    form: JointForm
    basis: Array
    """(6, k) scaled freedoms."""
    out: tuple[int, ...]
    """Items that are left out."""
    role: ReadingCause
    """What those are then: stop, sliver, flank or pin. prism: nothing is left out; flats do not let the bodies
    turn. bend: nor here; a roller turns less in its ring than its line says."""


def stop_reading(
    evidence: Evidence, twists: Array, preserved: Flags, strict: Array, tolerances: Tolerances, cone: MotionCone
) -> Steps[OtherReading | None]:
    """The other reading of a pair whose freedoms are `strict` (6, k), where what it lets go in one sense may be meant;
    None where not.

    `twists` (6, n) are candidate motions, `preserved` (items, n) which patches slide on themselves under them.
    """
    if cone.extra > 1 and strict.shape[1] == 1:
        return (yield from _short_face(evidence, twists, preserved, strict, tolerances, cone))
    if not cone.extra or cone.plainly_open or cone.opened.all():
        return None
    if cone.extra > 1:
        return (
            None if strict.shape[1] else (yield from _end_of_some_guide(evidence, twists, preserved, tolerances, cone))
        )
    keep = ~cone.opened
    _, freed = yield from freedoms_beyond(evidence, twists, preserved, keep, tolerances, strict)
    basis = cone.exactly(freed).closed
    if not freed.shape[1] or basis is cone.closed:
        return None
    if freed.shape[1] > 1:
        basis = np.column_stack([strict, _nearest(basis[:, -1], freed, twists[:, preserved[keep].all(axis=0)])])
    out = tuple(int(k) for k in np.flatnonzero(cone.opened))
    reading = OtherReading(evidence.form(basis), basis, out, "stop")
    turned = {"fixed": ("revolute",), "prismatic": ("cylindrical",)}
    if reading.form.type in turned.get(evidence.form(strict).type, ()):
        return reading
    faces = evidence.chosen(cone.opened)
    if not strict.shape[1] and any(i.patch.kind in ("cylinder", "sphere") and not i.patch.one_sided for i in faces):
        return reading
    return reading if _ends_guide(reading.form, evidence.chosen(keep), faces) else None


def _end_of_some_guide(
    evidence: Evidence, twists: Array, preserved: Flags, tolerances: Tolerances, cone: MotionCone
) -> Steps[OtherReading | None]:
    """The slide of a pair without freedoms that faces which look one way end, where the rest of the contact is its
    guide; of several the one that ends on the least area."""
    nothing = np.zeros((6, 0))
    left = [k for k in np.flatnonzero(cone.opened).tolist() if evidence.items[k].patch.kind == "plane"]
    readings: list[tuple[float, OtherReading]] = []
    while left:
        normal = evidence.items[left[0]].normals[0]
        out = tuple(k for k in left if float(evidence.items[k].normals[0] @ normal) > ONE_WAY)
        left = [k for k in left if k not in out]
        keep = np.ones(len(evidence.items), dtype=bool)
        keep[list(out)] = False
        basis, freed = yield from freedoms_beyond(evidence, twists, preserved, keep, tolerances, nothing)
        form = evidence.form(basis)
        if freed.shape[1] == 1 and _ends_guide(form, evidence.chosen(keep), evidence.chosen(~keep)):
            readings.append((sum(evidence.items[k].area for k in out), OtherReading(form, basis, out, "stop")))
    return min(readings, key=lambda one: one[0])[1] if readings else None


def _nearest(motion: Array, freed: Array, candidates: Array) -> Array:
    """(6,) unit: of the candidates (6, n), within the motions freed (6, k), the one that is this motion but for slack;
    the motion itself where none is."""
    within = freed.T @ candidates
    size = np.linalg.norm(within, axis=0)
    within = within[:, size > LEAST_PART] / size[size > LEAST_PART]
    if not within.shape[1]:
        return motion
    alike = np.abs(within.T @ (freed.T @ motion))
    best = int(alike.argmax())
    return np.asarray(freed @ within[:, best]) if alike[best] > ALIKE else motion


def leaves_several_ways(cone: MotionCone) -> bool:
    """Whether bodies without freedoms may leave each other in several ways, no one of which opens all contact."""
    return not cone.rest.shape[1] and cone.extra > 1 and not cone.plainly_open


def seat_reading(
    evidence: Evidence, twists: Array, preserved: Flags, strict: Array, sure: Flags, tolerances: Tolerances
) -> Steps[OtherReading | None]:
    """The other reading of a pair whose freedoms are `strict` (6, k), if surfaces that are known (`sure` (items,)) hold
    all of it but one motion, and the rest, such as a rim in its seat or facets of no known surface, ends that in one
    sense; None if not."""
    if sure.all() or not sure.any():
        return None
    basis, freed = yield from freedoms_beyond(evidence, twists, preserved, sure, tolerances, strict)
    out = tuple(int(k) for k in np.flatnonzero(~sure))
    if freed.shape[1] != 1 or not one_sense(evidence, freed[:, 0], out):
        return None
    return OtherReading(evidence.form(basis), basis, out, "stop")


def one_sense(evidence: Evidence, motion: Array, out: tuple[int, ...]) -> bool:
    """Do the items oppose the motion (6,) in one sense only?"""
    speeds = np.concatenate([evidence.rows[evidence.start[k] : evidence.start[k + 1]] @ motion for k in out])
    most, least = float(speeds.max()), float(speeds.min())
    large = OPPOSING_SPEED * max(most, -least)
    return not (most > large and least < -large)


def _short_face(
    evidence: Evidence, twists: Array, preserved: Flags, strict: Array, tolerances: Tolerances, cone: MotionCone
) -> Steps[OtherReading | None]:
    """The planar motion of a slide along cheeks, or along one flush face, where faces that push one way keep it from
    turning there and are too short to guide it over the reach of the cheeks: they may end its turn, as a stop ends that
    of a finger or a knee; None where they guide it."""
    slide = evidence.form(strict)
    if slide.type != "prismatic" or slide.axis is None or any(item.patch.kind != "plane" for item in evidence.items):
        return None
    for cheek in sorted(evidence.items, key=lambda item: -item.patch.area):
        normal = cheek.patch.axis
        keep = np.array([abs(float(item.patch.axis @ normal)) > ONE_WAY for item in evidence.items])
        if keep.all() or not cone.opened[~keep].all():
            continue
        reach = _extent(np.concatenate([i.points for i in evidence.chosen(keep)]), cross(normal, slide.axis))
        if _extent(np.concatenate([i.points for i in evidence.chosen(~keep)]), slide.axis) >= SLIDES_FROM * reach:
            continue
        basis, freed = yield from freedoms_beyond(evidence, twists, preserved, keep, tolerances, strict)
        if freed.shape[1] == 2 and evidence.form(basis).type == "planar":
            return OtherReading(evidence.form(basis), basis, tuple(np.flatnonzero(~keep).tolist()), "stop")
    return None


@dataclass(frozen=True, eq=False)
class _End:
    """Faces at the end of a guide that is long enough to slide in."""

    inside: bool
    """Of its cross-section; of a long guide one of them: a ram that is drawn in ends at its bottom and its collar."""
    beside: bool
    """Beside its axis."""


def _ends_guide(form: JointForm, guides: list[Item], faces: list[Item]) -> bool:
    """Are the faces at the end of a guide along the joint's axis, inside of its cross-section or beside its axis?"""
    end = _end_of_guide(form, guides, faces)
    return end is not None and (end.inside or end.beside)


def _end_of_guide(form: JointForm, guides: list[Item], faces: list[Item]) -> _End | None:
    """Where faces are at the end of a guide along the joint's axis; None where there is none, or it is too short."""
    axis = form.axis
    if axis is None:
        return None
    running = [i for i in guides if i.patch.kind in (*COAXIAL, "extrusion", "plane") and _runs_along(i, axis)]
    if form.type not in ("cylindrical", "prismatic") or not running:
        return None
    centre = form.point if form.type == "cylindrical" else None
    if centre is None:
        centre = np.concatenate([i.points for i in running]).mean(axis=0)
    across = np.array(perpendicular(axis)).T
    lengths = [
        (_extent(section, axis), float(_distances((section - centre) @ across).max())) for section in _sections(running)
    ]
    if all(length < SLIDES_FROM * 2.0 * half for length, half in lengths):
        return None
    ends = [(item.points - centre) @ across for item in faces]
    away = [_distances(end) for end in ends]
    every, apart = np.concatenate(ends), np.concatenate(away)
    far = every[apart > ROUND_FROM * apart.max()]
    half, long = max(half for _, half in lengths), any(length >= RAM_FROM * 2.0 * half for length, half in lengths)
    bottom = long and any(one.max() <= INSIDE_GUIDE * half and one.mean() < half for one in away)
    inside = bottom or float(apart.max()) <= INSIDE_GUIDE * half
    return _End(inside, widest_turn(np.arctan2(far[:, 1], far[:, 0])) > BESIDE_AXIS)


def _extent(points: Array, axis: Array) -> float:
    """m: how far the points (n, 3) reach along the axis."""
    along = points @ axis
    return float(along.max() - along.min())


def _distances(across: Array) -> Array:
    """(n,) m from the axis, of what is seen along it (n, 2)."""
    return np.asarray(np.sqrt(across[:, 0] ** 2 + across[:, 1] ** 2))


def _sections(running: list[Item]) -> list[Array]:
    """Points of guides of one cross-section: a stepped shaft that slides leaves its steps behind."""
    rounds: list[tuple[float, list[Array]]] = []
    flat = [item.points for item in running if item.patch.kind != "cylinder"]
    for item in running:
        if item.patch.kind != "cylinder":
            continue
        radius = max(item.patch.radii)
        same = next((of for r, of in rounds if abs(r - radius) <= ONE_SECTION * r), None)
        if same is None:
            rounds.append((radius, [item.points]))
        else:
            same.append(item.points)
    return [np.concatenate(of) for of in (*(of for _, of in rounds), flat) if of]


def _runs_along(item: Item, axis: Array) -> bool:
    """Does the patch slide on itself along the axis?"""
    if item.patch.kind == "plane":
        return abs(float(item.patch.axis @ axis)) < ALONG_AXIS
    return sine(item.patch.axis, axis) < ALONG_AXIS


def faces_in_words(evidence: Evidence, out: tuple[int, ...]) -> str:
    """Patches in words: "the plane of 12.5 mm² between base and rod"."""
    items = [evidence.items[k] for k in out]
    area = 1e6 * sum(item.patch.area for item in items)
    largest = max(items, key=lambda item: (item.patch.area, item.patch.parts))
    kinds = largest.patch.kind if len(items) == 1 else f"{largest.patch.kind} (in {len(items)} pieces)"
    return f"the {kinds} of {area:.3g} mm² between {' and '.join(largest.patch.parts)}"

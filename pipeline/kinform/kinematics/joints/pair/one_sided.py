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
from collections.abc import Iterator

import numpy as np

from kinform.foundation.algebra.vectors import cross, norm, perpendicular, sine, widest_gap, widest_turn
from kinform.foundation.words import counted
from kinform.kinematics.joints.pair.constants import ALONG_AXIS, OPPOSING_SPEED
from kinform.kinematics.joints.pair.evidence import COAXIAL, Evidence, Item
from kinform.kinematics.joints.pair.freedoms import NEW_FREEDOM
from kinform.kinematics.joints.pair.hypotheses import Motion
from kinform.kinematics.joints.pair.lower_pairs import JointForm
from kinform.kinematics.joints.pair.motion_cone import SLIDES
from kinform.kinematics.joints.pair.suspects import AtRest, Suspect, suspect
from kinform.kinematics.joints.pair.touches import TOUCHING
from kinform.model.arrays import Array, Flags

ONE_WAY = 1.0 - 1e-4
"""Cosine of normals of faces that look one way: 0.8°. Chosen, not measured."""
LEAST_PART = 0.1
"""Share of a candidate motion that is in what is asked about from which on it counts. Chosen, not measured."""
ALIKE = math.cos(math.radians(15.0))
"""Cosine between motions that are one but for slack: rounds have bins of normals of up to 15°."""
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
IN_CLOSED = 0.1
"""Share of a motion that may be outside of what is closed, which is known to slack only. Chosen, not measured."""


def seats(pair: AtRest) -> Iterator[Suspect]:
    """What is of no surface that is known for certain beside what is: a rim in its seat, facets of no known surface."""
    if not pair.touching and pair.sure.any() and not pair.sure.all():
        yield suspect(~pair.sure, "stop")


def ends_one_motion(pair: AtRest, of: Suspect, free: Array, freed: Array) -> Array | None:
    """What is free without suspects that end one motion in one sense."""
    return free if freed.shape[1] == 1 and opposes_one_way(pair.evidence, freed[:, 0], of.items) else None


def opposes_one_way(evidence: Evidence, motion: Array, items: tuple[int, ...]) -> bool:
    """Do the items oppose the motion (6,) in one sense only?"""
    speeds = np.concatenate([evidence.rows[evidence.start[k] : evidence.start[k + 1]] @ motion for k in items])
    most, least = float(speeds.max()), float(speeds.min())
    large = OPPOSING_SPEED * max(most, -least)
    return not (most > large and least < -large)


def ends(pair: AtRest) -> Iterator[Suspect]:
    """Contact that one motion opens, or, of bodies without freedoms that may leave each other in several ways, faces
    that look one way, the least area first."""
    cone, items = pair.cone, pair.evidence.items
    if not cone.extra or cone.plainly_open or cone.opened.all():
        return
    if cone.extra == 1:
        yield suspect(cone.opened, "stop")
        return
    left = [k for k in np.flatnonzero(cone.opened).tolist() if items[k].patch.kind == "plane" and not pair.count]
    alike = []
    while left:
        normal = items[left[0]].normals[0]
        alike.append(tuple(k for k in left if float(items[k].normals[0] @ normal) > ONE_WAY))
        left = [k for k in left if k not in alike[-1]]
    for out in sorted(alike, key=lambda out: sum(items[k].area for k in out)):
        yield Suspect(out, "stop")


def at_end_of_guide(pair: AtRest, of: Suspect, free: Array, freed: Array) -> Array | None:
    """What is free without faces that end a guide, or that a turn or a round leaves."""
    evidence, cone = pair.evidence, pair.cone
    faces = [evidence.items[k] for k in of.items]
    guides = [item for k, item in enumerate(evidence.items) if k not in of.items]
    if cone.extra > 1:
        return free if freed.shape[1] == 1 and _ends_guide(evidence.form(free), guides, faces) else None
    basis = cone.exactly(freed).closed
    if basis is cone.closed:
        return None
    if freed.shape[1] > 1:
        kept = pair.preserved[~cone.opened].all(axis=0)
        basis = np.column_stack([pair.basis, _nearest(basis[:, -1], freed, pair.twists[:, kept])])
    form = evidence.form(basis)
    turned = (pair.form.type, form.type) in (("fixed", "revolute"), ("prismatic", "cylindrical"))
    round_end = not pair.count and any(i.patch.kind in ("cylinder", "sphere") and not i.patch.one_sided for i in faces)
    return basis if turned or round_end or _ends_guide(form, guides, faces) else None


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


def short_faces(pair: AtRest) -> Iterator[Suspect]:
    """Faces that push one way and keep what slides along cheeks, or along one flush face, from turning there, and are
    too short to guide it over the reach of the cheeks: they may end its turn, as a stop ends that of a finger."""
    items, axis = pair.evidence.items, pair.form.axis
    planes = all(item.patch.kind == "plane" for item in items)
    if pair.form.type != "prismatic" or axis is None or pair.cone.extra < 2 or not planes:
        return
    for cheek in sorted(items, key=lambda item: -item.patch.area):
        normal = cheek.patch.axis
        keep = np.array([abs(float(item.patch.axis @ normal)) > ONE_WAY for item in items])
        if keep.all() or not pair.cone.opened[~keep].all():
            continue
        side = cross(normal, axis)
        wide, long = (np.concatenate([i.points for i in pair.evidence.chosen(of)]) for of in (keep, ~keep))
        facing = np.array([float(i.normals[0] @ side) for i in pair.evidence.chosen(~keep)])
        one_way = not facing.min() < 0.0 < facing.max()  # a ridge holds in both senses
        if one_way and _extent(long, axis) < SLIDES_FROM * _extent(wide, side):
            yield suspect(~keep, "stop")


def leaves_plane(pair: AtRest, of: Suspect, free: Array, freed: Array) -> Array | None:
    """What is free, of bodies that move in a plane without the suspects."""
    return free if freed.shape[1] == 2 and pair.evidence.form(free).type == "planar" else None


def turns_ended(pair: AtRest) -> Iterator[Suspect]:
    """What ends a turn about a surface that goes no more than half round, best supported first."""
    if pair.cone.extra and not pair.cone.plainly_open:
        for _, out, journal in new_turns(pair):
            if not journal:
                yield suspect(out, "stop")


def new_turns(pair: AtRest) -> Iterator[tuple[Motion, Flags, bool]]:
    """Turns about curved surfaces that are no freedoms at rest, and that some patch preserves, best supported first;
    what ends them (items,), and whether the rest goes more than half round the axis."""
    some = pair.preserved.any(axis=0) & ~pair.preserved.all(axis=0)
    for n in np.flatnonzero(some).tolist():
        motion, out = pair.candidates[n], ~pair.preserved[:, n]
        if not motion.turn or not motion.curved or motion.pitch or _in_corner(pair.evidence, out):
            continue
        if norm(motion.twist - pair.basis @ (pair.basis.T @ motion.twist)) > NEW_FREEDOM:
            yield motion, out, _journal(pair.evidence.chosen(~out), motion)


def _in_corner(evidence: Evidence, out: Flags) -> bool:
    """Would a pin be taken off one wall that stays at another? Which of them it leaves is not known."""
    held, left = (
        {(item.patch.parts[k], item.patch.surfaces[k]) for item in of for k in (0, 1) if item.patch.radii[k] > 0.0}
        for of in ([i for i in evidence.chosen(flags) if i.patch.kind in TOUCHING] for flags in (~out, out))
    )
    return not held.isdisjoint(left)


def lets_turn(pair: AtRest, of: Suspect, free: Array, freed: Array) -> Array | None:
    """What is free, whose new motions are turns that contact lets go in some sense."""
    turning = np.linalg.svd(freed[:3], compute_uv=False).min() > SLIDES
    missed = free - pair.cone.closed @ (pair.cone.closed.T @ free)
    return free if turning and np.linalg.norm(missed, axis=0).max() < IN_CLOSED else None


def _journal(kept: list[Item], motion: Motion) -> bool:
    """Do surfaces that both bodies have go more than half round the axis of the turn, all of them together, or a ball
    more than half round its centre?"""
    rounds = [item for item in kept if not item.patch.one_sided]
    about = [
        item.normals
        for item in rounds
        if item.patch.kind in COAXIAL and sine(item.patch.axis, motion.axis) < ALONG_AXIS
    ]
    if about and widest_gap(np.concatenate(about), motion.axis) < HALF_ROUND:
        return True
    return any(
        item.patch.kind == "sphere" and float((item.normals @ item.normals.mean(axis=0)).min()) < 0.0 for item in rounds
    )


def several_ways(pair: AtRest) -> Iterator[Suspect]:
    """What bodies without freedoms leave in several ways, no one of which opens all contact."""
    cone = pair.cone
    if not pair.count and cone.extra > 1 and not cone.plainly_open:
        words = f"{counted(cone.extra, 'motion')} beside that go one way only, and no one opens all of it"
        yield suspect(cone.holding, "doubt", f"fixed while all contact holds; {words}")


def _ends_guide(form: JointForm, guides: list[Item], faces: list[Item]) -> bool:
    """Are the faces at the end of a guide along the joint's axis that is long enough to slide in, inside of its
    cross-section or beside its axis?"""
    axis = form.axis
    if axis is None:
        return False
    running = [i for i in guides if i.patch.kind in (*COAXIAL, "extrusion", "plane") and _runs_along(i, axis)]
    if form.type not in ("cylindrical", "prismatic") or not running:
        return False
    centre = form.point if form.type == "cylindrical" else None
    if centre is None:
        centre = np.concatenate([i.points for i in running]).mean(axis=0)
    across = np.array(perpendicular(axis)).T
    lengths = [
        (_extent(section, axis), float(_distances((section - centre) @ across).max())) for section in _sections(running)
    ]
    if all(length < SLIDES_FROM * 2.0 * half for length, half in lengths):
        return False
    ends = [(item.points - centre) @ across for item in faces]
    away = [_distances(end) for end in ends]
    every, apart = np.concatenate(ends), np.concatenate(away)
    far = every[apart > ROUND_FROM * apart.max()]
    half, long = max(half for _, half in lengths), any(length >= RAM_FROM * 2.0 * half for length, half in lengths)
    bottom = long and any(one.max() <= INSIDE_GUIDE * half and one.mean() < half for one in away)
    inside = bottom or float(apart.max()) <= INSIDE_GUIDE * half
    return inside or widest_turn(np.arctan2(far[:, 1], far[:, 0])) > BESIDE_AXIS


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

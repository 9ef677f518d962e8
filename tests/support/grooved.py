"""Pins, keys, balls and followers in slots and grooves, two solids each, with what they may do relative to each other.

Lengths are in mm. Every mechanism states the motions that its joint leaves while the pin is where it is drawn: as
bases of twists (k, 6), (ω; v at the origin), any of which is a right answer. None: whatever is certain is wrong.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import manifold3d
import numpy as np
from manifold3d import CrossSection, Manifold

from support.solids import box, rod

Z = np.array([0.0, 0.0, 1.0])
SHAFT, WALL, HALF = 8.0, 13.0, 15.0
"""mm: radii of the shaft and outside of the sleeve, half the length of the sleeve."""


@dataclass(frozen=True)
class Pin:
    """What runs in a slot: its radius (mm), the play of its slot as a share of its diameter, its facets."""

    radius: float = 1.5
    play: float = 0.0
    segments: int = 32
    phase: float = 0.0

    @property
    def slot(self) -> float:
        """mm: half the width of the slot."""
        return self.radius * (1.0 + self.play)


@dataclass(frozen=True)
class Grooved:
    """Two solids and the motions (k, 6) of the second one relative to the first that are a right answer."""

    name: str
    first: Manifold
    second: Manifold
    right: tuple[np.ndarray, ...]


def turn(point=(0.0, 0.0, 0.0), axis=Z, lead=0.0):
    """Twist (6,) of a turn about an axis, that advances by `lead` mm a radian."""
    axis = np.asarray(axis, float)
    return np.concatenate([axis, np.cross(np.asarray(point, float), axis) + lead * axis])


def slide(along=Z):
    return np.concatenate([np.zeros(3), np.asarray(along, float)])


def union(solids) -> Manifold:
    return Manifold.batch_boolean(list(solids), manifold3d.OpType.Add)


def milled(cutter: Manifold, poses) -> Manifold:
    """What a convex cutter takes away between neighbouring poses (angle in degrees about z, height)."""
    placed = [cutter.rotate((0, 0, angle)).translate((0, 0, height)) for angle, height in poses]
    if len(placed) == 1:
        return placed[0]
    return union(Manifold.batch_hull([a, b]) for a, b in zip(placed, placed[1:], strict=False))


def cross_pin(pin: Pin, radius: float, start: float, end: float, segments=None) -> Manifold:
    """A pin along x."""
    return rod(radius, start, end, segments or pin.segments, pin.phase).rotate((0, 90, 0))


def shaft(pin: Pin, nose="pin") -> Manifold:
    """A shaft with a cross pin or a ball on its side, along x."""
    body = rod(SHAFT, -30, 30, 60, 3.0)
    if nose == "ball":
        return body + ball(pin.radius, pin.segments, pin.phase).translate((SHAFT + 0.3 * pin.radius, 0, 0))
    return body + cross_pin(pin, pin.radius, SHAFT - 3, WALL - 0.5)


def ball(radius, segments, phase=0.0) -> Manifold:
    count = max(segments, 12)
    half = np.linspace(-np.pi / 2, np.pi / 2, count // 2 + 1)
    outline = np.stack([radius * np.cos(half), radius * np.sin(half)], axis=1)
    outline[[0, -1], 0] = 0.0
    return Manifold.revolve(CrossSection([outline]), count).rotate((0, 0, phase))


def sleeve(half=HALF) -> Manifold:
    return rod(WALL + 2, -half, half, 72) - rod(SHAFT, -half - 1, half + 1, 64)


def arcs(start, end, step=4.0):
    return np.linspace(start, end, max(2, int(abs(end - start) / step) + 1))


def in_sleeve(name, pin, poses, right, cutter=None, nose="pin", half=HALF) -> Grooved:
    if cutter is None:
        cutter = cross_pin(pin, pin.slot, SHAFT - 4, WALL + 4)
    return Grooved(name, sleeve(half) - milled(cutter, poses), shaft(pin, nose), right)


def axial(pin: Pin) -> Grooved:
    return in_sleeve("axial slot", pin, [(0, -7), (0, 7)], (np.array([slide()]),))


def open_axial(pin: Pin) -> Grooved:
    return in_sleeve("open axial slot", pin, [(0, -20), (0, 7)], (np.array([slide()]),))


def axial_end(pin: Pin) -> Grooved:
    """At the rounded end of its slot."""
    return in_sleeve("end of an axial slot", pin, [(0, -10), (0, pin.radius * pin.play)], (np.array([slide()]),))


def square_end(pin: Pin) -> Grooved:
    """At the square end of its slot."""
    slot = box(SHAFT - 4, WALL + 4, -pin.slot, pin.slot, -pin.slot, 10)
    return Grooved(
        "square end", sleeve() - slot.translate((0, 0, pin.radius * pin.play)), shaft(pin), (np.array([slide()]),)
    )


def square_corner(pin: Pin) -> Grooved:
    """At the corner of two walls, free to go away from either."""
    wide = 8.0
    slot = box(SHAFT - 4, WALL + 4, -pin.radius, wide, -pin.radius, wide)
    return Grooved("square corner", sleeve() - slot, shaft(pin), ())


def key_corner(pin: Pin) -> Grooved:
    """A key at the corner of two walls."""
    keyed = rod(SHAFT, -30, 30, 60, 3.0) + box(5, SHAFT + 2.5, -2, 2, -6, 6)
    return Grooved("key corner", sleeve() - box(5, SHAFT + 4, -2, 6, -6, 12), keyed, ())


def key_stop(pin: Pin) -> Grooved:
    """A key at one wall."""
    keyed = rod(SHAFT, -30, 30, 60, 3.0) + box(5, SHAFT + 2.5, -2, 2, -6, 6)
    return Grooved(
        "key stop",
        sleeve() - box(5, SHAFT + 4, -2, 6, -12, 12),
        keyed,
        (np.array([slide()]), np.array([turn(), slide()])),
    )


def key_at_bottom(pin: Pin) -> Grooved:
    """A key at one wall, its shaft at the bottom of a bore: a piston, or a shaft on a step bearing."""
    keyed = rod(SHAFT, -30, 30, 60, 3.0) + box(5, SHAFT + 2.5, -2, 2, -6, 6)
    barrel = rod(15, -40, 15, 72) - rod(SHAFT, -30, 20, 64) - box(5, SHAFT + 4, -2, 6, -12, 20)
    return Grooved("key at bottom", barrel, keyed, ())


def pad_corner(pin: Pin) -> Grooved:
    """A lever on a pad beside its axis, at a stop: free to go away from either."""
    base = box(-30, 60, -40, 40, -5, 0) - rod(5, -6, 1, 64) + box(20, 40, -14, -4, -1, 12)
    lever = rod(5, -5, 12, 56) + box(0, 50, -4, 4, 4, 12) + box(30, 36, -3, 3, 0, 5)
    return Grooved("pad corner", base, lever, ())


def block_corner(pin: Pin) -> Grooved:
    """A block on a floor in the corner of two walls, along either of which it may slide."""
    walls = box(-40, -30, -40, 40, -1, 12) + box(-40, 40, -40, -30, -1, 12)
    return Grooved("block corner", box(-40, 40, -40, 40, -5, 0) + walls, box(-30, -5, -30, -5, 0, 10), ())


def round_about(pin: Pin) -> Grooved:
    poses = [(angle, 0) for angle in arcs(-40, 40)]
    return in_sleeve("slot round about", pin, poses, (np.array([turn()]),))


def ring_groove(pin: Pin) -> Grooved:
    """A groove all round the bore."""
    ring = rod(WALL, -pin.slot, pin.slot, 72)
    return Grooved("ring groove", sleeve() - ring, shaft(pin), (np.array([turn()]),))


def helical(pitch: float, span=80.0, step=4.0) -> Callable[[Pin], Grooved]:
    def made(pin: Pin) -> Grooved:
        poses = [(a, pitch * a / 360) for a in arcs(-span / 2, span / 2, step)]
        half = max(HALF, abs(pitch) * span / 720 + 4)
        return in_sleeve(
            f"helical slot {pitch:g}", pin, poses, (np.array([turn(lead=pitch / (2 * math.pi))]),), half=half
        )

    return made


def twisted(pitch: float) -> Callable[[Pin], Grooved]:
    """An open helical slot, its section twisted along the axis."""

    def made(pin: Pin) -> Grooved:
        lead = pitch / (2 * math.pi)
        wide = 2 * pin.slot * math.sqrt(1 + (WALL / lead) ** 2)
        outline = CrossSection([np.array([[0, -wide / 2], [17, -wide / 2], [17, wide / 2], [0, wide / 2]])])
        angle = 360 * 2 * (HALF + 3) / pitch
        slot = Manifold.extrude(outline, 2 * (HALF + 3), 48, angle).translate((0, 0, -HALF - 3))
        slot = slot.rotate((0, 0, -angle / 2))
        return Grooved(f"twisted slot {pitch:g}", sleeve() - slot, shaft(pin), (np.array([turn(lead=lead)]),))

    return made


def drilled(pin: Pin) -> Grooved:
    """In a hole all round."""
    return in_sleeve("drilled", pin, [(0, 0)], (np.zeros((0, 6)),))


def helical_end(pin: Pin) -> Grooved:
    """At the rounded end of a helical slot."""
    end = 360 * pin.radius * pin.play / 60
    poses = [(a, 60 * a / 360) for a in arcs(-60, end)]
    return in_sleeve("end of a helical slot", pin, poses, (np.array([turn(lead=60 / (2 * math.pi))]),))


L_SHAPE = [(0, h) for h in (-20, 0)] + [(a, 0) for a in arcs(0, 50)[1:]]


def bayonet(place: str) -> Callable[[Pin], Grooved]:
    """An L-shaped slot, the pin in its axial arm, at its corner, in its arm round about or at the end of that; or a J
    with the pin in its hook."""

    def made(pin: Pin) -> Grooved:
        play = pin.radius * pin.play
        turning, sliding = np.array([turn()]), np.array([slide()])
        at = {
            "arm": ((0, -8), (sliding,)),
            "corner": ((0, 0), ()),
            "round": ((25, 0), (turning,)),
            "end": ((50, 0), (turning,)),
            "hook": ((50, -3), (sliding,)),
            "in hook": ((50, -2), (sliding,)),
        }
        (angle, height), right = at[place]
        poses = list(L_SHAPE)
        if "hook" in place:
            poses += [(50, -3 - play)]
        poses = [(a - angle, h - height) for a, h in poses]
        return in_sleeve(f"bayonet {place}", pin, poses, right)

    return made


def barrel_wave(pin: Pin) -> Grooved:
    """A follower in a groove that waves round a drum: where it is, it goes like a screw, and nowhere else."""
    poses = [(a, 5 * math.sin(math.radians(2 * a))) for a in arcs(0, 354, 6)]
    groove = milled(cross_pin(pin, pin.slot, SHAFT - 2, SHAFT + 3), [*poses, (360, 0)])
    drum = rod(SHAFT, -20, 20, 72) - groove
    follower = rod(WALL + 2, -HALF, HALF, 72) - rod(SHAFT, -HALF - 1, HALF + 1, 64)
    return Grooved("barrel cam", drum, follower + cross_pin(pin, pin.radius, SHAFT - 1.5, WALL), ())


def barrel_helix(pitch: float) -> Callable[[Pin], Grooved]:
    """A pin of the sleeve in a helical groove of the shaft."""

    def made(pin: Pin) -> Grooved:
        poses = [(a, pitch * a / 360) for a in arcs(-100, 100, 4)]
        groove = milled(cross_pin(pin, pin.slot, SHAFT - 2, SHAFT + 3), poses)
        sleeved = rod(WALL + 2, -HALF, HALF, 72) - rod(SHAFT, -HALF - 1, HALF + 1, 64)
        drum = rod(SHAFT, -30, 30, 60, 3.0) - groove
        pinned = sleeved + cross_pin(pin, pin.radius, SHAFT - 1.5, WALL)
        return Grooved(f"helical groove {pitch:g}", drum, pinned, (np.array([turn(lead=pitch / (2 * math.pi))]),))

    return made


def ball_nose(kind: str, pitch=40.0) -> Callable[[Pin], Grooved]:
    """A ball on the side of a shaft in a round groove of its bore."""

    def made(pin: Pin) -> Grooved:
        poses = {
            "axial": [(0, -20), (0, 20)],
            "round": [(a, 0) for a in arcs(-60, 60)],
            "helix": [(a, pitch * a / 360) for a in arcs(-60, 60)],
            "dimple": [(0, 0)],
        }[kind]
        right = {
            "axial": np.array([slide()]),
            "round": np.array([turn()]),
            "helix": np.array([turn(lead=pitch / (2 * math.pi))]),
            "dimple": np.zeros((0, 6)),
        }[kind]
        cutter = ball(pin.slot, 40, 2.0).translate((SHAFT + 0.3 * pin.radius, 0, 0))
        return in_sleeve(f"ball nose {kind}", pin, poses, (right,), cutter, "ball")

    return made


def free_ball(kind: str) -> Callable[[Pin], Grooved]:
    """A ball in a straight or a ring groove of a block: it rolls, and goes along."""

    def made(pin: Pin) -> Grooved:
        r = 4 * pin.radius
        inside = ball(r, 2 * pin.segments, pin.phase)
        wide = r * (1 + pin.play)
        if kind == "straight":
            block = box(-15, 15, -12, 12, -12, 0.5 * r) - rod(wide, -20, 20, 96).rotate((0, 90, 0))
            way = slide((1, 0, 0))
        elif kind == "vee":
            vee = box(-20, 20, -wide, 2 * wide, -wide, 2 * wide).rotate((45, 0, 0))
            block, way = box(-15, 15, -12, 12, -12, 0) - vee, slide((1, 0, 0))
        else:
            around = np.linspace(0, 2 * np.pi, 72, endpoint=False)
            circle = np.stack([20 + wide * np.cos(around), wide * np.sin(around)], axis=1)
            ring = Manifold.revolve(CrossSection([circle]), 120).translate((-20, 0, 0))
            block, way = rod(30, -10, 0.3 * r, 96).translate((-20, 0, 0)) - ring, turn((-20, 0, 0))
        turns = [turn(axis=e) for e in np.eye(3)]
        return Grooved(f"ball in a {kind} groove", block, inside, (np.array([way, *turns]),))

    return made


def tee(pin: Pin) -> Grooved:
    c = pin.radius * pin.play
    table = box(-30, 30, -15, 15, -10, 0) - box(-31, 31, -4 - c, 4 + c, -5, 1) - box(-31, 31, -8 - c, 8 + c, -8 - c, -4)
    block = box(-8, 8, -4, 4, -5, 6) + box(-8, 8, -8, 8, -8, -4 - c)
    return Grooved("T-slot", table, block, (np.array([slide((1, 0, 0))]),))


def key(closed: bool) -> Callable[[Pin], Grooved]:
    def made(pin: Pin) -> Grooved:
        c = pin.radius * pin.play
        keyed = rod(SHAFT, -30, 30, 60, 3.0) + box(5, SHAFT + 2.5, -2, 2, -6, 6)
        low = -9 if closed else -20
        hub = sleeve() - box(5, SHAFT + 2.5 + 0.5, -2 - c, 2 + c, low, 9 if closed else 20)
        return Grooved("feather key" if closed else "key", hub, keyed, (np.array([slide()]),))

    return made


def splines(count: int) -> Callable[[Pin], Grooved]:
    def made(pin: Pin) -> Grooved:
        c = pin.radius * pin.play
        teeth = [box(5, 10, -1.2, 1.2, -25, 25).rotate((0, 0, 360 * k / count)) for k in range(count)]
        ways = [box(5, 10.5, -1.2 - c, 1.2 + c, -40, 40).rotate((0, 0, 360 * k / count)) for k in range(count)]
        return Grooved(
            f"{count} splines", sleeve() - union(ways), union([rod(SHAFT, -25, 25, 60, 3.0), *teeth]),
            (np.array([slide()]),),
        )  # fmt: skip

    return made


def dogs(pin: Pin) -> Grooved:
    """Two halves of a dog clutch on a pilot, the dogs part of the way in."""
    c = pin.radius * pin.play
    wedge = [box(7, 16, -3, 3, -2, 5).rotate((0, 0, 120 * k)) for k in range(3)]
    gaps = [box(6, 18, -3 - c, 3 + c, 3, 10).rotate((0, 0, 120 * k)) for k in range(3)]
    one = union([rod(14, -10, -1, 72), rod(5, -5, 18, 56), *(w for w in wedge)])
    other = rod(14, 3, 15, 64, 2.0) - rod(5, 0, 20, 60) - union(gaps)
    return Grooved("dog clutch", one, other, (np.array([slide()]),))


def dovetail(pin: Pin) -> Grooved:
    c = pin.radius * pin.play

    def trapezoid(grow):
        return [[-4 - grow, 0.0], [-8 - grow, -7.0], [8 + grow, -7.0], [4 + grow, 0.0]]

    def ext(outline, half):
        return Manifold.extrude(CrossSection([np.array(outline)]), 2 * half).translate((0, 0, -half))

    bed = box(-15, 15, -14, 0, -30, 30) - ext(trapezoid(c), 31) - box(-3.9, 3.9, -1, 1, -31, 31)
    return Grooved("dovetail", bed, ext(trapezoid(0), 10) + box(-3.8, 3.8, -1, 8, -10, 10), (np.array([slide()]),))


def plate_pins(kind: str, count: int) -> Callable[[Pin], Grooved]:
    """Pins of a plate in a straight or round slot of a plate on it."""

    def made(pin: Pin) -> Grooved:
        base, lid = box(-30, 30, -20, 20, -6, 0), box(-30, 30, -20, 20, 0, 5)
        cutter = rod(pin.slot, -1, 7, 40, 2.0)
        if kind == "straight":
            slot = Manifold.batch_hull([cutter.translate((x, 0, 0)) for x in (-18, 18)])
            places, way = [(0, 0)] if count == 1 else [(-8, 0), (8, 0)], slide((1, 0, 0))
        else:
            centre = (0, -30.0)
            angles = np.radians(arcs(-25, 25, 3.0))
            spots = [(30 * math.sin(a), 30 * math.cos(a) + centre[1]) for a in angles]
            placed = [cutter.translate((x, y, 0)) for x, y in spots]
            slot = union(Manifold.batch_hull([a, b]) for a, b in zip(placed, placed[1:], strict=False))
            around = np.radians([0.0] if count == 1 else [-12.0, 12.0])
            places, way = [(30 * math.sin(a), 30 * math.cos(a) + centre[1]) for a in around], turn((*centre, 0))
        pins = [rod(pin.radius, -1, 4.5, pin.segments, pin.phase).translate((x, y, 0)) for x, y in places]
        motions = [way] if count == 2 else [way, turn((*places[0], 0))]
        return Grooved(f"{count} in a {kind} slot", union([base, *pins]), lid - slot, (np.array(motions),))

    return made


def detent(pin: Pin) -> Grooved:
    """A conical dimple under a ball nose."""
    cone = Manifold.cylinder(4, 4 * 0.7, 0.01, 48).rotate((0, 90, 0))
    centre = SHAFT + 0.3 * pin.radius
    apex = centre + pin.radius * (1 + pin.play) / math.sin(math.atan(0.7))
    return Grooved("ball detent", sleeve() - cone.translate((apex - 4, 0, 0)), shaft(pin, "ball"), (np.zeros((0, 6)),))


KINDS: dict[str, Callable[[Pin], Grooved]] = {
    "axial": axial,
    "open axial": open_axial,
    "axial end": axial_end,
    "key corner": key_corner,
    "key at bottom": key_at_bottom,
    "pad corner": pad_corner,
    "block corner": block_corner,
    "key stop": key_stop,
    "square end": square_end,
    "square corner": square_corner,
    "round about": round_about,
    "ring groove": ring_groove,
    **{f"helical {p}": helical(p) for p in (25, -40, 60, -90, 150)},
    "drilled": drilled,
    "helical end": helical_end,
    **{f"twisted {p}": twisted(p) for p in (45, -60, 90)},
    **{f"bayonet {p}": bayonet(p) for p in ("arm", "corner", "round", "end", "hook", "in hook")},
    "barrel wave": barrel_wave,
    **{f"barrel helix {p}": barrel_helix(p) for p in (20, -50)},
    **{f"nose {k}": ball_nose(k) for k in ("axial", "round", "helix", "dimple")},
    **{f"ball {k}": free_ball(k) for k in ("straight", "vee", "ring")},
    "tee": tee,
    "key": key(False),
    "feather key": key(True),
    "splines 4": splines(4),
    "splines 6": splines(6),
    "dogs": dogs,
    "dovetail": dovetail,
    **{f"plate {k} {n}": plate_pins(k, n) for k in ("straight", "arc") for n in (1, 2)},
    "detent": detent,
}


def in_world(twists: np.ndarray, X: np.ndarray, scale: float) -> np.ndarray:
    """Twists (k, 6) of mm in the frame of a mechanism, in the world (m), under a pose and scale of `solids.part`."""
    R, p = X[:3, :3], X[:3, 3]
    w, v = twists[:, :3] @ R.T, scale * twists[:, 3:] @ R.T
    return np.hstack([w, v + np.cross(p, w)])


def apart(one: np.ndarray, other: np.ndarray, length: float, place: np.ndarray) -> float:
    """Sine of the greatest angle between two spaces of twists (k, 6) in the world, scaled by a length (m) about a
    place (3,); 1 where their dimensions differ."""
    if len(one) != len(other):
        return 1.0
    if not len(one):
        return 0.0

    def basis(twists):
        w, v = twists[:, :3], twists[:, 3:] + np.cross(twists[:, :3], place)
        return np.linalg.qr(np.hstack([length * w, v]).T)[0]

    cosines = np.linalg.svd(basis(one).T @ basis(other), compute_uv=False)
    return float(math.sqrt(max(0.0, 1.0 - cosines.min() ** 2)))


def pins(rng, count: int) -> Iterator[Pin]:
    """Pins of random play, facets and phase."""
    for _ in range(count):
        play = rng.choice([0.0, 0.0, 0.005, 0.01, 0.02, 0.05])
        segments = int(rng.choice([12, 16, 24, 32, 48, 64, 96, 128]))
        radius = float(rng.choice([0.8, 1.5, 1.5, 2.5]))
        yield Pin(radius, play=float(play), segments=segments, phase=float(rng.uniform(0, 360 / segments)))

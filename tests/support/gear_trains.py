"""Gear pairs, rack and pinion, and cams on shafts in a housing, with ratios known from their construction."""

from __future__ import annotations

import numpy as np
from generators.involute import Gear, mesh_angle, rack_outline

from support.solids import box, extrusion, rod

WIDTH = 8


def post(x=0.0, y=0.0, width=WIDTH):
    """A journal between two collars."""
    shaft = rod(3, -3, width + 1, 48) + rod(5, -3, 0, 48) + rod(5, width, width + 1, 48)
    return shaft.translate((x, y, 0))


def wheel(outline, x=0.0, y=0.0):
    bored = extrusion(outline, 0, WIDTH) - rod(3, -1, WIDTH + 1, 48)
    return bored.translate((x, y, 0))


def gear_pair(first=20, second=30, turn=0.1, points=12, thin=0.0, lag=0.0, idler=0):
    """Two gears on a housing; with `idler` teeth, a third between them. Tooth k·pitch apart they all touch."""
    teeth = [first, idler, second] if idler else [first, second]
    gears = [Gear(z, thin=thin, points=points) for z in teeth]
    turns, places = [turn], [0.0]
    for one, two in zip(gears, gears[1:], strict=False):
        turns.append(mesh_angle(one, two, turns[-1], lag))
        places.append(places[-1] + one.pitch_radius + two.pitch_radius)
    housing = box(-8, places[-1] + 8, -8, 8, -6, -3)
    out = {}
    for k, (gear, angle, x) in enumerate(zip(gears, turns, places, strict=True)):
        out[f"gear{k}"] = wheel(gear.outline(angle), x)
        housing += post(x)
    return {"housing": housing, **out}


def limited(outline, low, high):
    """An outline with its tips and roots on these radii."""
    radius = np.hypot(*outline.T)
    return outline * (np.clip(radius, low, high) / radius)[:, None]


def ring(teeth, outer, tips):
    """A wheel with inner teeth, whose spaces are the teeth of an outer one; too short to foul a pinion's roots."""
    outline = limited(Gear(teeth, thin=-0.08).outline(), tips, outer)
    return rod(outer, 0, WIDTH, 96) - extrusion(outline, -1, WIDTH + 1)


def epicyclic():
    """A carrier about z bears a planet of 20 teeth, 15 mm off, in a ring of 50 that belongs to the frame."""
    apart, low = 0.5 * (50 - 20), -12
    frame = ring(50, 30, 24.2) + rod(30, low - 4, low, 96) + (rod(30, low, 0, 96) - rod(27, low - 1, 1, 96))
    frame += rod(3, low, -2, 48) + rod(5, low, -9, 48) + rod(5, -4, -2.5, 48)
    carrier = rod(7, -9, -4, 48) + box(0, apart, -3, 3, -8, -5) + rod(5, -8, 0, 48).translate((apart, 0, 0))
    carrier -= rod(3, -20, 5, 48)
    carrier += (rod(3, 0, WIDTH + 1, 48) + rod(5, WIDTH, WIDTH + 1, 48)).translate((apart, 0, 0))
    planet = wheel(limited(Gear(20, thin=0.04).outline(), 0.0, 10.7), apart)
    return {"frame": frame, "carrier": carrier, "planet": planet}


def planetary():
    """The same with a planet of 18 teeth, 16 mm off, in a ring of 50, and a sun of 14 on a journal of the frame."""
    apart, low = 0.5 * (50 - 18), -12
    frame = ring(50, 30, 24.2) + rod(30, low - 4, low, 96) + (rod(30, low, 0, 96) - rod(27, low - 1, 1, 96))
    frame += rod(3, low, WIDTH + 1, 48) + rod(5, low, -9, 48) + rod(5, -4, -2.5, 48) + rod(4, -2.5, 0, 48)
    frame += rod(4, WIDTH, WIDTH + 1, 48)
    carrier = rod(7, -9, -4, 48) + box(0, apart, -3, 3, -8, -5) + rod(5, -8, 0, 48).translate((apart, 0, 0))
    carrier -= rod(3, -20, 5, 48)
    carrier += (rod(3, 0, WIDTH + 1, 48) + rod(5, WIDTH, WIDTH + 1, 48)).translate((apart, 0, 0))
    planet = wheel(limited(Gear(18, thin=0.04).outline(), 0.0, 9.7), apart)
    sun = wheel(Gear(14, thin=0.04).outline(np.pi / 14))
    return {"frame": frame, "carrier": carrier, "planet": planet, "sun": sun}


def rack_and_pinion(teeth=20, turn=0.1, points=12, thin=0.0):
    """A pinion about z at the origin, and a rack below it that slides along x in a T slot."""
    gear = Gear(teeth, thin=thin, points=points)
    r = gear.pitch_radius
    pitch = np.pi * gear.module
    x = (turn + np.pi / 2) * r + pitch / 2
    x -= pitch * np.round(x / pitch)
    low = -r - 4.25
    rack = extrusion(rack_outline(1.0, 21, thin=thin), 0, WIDTH).translate((x, -r, 0))
    rack += box(x - 30, x + 30, low - 4, low, 2, 6) + box(x - 30, x + 30, low - 6, low - 4, 0, 8)
    frame = box(-8, 8, -8, 8, -6, -3) + post() + box(-15, 15, low - 8, -8, -6, -1)
    guide = box(-15, 15, low - 9, low - 0.5, -1, 9)
    guide -= box(-16, 16, low - 4, low + 1, 2, 6) + box(-16, 16, low - 6, low - 4, 0, 8)
    return {"frame": frame + guide, "pinion": wheel(gear.outline(turn)), "rack": rack}


def cam_and_follower(turn=0.7, segments=64):
    """An elliptic cam about z under a flat follower that slides along y, and where it touches (mm from the axis)."""
    a, b, aside = 12.0, 8.0, 2.0
    spin = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    t = 2 * np.pi * np.arange(segments) / segments
    # the highest point of the turned ellipse: where its tangent is along x
    high = np.arctan2(b * np.cos(turn), a * np.sin(turn))
    reach, top = np.array([a * np.cos(high) + aside, b * np.sin(high)]) @ spin
    outline = np.stack([a * np.cos(t) + aside, b * np.sin(t)], axis=1) @ spin
    follower = box(-20, 20, top, top + 4, 0, WIDTH) + box(-3, 3, top + 4, top + 30, 1, WIDTH - 1)
    frame = box(-8, 8, -8, 8, -6, -3) + post() + box(-8, 8, -8, 40, -9, -6)
    frame += box(-8, 8, top + 8, top + 20, -9, 12) - box(-3, 3, top + 7, top + 21, 1, WIDTH - 1)
    return {"frame": frame, "cam": wheel(outline), "follower": follower}, reach


def pinion_in_a_ring(first=20, second=50, points=60, turn=-0.23):
    """A pinion on a journal of a frame, and a ring around it that turns on a shaft above. Their tips are cut: of few
    `points` the flanks end in chamfers."""
    apart, outer = 0.5 * (second - first), 0.5 * second + 6
    tool = limited(
        Gear(second, thin=-0.08, points=points).outline(turn * first / second), 0.5 * second - 0.75, 0.5 * second + 1.2
    )
    pinion = wheel(limited(Gear(first, thin=0.04, points=points).outline(turn), 0.0, 0.5 * first + 0.7), apart)
    turned = rod(outer, 0, 14, 96) - extrusion(tool, -1, 10)
    turned += rod(3, 14, 28, 48) + rod(5, 14, 20, 48) + rod(5, 26, 27, 48)
    low, high = -outer - 10, outer + 3
    frame = box(low, high, -high, high, -6, -3) + box(low, low + 5, -high, high, -6, 26) + post(apart)
    frame += box(low, high, -high, high, 20, 26) - rod(3, 19, 27, 48)
    return {"frame": frame, "pinion": pinion, "ring": turned}

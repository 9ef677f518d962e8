"""The least distance of two moving groups of parts, along a motion or over ranges, with nothing passed over.

Along a motion (conservative advancement): a pose in which the distance exceeds what is required by e certifies all
poses up to which no point moves by more than e. Over ranges (branch and bound): the middle of a cell certifies it
if no point moves by more than e from there; else the cell is halved. Both stop at a pose that falls short; what is told
is the first that does, between it and the clear pose before (along a motion), or on the straight way of the coordinates
from the pose of the meshes to it (over ranges). Steps are never shorter than `floor`: distances are certain up to that.
Between two given poses of a motion the second group moves along the screw that leads from one to the other.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.displacements import displacement, inverse, twist_of
from kinform.foundation.algebra.vectors import cross
from kinform.function.clearances import Apart
from kinform.function.configurations import Chain
from kinform.model.arrays import Array
from kinform.requirements.evidence import Nearest, Swept

BUDGET = 4000
"""Poses that are measured before giving up: seconds at a millisecond each. Chosen, not measured."""
FIRST = 1e-3
"""Share of the shortest step to which the first pose that falls short is found: ten halvings."""
BEYOND_MOST = 12
"""Poses beyond the first that falls short that are handed on: overlaps grow there."""
FLOOR = 1e-4
"""Shortest step, of the size of the smaller group: 0.01 mm of a part of 100 mm, what is machined."""


def along(groups: Apart, first: Array, second: Array, required: float) -> Swept:
    """Along displacements (T, 4, 4) of both groups from the pose of the meshes."""
    relative = inverse(first) @ second
    twists = twist_of(inverse(relative[:-1]) @ relative[1:])
    moved = np.array([_speed(twist, groups) for twist in twists])
    way = np.concatenate([[0.0], np.cumsum(moved)])
    floor = FLOOR * groups.size

    def pose(k: int, share: float) -> Array:
        return np.asarray(relative[k] @ displacement(share * twists[k]) if share > 0.0 else relative[k])

    def located(at: float) -> tuple[int, float]:
        k = int(np.clip(np.searchsorted(way, at, side="right") - 1, 0, max(len(moved) - 1, 0)))
        return k, (at - way[k]) / moved[k] if len(moved) and moved[k] > 0.0 else 0.0

    def nearest(at: float) -> Nearest:
        k, share = located(at)
        near = groups.at(pose(k, min(share, 1.0)), enough=required + way[-1] - at)
        return replace(near, place=first[k, :3, :3] @ near.place + first[k, :3, 3])

    at, worst, where, before = 0.0, Nearest(np.inf, ("", ""), np.zeros(3)), 0.0, 0.0
    for count in range(1, BUDGET + 1):
        near = nearest(at)
        if near.distance < worst.distance:
            worst, where = near, sum(located(at))
        if _short(near, required):
            at, near = _first(nearest, required, before, at, near, FIRST * floor)
            k, share = located(at)
            after = tuple(relative[k + 1 : k + 1 + BEYOND_MOST])
            return Swept(near, k + share, (), True, floor, count, pose(k, min(share, 1.0)), after)
        if at >= way[-1]:
            return Swept(worst, where, (), True, floor, count)
        before, at = at, min(at + max(near.distance - required, floor), way[-1])
    return Swept(worst, where, (), False, floor, BUDGET)


def over(groups: Apart, chain: Chain, first: str, second: str, low: Array, high: Array, required: float) -> Swept:
    """Over all values of the coordinates (n,) of a chain without loops between `low` and `high`."""
    a, b = chain.index(first), chain.index(second)
    lever = _levers(chain, groups, b, low, high)
    # Ten times the shortest step where several joints move at once: cells of two joints are a hundred times fewer then.
    floor = FLOOR * groups.size * (1.0 if np.count_nonzero(lever) < 2 else 10.0)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    cells: list[tuple[float, int, Array, Array]] = [(0.0, 0, middle, half)]
    worst, values = Nearest(np.inf, ("", ""), np.zeros(3)), middle
    number = count = 0

    def relative(q: Array) -> Array:
        poses = chain.linkage.world(chain.system.bodies(q[None])[0])
        return np.asarray(np.linalg.inv(poses[a]) @ poses[b])

    def nearest(q: Array, reach: float) -> Nearest:
        return groups.at(relative(q), enough=required + reach)

    while cells:
        if count >= BUDGET:
            return Swept(worst, 0.0, _joint_values(chain, values), False, floor, count)
        _, _, middle, half = heapq.heappop(cells)
        reach = float(lever @ half)
        near = nearest(middle, reach)
        count += 1
        if near.distance < worst.distance:
            worst, values = near, middle
        if _short(near, required):
            # towards the pose of the meshes, as far as the ranges hold it
            start = np.clip(np.zeros(len(low)), low, high)
            q, near = _on_the_way(nearest, required, start, middle, lever, floor, near)
            more = (np.clip(q + share * (q - start), low, high) for share in np.geomspace(1e-3, 1.0, BEYOND_MOST))
            after = (*map(relative, more), relative(middle))
            return Swept(near, 0.0, _joint_values(chain, q), True, floor, count, relative(q), after)
        if near.distance - required >= reach or reach <= floor:
            continue
        k = int(np.argmax(lever * half))
        smaller = half.copy()
        smaller[k] *= 0.5
        for side in (-1.0, 1.0):
            number += 1
            shifted = middle.copy()
            shifted[k] += side * smaller[k]
            heapq.heappush(cells, (near.distance - reach, number, shifted, smaller))
    return Swept(worst, 0.0, _joint_values(chain, values), True, floor, count)


def _short(near: Nearest, required: float) -> bool:
    """Whether a pose falls short."""
    return near.distance < required or near.distance <= 0.0


def _first(
    nearest: Callable[[float], Nearest], required: float, clear: float, at: float, found: Nearest, fine: float
) -> tuple[float, Nearest]:
    """About the first place that falls short between one that is clear and `at`, where `found` does."""
    while at - clear > fine:
        middle = 0.5 * (clear + at)
        if middle in (clear, at):
            break
        near = nearest(middle)
        if _short(near, required):
            at, found = middle, near
        else:
            clear = middle
    return at, found


def _on_the_way(
    nearest: Callable[[Array, float], Nearest],
    required: float,
    start: Array,
    end: Array,
    lever: Array,
    floor: float,
    found: Nearest,
) -> tuple[Array, Nearest]:
    """The first coordinates (n,) on the straight way from `start` that fall short; at its `end` `found` does."""
    way = max(float(lever @ np.abs(end - start)), floor)

    def at(share: float) -> Array:
        return np.asarray(start + share * (end - start))

    def near_at(share: float) -> Nearest:
        return nearest(at(share), way * (1.0 - share))

    share = clear = 0.0
    for _ in range(BUDGET):
        near = near_at(share)
        if _short(near, required):
            share, near = _first(near_at, required, clear, share, near, FIRST * floor / way)
            return at(share), near
        if share >= 1.0:
            break
        clear, share = share, min(share + max(near.distance - required, floor) / way, 1.0)
    return end, found


def _speed(twist: Array, groups: Apart) -> float:
    """How far a point of the second group moves at most."""
    centre = twist[3:] + cross(twist[:3], groups.centre)
    return float(np.linalg.norm(centre) + groups.radius * np.linalg.norm(twist[:3]))


def _levers(chain: Chain, groups: Apart, tip: int, low: Array, high: Array) -> Array:
    """(n,) m: how far a point of the second group moves at most when a coordinate of the chain changes by one."""
    centre, length = chain.linkage.local(groups.centre), chain.frame.length
    order = np.flatnonzero(np.abs(chain.system.reach[tip]) > 0.0)
    # from the tip to the root: what moves fewer bodies comes first
    path = sorted(order, key=lambda k: int(np.count_nonzero(chain.system.reach[:, k])))
    out = np.zeros(len(chain.coordinates))
    screws, most = chain.system.screws, np.maximum(np.abs(low), np.abs(high))
    leads = np.array(
        [abs(float(s[:3] @ s[3:])) if c.turns else 1.0 for s, c in zip(screws, chain.coordinates, strict=True)]
    )
    beyond, point = groups.radius / length + float(leads[path] @ most[path]), centre
    for k in path:
        if not chain.coordinates[k].turns:
            out[k] = length
            continue
        omega, v = screws[k, :3], screws[k, 3:]
        on_axis = cross(omega, v)
        on_axis = on_axis + omega * float(omega @ (point - on_axis))
        beyond += float(np.linalg.norm(point - on_axis))
        point = on_axis
        out[k] = length * (beyond + leads[k])
    return out


def _joint_values(chain: Chain, q: Array) -> tuple[float, ...]:
    return tuple(float(x) / c.unit for x, c in zip(q, chain.coordinates, strict=True))

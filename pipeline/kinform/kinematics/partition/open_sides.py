"""The sides of joints that name one part, or none: type, axis and point are enough where only one way of parting is
possible. Where there are several, or none, it is an error that lists them: nothing is guessed.

Joints whose sides are known cut first. A way of parting is taken where every other one would part what is dearer by
the price of a pocket (other bodies next to what it parts might have that, too), where it breaks no contact that no
joint may part, where it touches near the joint's point, and where it does not just take out a single part that goes
round the axis, as the ring of a bearing does. It divides the bodies that the other joints leave, and
rearranges none of them. What was taken while other joints were open is asked again with all of them. Round a loop no
joint parts anything by itself: there the cheapest ways of all are tried together, and taken if each is clear beside the
others.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from kinform.errors import OpenSidesError, Problem
from kinform.foundation.algebra.vectors import norm
from kinform.foundation.graphs.graph import forest
from kinform.foundation.words import counted, length, number, quoted
from kinform.kinematics.partition.constants import BROKEN, COAXIAL
from kinform.kinematics.partition.contact import ROUND
from kinform.kinematics.partition.ways import ONLY_WAY, Names, Way, Ways
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import FoundSides
from kinform.model.names import PartName

FAR_ALONG = 0.2
"""Share of the assembly's size beyond which contact along an axis is too far from the joint's point to be taken unseen:
the true ones of ten robots lie within 0.094 (0 mostly), the wrong one of the hand that asked for this at 0.67."""
ROUNDS = 4
"""So many times the ways of joints round a loop are looked for, each beside those of the others."""
WAYS_NAMED = 4
"""So many ways of parting are named where it is not clear which is meant."""


def with_sides(assembly: Assembly, contacts: Contacts) -> tuple[Assembly, tuple[FoundSides, ...]]:
    """The assembly with both sides of every joint named, and what told those that the function leaves open.

    Raises OpenSidesError with a problem for each joint of which that is not clear.
    """
    if all(joint.between[1] for joint in assembly.function.joints):
        return assembly, ()
    joints = sorted((one for one in assembly.function.joints if one.type != "fixed"), key=lambda joint: joint.name)
    ways = Ways(assembly, contacts, joints)
    stated = {
        k: (assembly.parts_of(joint.between[0])[0], assembly.parts_of(joint.between[1])[0])
        for k, joint in enumerate(joints)
        if joint.between[1]
    }
    waiting = [k for k, joint in enumerate(joints) if not joint.between[1]]
    taken = _taken(ways, stated, waiting)
    if len(taken) > 1:  # some were taken while others were open
        confirmed = _confirmed(ways, stated, taken)
        taken = {k: way for k, way in taken.items() if k in confirmed}
    if len(taken) < len(waiting):
        taken |= _together(ways, stated, taken, waiting)
    known = stated | {k: way.names for k, way in taken.items()}
    if len(taken) < len(waiting):
        known = stated | {k: way.names for k, way in taken.items()}
        raise OpenSidesError({joints[k].name: _problem(ways, k, known) for k in waiting if k not in taken})
    found = _found(ways, _by_largest(ways, known, taken), taken)
    return replace(assembly, function=assembly.function.with_sides({one.joint: one.parts for one in found})), found


def _taken(ways: Ways, stated: Mapping[int, Names], waiting: Sequence[int]) -> dict[int, Way]:
    """The ways that are clear, those that others depend on first; none of two joints that would part the same."""
    taken: dict[int, Way] = {}
    while True:
        known = dict(stated) | {k: way.names for k, way in taken.items()}
        fresh = {}
        for k in waiting:
            clear = None if k in taken else _clear(ways, k, known)
            if clear is not None:
                fresh[k] = clear[0]
        twice = {k for k, way in fresh.items() for j, other in fresh.items() if j != k and ways.alike(way, other)}
        fresh = {k: way for k, way in fresh.items() if k not in twice}
        if not fresh:
            return taken
        taken |= fresh


def _confirmed(ways: Ways, stated: Mapping[int, Names], taken: Mapping[int, Way]) -> set[int]:
    """Those that are clear, and the same, when all others are known."""
    known = dict(stated) | {k: way.names for k, way in taken.items()}
    parted = ways.parted(known)
    out = set()
    for k in taken:
        clear = _clear(ways, k, {j: names for j, names in known.items() if j != k})
        if clear is not None and {parted.body[name] for name in clear[0].names} == set(parted.sides[k]):
            out.add(k)
    return out


def _together(
    ways: Ways, stated: Mapping[int, Names], taken: Mapping[int, Way], waiting: Sequence[int]
) -> dict[int, Way]:
    """Ways of those that are not clear by themselves, as round a loop: it comes apart at all of its joints at once.
    The cheapest of each beside the others, again and again until they stay; none unless nothing is broken that no joint
    may part, no two could change their places, and each is clear when all others are known."""
    fixed = dict(stated) | {k: way.names for k, way in taken.items()}
    guess: dict[int, Way] = {}
    for _ in range(ROUNDS):
        before = {k: way.names for k, way in guess.items()}
        for k in waiting:
            if k not in taken:
                others = {j: way.names for j, way in guess.items() if j != k}
                found = ways.ways(k, fixed | others)
                if not found:
                    return {}
                guess[k] = found[0]
        if before == {k: way.names for k, way in guess.items()}:
            break
    whole = dict(taken) | guess
    known = fixed | {k: way.names for k, way in guess.items()}
    cost = ways.parted(known).cost
    swapped = (known | {j: known[k], k: known[j]} for j, k in combinations(sorted(guess), 2))
    if cost >= BROKEN or any(ways.parted(one).cost - cost < ONLY_WAY for one in swapped):
        return {}
    return guess if _confirmed(ways, stated, whole) == set(whole) else {}


def _clear(ways: Ways, joint: int, known: Mapping[int, Names]) -> tuple[Way, float] | None:
    """The only way of parting, with by how much the next is dearer; None where it is not clear."""
    found = ways.ways(joint, known)
    before, after = ways.parted(known), ways.parted(dict(known) | {joint: found[0].names}) if found else None
    if after is None or after.cost - before.cost >= BROKEN or not ways.divides(before, after):
        return None
    ahead = found[1].cost - found[0].cost if len(found) > 1 else np.inf
    named = {ways.assembly.parts_of(name)[0] for name in ways.joints[joint].between if name}
    named |= {name for names in known.values() for name in names}
    lone = [name for side in found[0].bodies if len(side) == 1 for name in side - named]
    if any(ways.round(joint, name) for name in lone) and ways.held_about(joint, found[0]):
        return None
    far = found[0].beyond > FAR_ALONG * ways.size
    if far or ahead < ONLY_WAY or ways.elsewhere(joint, known, found[0]):
        return None
    return found[0], ahead


def _problem(ways: Ways, joint: int, known: Mapping[int, Names]) -> Problem:
    """What is not clear about a joint, with the ways of parting that come into question."""
    it, units = ways.joints[joint], ways.assembly.units
    what = f"[[function.joint]] '{it.name}' names "
    what += f"one side only, '{it.between[0]}'" if it.between[0] else "none of its sides"
    found = ways.ways(joint, known)
    found[1:1] = ways.elsewhere(joint, known, found[0]) if found else []
    if not found:
        where = "along it" if it.type in ("prismatic", "planar") else "about its axis"
        what += f", and no contact {where} parts two bodies there that no other joint parts; {_nearest(ways, it)}"
        return Problem(what, it.file or None, it.line, "name a part of either side in `between`, or correct its place")
    base = ways.parted(known).cost
    lines = []
    for way in found[:WAYS_NAMED]:
        first, second = way.names
        far = f", {length(way.beyond, units, 3)} along the axis from its point" if way.beyond > 0.0 else ""
        breaks = way.cost - base >= BROKEN
        lines.append(f"'{first}' from '{second}'{far}{', which breaks contact that no joint may part' * breaks}")
    more = len(found) - len(lines)
    ways_ = f"{counted(len(found), 'way')} of parting may be meant" if len(found) > 1 else "the only way of parting is"
    what += f", and {ways_}: " + "; ".join(lines) + (f"; and {more} more" if more else "")
    first, second = found[0].names
    return Problem(
        what, it.file or None, it.line, f'name a part of either side, as in between = ["{first}", "{second}"]'
    )


def _nearest(ways: Ways, joint: IntendedJoint) -> str:
    """Where the nearest journal is that has the joint's direction, or the nearest ball."""
    best: tuple[float, Names] | None = None
    for patch in ways.contacts.patches:
        if joint.point is None or patch.narrow or patch.kind not in ROUND:
            continue
        arm = patch.point - joint.point
        if joint.axis is None:
            if patch.kind != "sphere":
                continue
        elif patch.kind == "sphere" or abs(float(patch.axis @ joint.axis)) < np.cos(COAXIAL):
            continue
        else:
            arm = arm - (arm @ joint.axis) * joint.axis
        best = min(best or (np.inf, patch.parts), (norm(arm), patch.parts))
    if best is None:
        return "there is none of that kind anywhere" if joint.point is not None else "nothing guides it"
    kind = "ball" if joint.axis is None else "journal of that direction"
    if best[0] <= ways.contacts.tolerance.get(best[1], 0.0):
        return f"between {quoted(best[1])} there is one, and what else touches there is in the way of that motion"
    return f"the nearest {kind} is {length(best[0], ways.assembly.units, 3)} away, between {quoted(best[1])}"


def _found(ways: Ways, known: Mapping[int, Names], taken: Mapping[int, Way]) -> tuple[FoundSides, ...]:
    """The sides of the joints that were open: the one that is named first, else the one nearer to the ground."""
    body = ways.parted(known).body
    steps = _steps(ways, known)
    sizes: dict[int | None, int] = {}
    for one in body.values():
        sizes[one] = sizes.get(one, 0) + 1
    out = []
    for k in sorted(taken):
        joint = ways.joints[k]
        names = known[k] if "" in ways.assembly.function.complete else _bearing(ways, k, known)
        first, second = sorted(names, key=lambda name: (steps.get(body[name], np.inf), -sizes[body[name]], name))
        parts: tuple[str, str] = (first, second)
        if joint.between[0]:
            own = body[ways.assembly.parts_of(joint.between[0])[0]]
            parts = (joint.between[0], first if body[second] == own else second)
        _, ahead = _clear(ways, k, {j: sides for j, sides in known.items() if j != k}) or (None, np.inf)
        rest = (
            "no other way of parting" if np.isinf(ahead) else f"the next way of parting costs {number(ahead, 3)} more"
        )
        where = "along its axis" if joint.type in ("prismatic", "planar") else "about its axis"
        of = [counted(sizes[body[ways.assembly.parts_of(name)[0]]], "part") for name in parts]
        out.append(FoundSides(joint.name, parts, f"contact {where} parts {of[0]} from {of[1]}; {rest}"))
    return tuple(out)


def _by_largest(ways: Ways, known: Mapping[int, Names], taken: Mapping[int, Way]) -> dict[int, Names]:
    """The sides of all joints, those that were open named by the largest part of each body, if no more is parted then:
    of a bearing's ring it is not known that it is of the side that it was found at."""
    parted = ways.parted(known)
    largest: dict[int | None, PartName] = {}
    for name in sorted(ways.volume):
        body = parted.body.get(name)
        largest[body] = max(largest.get(body, name), name, key=lambda one: (ways.volume[one], one))
    out = dict(known)
    for k in taken:
        first, second = parted.sides[k]
        out[k] = (largest[first], largest[second])
    again = ways.parted(out)
    return out if again.count == parted.count and again.cost <= parted.cost else dict(known)


def _bearing(ways: Ways, joint: int, known: Mapping[int, Names]) -> Names:
    """The largest part of each side that touches about the axis: where bodies do not follow from the function, it is
    they that have the joint."""
    parted = ways.parted(known)
    sides = [ways.assembly.parts_of(name)[0] for name in known[joint]]
    for pair in ways.about(joint):
        for name in pair:
            for k, side in enumerate(parted.sides[joint]):
                if parted.body[name] == side:
                    sides[k] = max(sides[k], name, key=lambda one: (ways.volume[one], one))
    return sides[0], sides[1]


def _steps(ways: Ways, known: Mapping[int, Names]) -> dict[int | None, float]:
    """By how many joints each body is away from the ground."""
    parted = ways.parted(known)
    merger = ways.merger.copy()
    first: dict[int, PartName] = {}
    for name, body in sorted(parted.body.items()):
        if body is not None:
            merger.fuse(first.setdefault(body, name), name, "")
    ground = next(one.parts[0] for one in merger.bodies() if one.ground)
    start = parted.body.get(ground)
    if start is None:
        return {}
    edges = sorted(parted.sides.values())
    tree = forest(max(first) + 1, edges, start)
    steps: dict[int | None, float] = {}
    for node in tree.order:
        if tree.root[node] == start:
            steps[node] = 0 if node == start else steps[tree.parent[node]] + 1
    return steps

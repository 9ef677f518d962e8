"""The sides of joints that name one part or none. Type, axis and point decide where only one split is possible;
several splits, or none, are an error that lists them.

Joints with known sides are cut first. A split is accepted where
- every other one costs more by at least the price of a pocket (`ONLY_SPLIT`), counting bodies next to it that might
  own the same contact;
- it breaks no contact that no joint may separate;
- its contact is near the joint's point;
- it does more than take out a single part round the axis, such as the ring of a bearing;
- it divides one body that the other joints leave, and rearranges none.

A split that was accepted while other joints were unknown is checked again once they are known. Round a loop no single
joint separates anything: there the cheapest splits of all joints are tried together, and accepted if each is clear
given the others.
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
from kinform.kinematics.partition.candidate_splits import ONLY_SPLIT, Names, Split, Splits
from kinform.kinematics.partition.constants import BROKEN, SAME_AXIS
from kinform.kinematics.partition.contact import ROUND
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import FoundSides
from kinform.model.names import PartName

FAR_ALONG = 0.2
"""Share of the assembly's size beyond which contact along an axis is too far from the joint's point to be taken unseen:
the true ones of ten robots lie within 0.094 (0 mostly), the wrong one of the hand that asked for this at 0.67."""
ROUNDS = 4
"""Rounds in which the splits of joints round a loop are searched, each given those of the others. Chosen, not
measured."""


def find_missing_sides(assembly: Assembly, contacts: Contacts) -> tuple[Assembly, tuple[FoundSides, ...]]:
    """The assembly with both sides of every joint named, and what told those that the function leaves open.

    Raises OpenSidesError with a problem for each joint of which that is not clear.
    """
    if all(joint.between[1] for joint in assembly.function.joints):
        return assembly, ()
    joints = sorted((one for one in assembly.function.joints if one.type != "fixed"), key=lambda joint: joint.name)
    splits = Splits(assembly, contacts, joints)
    stated = {
        k: (assembly.parts_of(joint.between[0])[0], assembly.parts_of(joint.between[1])[0])
        for k, joint in enumerate(joints)
        if joint.between[1]
    }
    waiting = [k for k, joint in enumerate(joints) if not joint.between[1]]
    taken = _taken(splits, stated, waiting)
    if len(taken) > 1:  # some were taken while others were open
        confirmed = _confirmed(splits, stated, taken)
        taken = {k: split for k, split in taken.items() if k in confirmed}
    if len(taken) < len(waiting):
        taken |= _together(splits, stated, taken, waiting)
    known = stated | {k: split.names for k, split in taken.items()}
    if len(taken) < len(waiting):
        known = stated | {k: split.names for k, split in taken.items()}
        raise OpenSidesError({joints[k].name: _problem(splits, k, known) for k in waiting if k not in taken})
    found = _found(splits, _by_largest(splits, known, taken), taken)
    return replace(assembly, function=assembly.function.with_sides({one.joint: one.parts for one in found})), found


def _taken(splits: Splits, stated: Mapping[int, Names], waiting: Sequence[int]) -> dict[int, Split]:
    """The splits that are clear, those that others depend on first; none where two joints would separate the same."""
    taken: dict[int, Split] = {}
    while True:
        known = dict(stated) | {k: split.names for k, split in taken.items()}
        fresh = {}
        for k in waiting:
            clear = None if k in taken else _clear(splits, k, known)
            if clear is not None:
                fresh[k] = clear[0]
        twice = {k for k, split in fresh.items() for j, other in fresh.items() if j != k and splits.alike(split, other)}
        fresh = {k: split for k, split in fresh.items() if k not in twice}
        if not fresh:
            return taken
        taken |= fresh


def _confirmed(splits: Splits, stated: Mapping[int, Names], taken: Mapping[int, Split]) -> set[int]:
    """Those that are clear, and the same, when all others are known."""
    known = dict(stated) | {k: split.names for k, split in taken.items()}
    parted = splits.bodies_for(known)
    out = set()
    for k in taken:
        clear = _clear(splits, k, {j: names for j, names in known.items() if j != k})
        if clear is not None and {parted.body[name] for name in clear[0].names} == set(parted.sides[k]):
            out.add(k)
    return out


def _together(
    splits: Splits, stated: Mapping[int, Names], taken: Mapping[int, Split], waiting: Sequence[int]
) -> dict[int, Split]:
    """Splits of those that are not clear by themselves, as round a loop: it comes apart at all of its joints at once.
    The cheapest of each beside the others, again and again until they stay; none unless nothing is broken that no joint
    may part, no two could change their places, and each is clear when all others are known."""
    fixed = dict(stated) | {k: split.names for k, split in taken.items()}
    guess: dict[int, Split] = {}
    for _ in range(ROUNDS):
        before = {k: split.names for k, split in guess.items()}
        for k in waiting:
            if k not in taken:
                others = {j: split.names for j, split in guess.items() if j != k}
                found = splits.candidates(k, fixed | others)
                if not found:
                    return {}
                guess[k] = found[0]
        if before == {k: split.names for k, split in guess.items()}:
            break
    whole = dict(taken) | guess
    known = fixed | {k: split.names for k, split in guess.items()}
    cost = splits.bodies_for(known).cost
    swapped = (known | {j: known[k], k: known[j]} for j, k in combinations(sorted(guess), 2))
    if cost >= BROKEN or any(splits.bodies_for(one).cost - cost < ONLY_SPLIT for one in swapped):
        return {}
    return guess if _confirmed(splits, stated, whole) == set(whole) else {}


def _clear(splits: Splits, joint: int, known: Mapping[int, Names]) -> tuple[Split, float] | None:
    """The only split, and by how much the next one costs more; None where it is not clear."""
    found = splits.candidates(joint, known)
    before, after = (
        splits.bodies_for(known),
        splits.bodies_for(dict(known) | {joint: found[0].names}) if found else None,
    )
    if after is None or after.cost - before.cost >= BROKEN or not splits.divides(before, after):
        return None
    ahead = found[1].cost - found[0].cost if len(found) > 1 else np.inf
    named = {splits.assembly.parts_of(name)[0] for name in splits.joints[joint].between if name}
    named |= {name for names in known.values() for name in names}
    lone = [name for side in found[0].bodies if len(side) == 1 for name in side - named]
    if any(splits.round(joint, name) for name in lone) and splits.held_about(joint, found[0]):
        return None
    far = found[0].beyond > FAR_ALONG * splits.size
    if far or ahead < ONLY_SPLIT or splits.elsewhere(joint, known, found[0]):
        return None
    return found[0], ahead


def _problem(splits: Splits, joint: int, known: Mapping[int, Names]) -> Problem:
    """What is not clear about a joint, with its candidate splits."""
    it, units = splits.joints[joint], splits.assembly.units
    what = f"[[function.joint]] '{it.name}' names "
    what += f"one side only, '{it.between[0]}'" if it.between[0] else "none of its sides"
    found = splits.candidates(joint, known)
    found[1:1] = splits.elsewhere(joint, known, found[0]) if found else []
    if not found:
        where = "along it" if it.type in ("prismatic", "planar") else "about its axis"
        what += f", and no contact {where} parts two bodies there that no other joint parts; {_nearest(splits, it)}"
        return Problem(what, it.file or None, it.line, "name a part of either side in `between`, or correct its place")
    base = splits.bodies_for(known).cost
    lines = []
    # Splits that an error lists where several are possible: what fits a terminal.
    for split in found[:4]:
        first, second = split.names
        far = f", {length(split.beyond, units, 3)} along the axis from its point" if split.beyond > 0.0 else ""
        breaks = split.cost - base >= BROKEN
        lines.append(f"'{first}' from '{second}'{far}{', which breaks contact that no joint may part' * breaks}")
    more = len(found) - len(lines)
    splits_ = (
        f"{counted(len(found), 'way')} of parting may be meant" if len(found) > 1 else "the only way of parting is"
    )
    what += f", and {splits_}: " + "; ".join(lines) + (f"; and {more} more" if more else "")
    first, second = found[0].names
    return Problem(
        what, it.file or None, it.line, f'name a part of either side, as in between = ["{first}", "{second}"]'
    )


def _nearest(splits: Splits, joint: IntendedJoint) -> str:
    """Where the nearest journal is that has the joint's direction, or the nearest ball."""
    best: tuple[float, Names] | None = None
    for patch in splits.contacts.patches:
        if joint.point is None or patch.narrow or patch.kind not in ROUND:
            continue
        arm = patch.point - joint.point
        if joint.axis is None:
            if patch.kind != "sphere":
                continue
        elif patch.kind == "sphere" or abs(float(patch.axis @ joint.axis)) < np.cos(SAME_AXIS):
            continue
        else:
            arm = arm - (arm @ joint.axis) * joint.axis
        best = min(best or (np.inf, patch.parts), (norm(arm), patch.parts))
    if best is None:
        return "there is none of that kind anywhere" if joint.point is not None else "nothing guides it"
    kind = "ball" if joint.axis is None else "journal of that direction"
    if best[0] <= splits.contacts.tolerance.get(best[1], 0.0):
        return f"between {quoted(best[1])} there is one, and what else touches there is in the way of that motion"
    return f"the nearest {kind} is {length(best[0], splits.assembly.units, 3)} away, between {quoted(best[1])}"


def _found(splits: Splits, known: Mapping[int, Names], taken: Mapping[int, Split]) -> tuple[FoundSides, ...]:
    """The sides of the joints that were open: the one that is named first, else the one nearer to the ground."""
    body = splits.bodies_for(known).body
    steps = _steps(splits, known)
    sizes: dict[int | None, int] = {}
    for one in body.values():
        sizes[one] = sizes.get(one, 0) + 1
    out = []
    for k in sorted(taken):
        joint = splits.joints[k]
        names = known[k] if "" in splits.assembly.function.complete else _bearing(splits, k, known)
        first, second = sorted(names, key=lambda name: (steps.get(body[name], np.inf), -sizes[body[name]], name))
        parts: tuple[str, str] = (first, second)
        if joint.between[0]:
            own = body[splits.assembly.parts_of(joint.between[0])[0]]
            parts = (joint.between[0], first if body[second] == own else second)
        _, ahead = _clear(splits, k, {j: sides for j, sides in known.items() if j != k}) or (None, np.inf)
        rest = (
            "no other way of parting" if np.isinf(ahead) else f"the next way of parting costs {number(ahead, 3)} more"
        )
        where = "along its axis" if joint.type in ("prismatic", "planar") else "about its axis"
        of = [counted(sizes[body[splits.assembly.parts_of(name)[0]]], "part") for name in parts]
        out.append(FoundSides(joint.name, parts, f"contact {where} parts {of[0]} from {of[1]}; {rest}"))
    return tuple(out)


def _by_largest(splits: Splits, known: Mapping[int, Names], taken: Mapping[int, Split]) -> dict[int, Names]:
    """The sides of all joints, those that were open named by the largest part of each body, if no more is parted then:
    of a bearing's ring it is not known that it is of the side that it was found at."""
    parted = splits.bodies_for(known)
    largest: dict[int | None, PartName] = {}
    for name in sorted(splits.volume):
        body = parted.body.get(name)
        largest[body] = max(largest.get(body, name), name, key=lambda one: (splits.volume[one], one))
    out = dict(known)
    for k in taken:
        first, second = parted.sides[k]
        out[k] = (largest[first], largest[second])
    again = splits.bodies_for(out)
    return out if again.count == parted.count and again.cost <= parted.cost else dict(known)


def _bearing(splits: Splits, joint: int, known: Mapping[int, Names]) -> Names:
    """The largest part of each side that touches about the axis: where bodies do not follow from the function, it is
    they that have the joint."""
    parted = splits.bodies_for(known)
    sides = [splits.assembly.parts_of(name)[0] for name in known[joint]]
    for pair in splits.about(joint):
        for name in pair:
            for k, side in enumerate(parted.sides[joint]):
                if parted.body[name] == side:
                    sides[k] = max(sides[k], name, key=lambda one: (splits.volume[one], one))
    return sides[0], sides[1]


def _steps(splits: Splits, known: Mapping[int, Names]) -> dict[int | None, float]:
    """By how many joints each body is away from the ground."""
    parted = splits.bodies_for(known)
    merger = splits.merger.copy()
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

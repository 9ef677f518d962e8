"""What was done to the parts between two designs, and which changes of behaviour follow from it.

A part is moved by its pose, or by the same mesh written elsewhere: both are one displacement in the world. A change
follows from the parts that it is about, with those of their bodies; what is about no changed part, as the mobility,
follows from all of them together.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Literal

from kinform.changes.behaviours import Snapshot
from kinform.changes.change import Change
from kinform.changes.matching import new_names
from kinform.changes.shapes import displacement, moved, reshaped
from kinform.design import Design
from kinform.foundation.words import number
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly, Part

OF_THE_WHOLE = ("mobility", "simulation")
"""Kinds of changes that are about no part."""


CauseKind = Literal["part-moved", "part-shape", "part-facets", "part-material", "part-new", "part-gone"]


@dataclass(frozen=True, eq=False)
class Cause:
    """What was done to one part."""

    kind: CauseKind
    part: str
    """By its name now, or as it was where it is gone."""
    message: str
    """Without the part: "moved 1 mm along x"."""
    X: Array | None = None
    """(4, 4) displacement in the world from before to after; None where it did not move."""


@dataclass(frozen=True, eq=False)
class Consequences:
    """What follows from the same causes."""

    causes: tuple[Cause, ...]
    """Empty: no part that was changed is concerned."""
    changes: tuple[Change, ...]


def renames(before: Design, after: Design, old: Snapshot, new: Snapshot) -> dict[str, str]:
    """By part that is gone: the new part that is the same shape in the same place, else that alone has its mesh; `old`
    and `new` are the behaviours of the two designs."""
    was, now = ({str(part.name): part for part in design.assembly.parts} for design in (before, after))
    gone, fresh = ([name for name in one if name not in other] for one, other in ((was, now), (now, was)))
    pairs = [(a, b) for a in gone for b in fresh if _is_there(was[a], now[b], after.assembly.units)]
    of_gone, of_fresh = Counter(a for a, _ in pairs), Counter(b for _, b in pairs)
    there = {a: b for a, b in pairs if of_gone[a] == of_fresh[b] == 1}
    taken = set(there.values())
    return there | {a: b for a, b in new_names(old, new, there).items() if b not in taken}


def _is_there(was: Part, part: Part, units: str) -> bool:
    """Whether a part is the same shape in the same place."""
    if was.mesh is None or part.mesh is None or was.mesh.faces.shape != part.mesh.faces.shape:
        return False
    X, same = displacement(was, part)
    return same and X is not None and not moved(X, was, part, units)


def causes_of(before: Design, after: Design, other: Mapping[str, str]) -> tuple[Cause, ...]:
    """What was done to each part, in the order of the parts after, then those that are gone; `other` has the names that
    parts have now, by those that they had."""
    renamed = {name: was for was, name in other.items()}
    known = {str(part.name): part for part in before.assembly.parts}
    out, seen = [], set()
    for part in after.assembly.parts:
        was = known.get(renamed.get(str(part.name), str(part.name)))
        if was is None:
            out.append(Cause("part-new", str(part.name), "is new"))
        else:
            seen.add(str(was.name))
            out += _of_part(was, part, after.assembly)
    return (*out, *(Cause("part-gone", name, "is gone") for name in known if name not in seen))


def grouped(
    changes: Sequence[Change],
    causes: Sequence[Cause],
    designs: tuple[Design, Design],
    snapshots: tuple[Snapshot, Snapshot],
    other: Mapping[str, str],
) -> list[Consequences]:
    """Changes by the causes that they follow from, in the order of the causes; those of the whole, then those of no
    cause, are last. Without causes all are in one group. `other` as in `causes_of`."""
    groups: dict[tuple[str, ...], list[Change]] = {}
    changed = list(dict.fromkeys(cause.part for cause in causes))
    for cause in changed:
        groups[cause,] = []
    of_name: dict[str, set[str]] = {}
    for side, design in zip(snapshots, designs, strict=True):
        for name, parts in _parts_of_names(side, design).items():
            of_name.setdefault(name, set()).update(other.get(part, part) for part in parts)
    wholes = {side.assembly for side in snapshots} - set(of_name)
    for change in changes:
        concerned = {part for name in change.subject for part in of_name.get(name, (name,))}
        of_whole = change.kind in OF_THE_WHOLE or not wholes.isdisjoint(change.subject)
        key = tuple(changed) if of_whole else tuple(part for part in changed if part in concerned)
        groups.setdefault(key, []).append(change)
    order = sorted(groups, key=lambda key: (not key, len(key) > 1, len(key), [changed.index(part) for part in key]))
    return [Consequences(tuple(c for c in causes if c.part in key), tuple(groups[key])) for key in order]


def _parts_of_names(side: Snapshot, design: Design) -> dict[str, tuple[str, ...]]:
    """The parts that bodies, groups, joints and intended joints are of: all of their bodies."""
    bodies = dict(side.bodies or ())
    body_of = {part: body for body, parts in bodies.items() for part in parts}
    groups = {str(group.name): tuple(map(str, group.parts)) for group in design.assembly.groups}

    def whole(names: Iterable[str]) -> tuple[str, ...]:
        parts = [part for name in names for part in bodies.get(name) or groups.get(name, (name,))]
        held = dict.fromkeys(body_of[part] for part in parts if part in body_of)
        return tuple(dict.fromkeys((*parts, *(part for body in held for part in bodies[body]))))

    intended = {str(joint.name): whole(map(str, joint.between)) for joint in design.assembly.function.joints}
    joints = {joint.name: whole(joint.bodies) for joint in side.joints or ()}
    return {**groups, **intended, **joints, **bodies}


def _of_part(was: Part, part: Part, assembly: Assembly) -> list[Cause]:
    """What was done to a part that is in both."""
    name, units, out = str(part.name), assembly.units, []
    X, same = displacement(was, part)
    if X is not None:
        told = moved(X, was, part, units)
        if told:
            out.append(Cause("part-moved", name, told, X))
    if not same:
        kind, told = reshaped(was, part, X, units)
        out.append(Cause(kind, name, told))
    if (was.material, was.density) != (part.material, part.density):
        one, two = (_material(item) for item in (was, part))
        out.append(Cause("part-material", name, f"material {one} → {two}"))
    return out


def _material(part: Part) -> str:
    if part.material is not None:
        return part.material
    return "none" if part.density is None else f"{number(part.density)} kg/m³"

"""The ranges of joints that loops or stated ratios tie together to one motion, which is followed both ways.

Bodies that only spin on themselves, as loose pins do, are held; how far they spin by themselves is another question.
The motion (`loop_motion`) ends where parts meet, where the linkage comes back to its pose, where a second motion
branches off, or, where it goes on evenly, where a slide or screw leaves its guide.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from kinform.collisions.driving.alone import drive_alone
from kinform.collisions.driving.apart_for_good import that_can_meet
from kinform.collisions.driving.loop_motion import RETURNED, TOO_LONG, Between, Driven, Path, Tie, driven_block, follow
from kinform.collisions.driving.overlaps import Overlap, Pair, overlap_words
from kinform.collisions.pair.advancement import First, Near, first_crossing
from kinform.collisions.pair.posed_pairs import Moving, Nodes, moving_pairs
from kinform.collisions.parts.shapes import Shapes
from kinform.foundation.algebra.displacements import inverse
from kinform.foundation.rounding import SOLVED
from kinform.frozen import dataclass
from kinform.kinematics.mobility.guides import guide
from kinform.mechanism.closing import ACCEPTED
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.arrays import Array
from kinform.model.collisions import JointRange, RangeEnd
from kinform.model.kinematics import Freedom, Joint, Kinematics
from kinform.model.names import BodyName, PartName

TURNED_ROUND = 2.0 * math.pi - 0.2
"""rad: a joint of a motion that comes back, and turned by more, goes round and round. Chosen, not measured."""
LOOP_STOP = 1e-3
"""Share of a step to which a contact along a motion of loops is found. Chosen, not measured."""


LEAVES = "leaves its guide"
FREE = "nothing stops it"
STILL = "its loops do not move: `kinform show F.h5 mobility` says what does"


def drive_loops(
    shapes: Shapes, kinematics: Kinematics, graph: JointGraph, block: Sequence[int], ties: Sequence[Tie] = ()
) -> dict[int, JointRange] | str:
    """The ranges of the joints of one block, or of all that `ties` make move together; or why they are not known."""
    driven, idle = _driven(kinematics, graph, block, shapes.size, ties), _idle(kinematics, block)
    if driven == STILL and idle:
        return _spinning_alone(shapes, kinematics, block, idle)
    if isinstance(driven, str):
        return driven
    ends = [_travelled(shapes, kinematics, driven, follow(driven, -1.0))]
    # a motion that comes back to where it began, and meets nothing, is the same the other way round
    free = ends[0].why == RETURNED and not ends[0].left_out
    ends.append(ends[0] if free else _travelled(shapes, kinematics, driven, follow(driven, 1.0)))
    out = {}
    for k in block:
        joint = kinematics.joints[k]
        columns = driven.linkage.columns(joint.name)
        spinning = [freedom.body for freedom in idle if freedom.body in joint.bodies]
        if len(columns) == 1:
            out[k] = (
                _spun(shapes, kinematics, joint, spinning[0]) if spinning else _range(joint, driven, columns[0], ends)
            )
    return out


def is_followed(kinematics: Kinematics, graph: JointGraph, block: Sequence[int], ties: Sequence[Tie] = ()) -> bool:
    """Whether the motion of the joints of one block is followed, which takes long."""
    return not isinstance(_driven(kinematics, graph, block, 1.0, ties), str)


def _driven(
    kinematics: Kinematics, graph: JointGraph, block: Sequence[int], size: float, ties: Sequence[Tie]
) -> Driven | str:
    """The joints of one block with their one motion; or why they have none that is followed."""
    doubtful = [
        k for k in block if kinematics.joints[k].type == "general" or kinematics.joints[k].status == "ambiguous"
    ]
    if doubtful:
        how = "it moves with" if ties else "its loops run through"
        return f"{how} {kinematics.joints[doubtful[0]].name}, whose motion is not known"
    driven = driven_block(graph, block, _idle(kinematics, block), size, ties)
    system = driven.linkage.system
    first = driven.tangent(system.equations(system.start).jacobian[0])
    if first is None:
        return STILL
    return driven if first[1] else "its loops have more than one freedom, or a singular pose"


def _idle(kinematics: Kinematics, block: Sequence[int]) -> list[Freedom]:
    """The idle freedoms that move joints of a block."""
    names = {kinematics.joints[k].name for k in block}
    return [f for f in kinematics.mobility.named if f.idle and any(joint in names for joint, _, _ in f.drives)]


def _spinning_alone(
    shapes: Shapes, kinematics: Kinematics, block: Sequence[int], idle: Sequence[Freedom]
) -> dict[int, JointRange]:
    """The ranges of the joints of a block in which nothing moves but bodies that spin on themselves."""
    out, end = {}, RangeEnd("unknown", reason=STILL)
    for k in block:
        joint = kinematics.joints[k]
        spinning = [freedom.body for freedom in idle if freedom.body in joint.bodies]
        if joint.freedoms == 1:
            still = JointRange(joint.name, end, end)
            out[k] = _spun(shapes, kinematics, joint, spinning[0]) if spinning else still
    return out


def _spun(shapes: Shapes, kinematics: Kinematics, joint: Joint, body: BodyName) -> JointRange:
    """The range of a joint of a body that spins on itself while all else is at rest."""
    if joint.type != "revolute" or joint.axis is None or joint.point is None:
        end = RangeEnd("unknown", reason=f"'{body}' spins on itself")
        return JointRange(joint.name, end, end)
    spinning = sorted(shapes.body_parts[body])
    rest = sorted(part for name, parts in shapes.body_parts.items() if name != body for part in parts)
    spin = drive_alone(shapes, joint, *((rest, spinning) if joint.bodies[1] == body else (spinning, rest)))
    if spin.status == "unbounded":
        return spin
    end = RangeEnd("unknown", reason=f"'{body}' spins on itself, and not freely where it is")
    return JointRange(joint.name, end, end, spin.left_out)


@dataclass(frozen=True, eq=False)
class _Travelled:
    q: Array
    """(T, n) of what is free."""
    s: Array
    """(T,)."""
    why: str
    parts: tuple[PartName, ...]
    place: Array | None
    left_out: tuple[Pair, ...]
    overlap: str
    """Why these are left out."""


def _travelled(shapes: Shapes, kinematics: Kinematics, driven: Driven, path: Path) -> _Travelled:
    """The path until parts meet."""
    names = [str(body.name) for body in kinematics.bodies]
    path = _guided(shapes, kinematics, driven, path) if path.even else path
    s = path.s
    at = Between(driven, path.q, s)
    # pairs halve the same steps: most poses are asked for by several
    between = lru_cache(maxsize=None)(lambda x: driven.linkage.poses(at(x)[None])[0])
    nodes = Nodes(s, driven.linkage.poses(path.q), between)
    end, why, place = float(s[-1]), path.why, None
    parts: tuple[PartName, ...] = ()
    left_out = set()
    overlaps, rolls = [], ""
    for item in sorted(moving_pairs(shapes, names, kinematics.joints, nodes), key=lambda item: -item.free):
        test = item.test
        met = None if item.free >= end else that_can_meet(shapes, test, _relative(nodes, item))
        if met is None:
            continue
        near = None if met is test else Near(lambda *_, met=met: met, math.inf)
        first = first_crossing(test, item.course, end, LOOP_STOP, start=item.free, near=near)
        rolling = item.rolls and first.at is not None
        if first.overlaps or rolling:
            left_out.add(test.part_names)
        if first.overlaps:
            overlaps.append(Overlap(test.part_names, first.before, _placed(nodes, item.first, first)))
        elif rolling and not rolls:
            rolls = f"{' and '.join(test.part_names)} roll or mesh, and their facets overlap where they do"
        if first.deeper < end:
            end, parts, place = first.deeper, (), None
            why = overlap_words(overlaps[-1:], shapes.assembly.units)
        elif first.exhausted is not None:
            end, why, parts, place = first.exhausted, f"{' and '.join(test.names)} stay too close", (), None
        elif first.at is not None and first.place is not None and not item.rolls:
            end, why, parts = first.at, "", test.part_names
            place = _placed(nodes, item.first, first)
    if why == TOO_LONG and end == path.s[-1] and not left_out and _apart_for_good(nodes, driven, shapes.size):
        why = FREE
    kept = s < end
    q, s = np.concatenate([path.q[kept], at(end)[None]]), np.append(s[kept], end)
    overlap = overlap_words(overlaps, shapes.assembly.units) if overlaps else rolls
    return _Travelled(q, s, why, parts, place, tuple(sorted(left_out)), overlap)


def _apart_for_good(nodes: Nodes, driven: Driven, size: float) -> bool:
    """Whether all bodies have only slid, each relative to each by more than the `size` (m) of the whole, or not."""
    if driven.linkage.turns[~driven.held].any():
        return False
    places = nodes.displacements[-1, :, :3, 3]
    apart = np.linalg.norm(places[:, None] - places, axis=2)
    return bool(((apart > size) | (apart < SOLVED * size)).all())


def _relative(nodes: Nodes, item: Moving) -> Array:
    """(T, 4, 4) of the second body of a pair, as the first sees it."""
    return inverse(nodes.displacements[:, item.first]) @ nodes.displacements[:, item.second]


def _placed(nodes: Nodes, body: int, first: First) -> Array | None:
    """(3,) m, world, at the pose in which two parts first meet: where they do; `body` has the first of them."""
    if first.place is None:
        return None
    return np.asarray((nodes.between(first.at or float(nodes.s[0]))[body] @ np.append(first.place, 1.0))[:3])


def _guided(shapes: Shapes, kinematics: Kinematics, driven: Driven, path: Path) -> Path:
    """The path until the first of its slides and screws has left its guide."""
    end, why = float(path.s[-1]), path.why
    for joint in driven.linkage.joints:
        if joint.type not in ("prismatic", "screw") or joint.axis is None:
            continue
        (n,) = driven.linkage.columns(joint.name)
        values = path.q[:, n] / driven.linkage.coordinates[n].unit
        low, high = guide(*shapes.design(), joint, shapes.body_parts[joint.bodies[1]])
        limit = high if values[-1] > 0.0 else low
        if abs(values[-1]) > abs(limit):
            at = float(np.interp(abs(limit), np.abs(values), path.s))
            if at < end:
                end, why = at, f"'{joint.name}' {LEAVES}"
    kept = path.s < end
    last = np.array([np.interp(end, path.s, column) for column in path.q.T])
    return Path(np.vstack([path.q[kept], last]), np.append(path.s[kept], end), why, True)


def _range(joint: Joint, driven: Driven, column: int, ends: Sequence[_Travelled]) -> JointRange:
    """The values that one joint takes along what is free to both sides."""
    values = [end.q[:, column] / driven.linkage.coordinates[column].unit for end in ends]
    low, high = (
        min(_least(sign * v, end.s) for v, end in zip(values, ends, strict=True)) * sign for sign in (1.0, -1.0)
    )
    left_out = tuple(sorted({pair for end in ends for pair in end.left_out}))
    overlap = next((end.overlap for end in ends if end.overlap), "")
    if high - low < ACCEPTED and any(np.ptp(end.s) > 1.0 for end in ends):
        still = RangeEnd("unknown", reason="its loops move, and this joint stands still")
        return JointRange(joint.name, still, still, left_out)
    returned = any(end.why == RETURNED for end in ends)
    if returned and driven.linkage.turns[column] and high - low > TURNED_ROUND:
        free = RangeEnd("unknown", reason=overlap) if left_out else RangeEnd("unbounded")
        return JointRange(joint.name, free, free, left_out)
    sides = []
    for value in (low, high):
        n = min(range(2), key=lambda k: abs(float(values[k][-1]) - value))
        at_end = abs(float(values[n][-1]) - value) < SOLVED
        end = ends[n]
        if at_end and end.parts:
            sides.append(RangeEnd("found", float(value), end.parts, end.place))
        elif at_end and end.why.endswith(LEAVES):
            sides.append(RangeEnd("unbounded", reason=end.why, leaves=float(value)))
        elif at_end and end.why == FREE:
            sides.append(RangeEnd("unbounded"))
        elif at_end and end.why != RETURNED:
            sides.append(RangeEnd("unknown", reason=end.why))
        elif left_out:
            sides.append(RangeEnd("unknown", reason=overlap))
        else:
            sides.append(RangeEnd("found", float(value), reason="the linkage turns back"))
    return JointRange(joint.name, sides[0], sides[1], left_out)


def _least(values: Array, s: Array) -> float:
    """The least of values at parameters, between them where it is not at an end: of the parabola through three."""
    n = int(np.argmin(values))
    if n == 0 or n >= len(values) - 2:
        return float(values[n])
    bend, slope, least = (float(c) for c in np.polyfit(s[n - 1 : n + 2] - s[n], values[n - 1 : n + 2], 2))
    return least - slope * slope / (4.0 * bend) if bend > 0.0 else least

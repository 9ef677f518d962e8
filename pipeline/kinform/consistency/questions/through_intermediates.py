"""The relative motion of two bodies when loose parts between them take part.

A pin, a bearing or a screw that the function does not name carries a joint between two bodies that it does name. The
relative motion then follows from all of them: the closure of the two bodies, their direct contact and the bodies that
connect them, everything else left out.

Rolling elements touch by points and lines, whose normals turn as they move, so that the closure is valid at this
instant only. `rolling_elements` says which of the motion is there over a distance, and where it is in doubt.
"""

from __future__ import annotations

from collections.abc import Sequence
from collections.abc import Set as AbstractSet

import numpy as np

from kinform.consistency.questions.rolling_elements import Rolling, rolling, second_moves
from kinform.foundation.algebra.screws import Frame, span, twist_at_origin
from kinform.foundation.algebra.vectors import box, norm
from kinform.frozen import dataclass
from kinform.kinematics.joints.pair.lower_pairs import JointForm, name_space
from kinform.mechanism.first_order import body_twists, close
from kinform.model.arrays import Array
from kinform.model.contacts import Patch
from kinform.model.kinematics import Joint, Kinematics


@dataclass(frozen=True, eq=False)
class IntermediateMotion:
    """Relative motion of two bodies through intermediate bodies."""

    form: JointForm
    freedoms: int
    intermediates: tuple[str, ...]
    joints: tuple[Joint, ...]
    """All that take part, in the order of the kinematics."""
    twists: Array
    """(k, 6) of the second relative to the first (ω; v at the world's origin)."""
    rolling: Rolling | None
    """What is known of it where bodies touch by points and lines; None where none do."""


def motion_through_intermediates(
    kinematics: Kinematics,
    patches: Sequence[Patch],
    first: str,
    second: str,
    named: AbstractSet[str],
    size: float,
) -> IntermediateMotion | None:
    """The motion of `second` relative to `first` through bodies outside `named` and ground; None when
    no such body connects the two. `patches` are all those of the joints, `size` (m): of the smaller of the two."""
    between = _connecting(kinematics, first, second, named)
    if not between:
        return None
    nodes = [first, second, *(name for name in kinematics.named_bodies if name in between)]
    index = {name: k for k, name in enumerate(nodes)}
    joints = kinematics.joints_among(index.keys())
    edges = [(index[j.bodies[0]], index[j.bodies[1]]) for j in joints]
    spaces = [j.twists for j in joints]
    motions = body_twists(close(len(nodes), edges, spaces, 0), edges, spaces)
    points = np.array([j.point for j in joints if j.point is not None])
    if not len(points):
        points = np.array([patches[k].point for j in joints for k in j.patches if k < len(patches)]).reshape(-1, 3)
    frame = _frame(points, size)
    basis = span(second_moves(motions, frame))
    names = tuple(sorted(between))
    known = rolling(joints, edges, nodes, patches, motions, frame)
    return IntermediateMotion(
        name_space(basis, frame), basis.shape[1], names, tuple(joints), twist_at_origin(basis, frame).T, known
    )


def _frame(points: Array, size: float) -> Frame:
    """Where joints are, by their points (n, 3). All of them may be at one place, but for rounding, which is no length:
    what they move is as large as it is."""
    if not len(points):
        return Frame(np.zeros(3), size)
    low, high = box(points)
    return Frame(0.5 * (low + high), max(0.5 * norm(high - low), size))


def _connecting(kinematics: Kinematics, first: str, second: str, named: AbstractSet[str]) -> set[str]:
    """Helpers, which are neither named nor ground, reached from `first` over helpers alone, if `second` is reached too;
    else none."""

    def helpers(of: str) -> list[str]:
        near = kinematics.neighbours[of] - named - {first, second}
        return sorted(name for name in near if not kinematics.named_bodies[name].ground)

    # mostly one of them has no helper, and the other may have thousands of neighbours
    if not all(map(helpers, sorted((first, second), key=lambda name: len(kinematics.neighbours[name])))):
        return set()
    reached: set[str] = set()
    queue = helpers(first)
    arrived = False
    while queue:
        name = queue.pop()
        if name in reached:
            continue
        reached.add(name)
        arrived = arrived or second in kinematics.neighbours[name]
        queue.extend(other for other in helpers(name) if other not in reached)
    return reached if arrived else set()

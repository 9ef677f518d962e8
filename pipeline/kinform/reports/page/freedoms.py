"""The freedoms of an assembly as motions to look at: how far each is shown, in which steps, and what is said of it.

What moves, and where to, is found by `kinematics.mobility.freedom_motions`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

import numpy as np

from kinform.frozen import dataclass
from kinform.kinematics.mobility.freedom_motions import (
    DrivenFreedom,
    displaced,
    driven_freedoms,
    looped,
    moving,
    turns,
)
from kinform.model.arrays import Array
from kinform.model.kinematics import Kinematics
from kinform.reports.page.constants import SHOWN_TURN, SIDE_FRAMES

FINEST_TURN = math.radians(3.0)
"""rad, of one step: the eye sees larger ones as jumps."""
SHOWN_SLIDE = 0.14
"""Greatest slide of such a driver as a share of the assembly's size; a choice."""
FOLLOWER_TURN = 1.4
"""No joint turns further than this times SHOWN_TURN at the rates of the start; a choice."""
LARGE_SHARE = 0.25
"""Share of the way that assemblies go whose motion is shown at first order only, so that what opens stays small; a
choice."""
MOST_COORDINATES = 240
"""Assemblies with loops and more joint coordinates than this are shown at first order only: closing them is slow.
Chosen, not measured."""
EVEN = np.linspace(0.0, 1.0, 2 * SIDE_FRAMES + 1)
"""Shares of the way of a joint that another drives. By their sine the steps are small at its end, where a linkage turns
back and the loops close only just."""
MOST_FREEDOMS = 60
"""Freedoms that are shown. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class Showing:
    """One freedom, moved to and fro."""

    driver: str | None
    """Joint that drives it; None where only a body is known to move."""
    turns: bool
    bodies: tuple[str, ...]
    """What moves."""
    poses: Array
    """(F, B, 4, 4) motion of each body from where the meshes are, in the world."""
    shares: Array
    """(F,) of the way, from −1 through 0, the pose of the meshes, to 1."""
    note: str
    """How far it can be trusted; empty where the loops stay closed."""
    ends: tuple[float, float] = (0.0, 0.0)
    """Values of the driver at −1 and 1 (rad or m)."""


@dataclass(frozen=True)
class Span:
    """Values of a joint (rad or m) between which it is shown; None: kinform chooses."""

    lower: float | None = None
    upper: float | None = None


def freedom_motions(
    kinematics: Kinematics, size: float, spans: Mapping[str, Span] | None = None, asked: Iterable[str] = ()
) -> list[Showing]:
    """Each freedom of the assembly of this size (m) as a motion, then those that move the joints `asked` for, driven by
    these where another joint drives the freedom; `spans` of joints by name."""
    driven, loose = driven_freedoms(kinematics, size, MOST_FREEDOMS)
    has_loops, coordinates = looped(kinematics)
    large = has_loops and coordinates > MOST_COORDINATES
    out = [_shown(kinematics, freedom, size, spans or {}, large) for freedom in driven]
    led = {freedom.coordinate.joint for freedom in driven}
    for name in asked:
        others = (other for freedom in driven if (other := freedom.by(name)) is not None)
        if name not in led and len(out) < MOST_FREEDOMS and (other := next(others, None)) is not None:
            out.append(_shown(kinematics, other, size, spans or {}, large, np.sin(0.5 * np.pi * EVEN)))
    return out + [_adrift(kinematics, twists, size) for twists in loose[: MOST_FREEDOMS - len(out)]]


def _adrift(kinematics: Kinematics, twists: Array, size: float) -> Showing:
    """The motion of bodies (B, 6) that nothing connects to ground."""
    shares = np.linspace(-1.0, 1.0, 2 * SIDE_FRAMES + 1)
    poses = displaced(twists, shares, SHOWN_SLIDE, size)
    note = "no joint connects what moves to ground"
    return Showing(None, turns(twists, size), moving(kinematics, poses, size), poses, shares, note)


def _shown(
    kinematics: Kinematics,
    freedom: DrivenFreedom,
    size: float,
    spans: Mapping[str, Span],
    large: bool,
    steps: Array | None = None,
) -> Showing:
    """The motion of a freedom, as far to both sides as the span of its driver says and the loops close; `steps` are
    shares of the way to either side, even ones where none are given."""
    joint, angular = freedom.coordinate.joint, freedom.coordinate.turns
    span = spans.get(joint, Span())
    poses, shares, note, ends = [], [], "", []
    for sign, end in ((-1.0, span.lower), (1.0, span.upper)):
        reach = _reach(freedom, size, end)
        many = max(SIDE_FRAMES, int(np.ceil(reach / FINEST_TURN))) if angular else SIDE_FRAMES
        shown = np.linspace(0.0, 1.0, many + 1) if steps is None else steps
        values = sign * reach * shown
        q = freedom.at_first_order(LARGE_SHARE * values) if large else freedom.followed(values)
        followed = freedom.linkage.poses(q)
        if len(q) < len(values):
            note = note or "the loops do not close any further"
            followed = np.concatenate([followed, np.repeat(followed[-1:], len(values) - len(q), axis=0)])
        poses.append(followed)
        shares.append(sign * shown)
        ends.append(sign * reach)
    every = np.concatenate([poses[0][:0:-1], poses[1]])
    return Showing(
        joint, angular, moving(kinematics, every, size), every, np.concatenate([shares[0][:0:-1], shares[1]]),
        "at first order: the loops are too many to be closed" if large else note, (ends[0], ends[1]),
    )  # fmt: skip


def _reach(freedom: DrivenFreedom, size: float, end: float | None) -> float:
    """How far the driver goes to one side (rad or m, positive)."""
    angular = freedom.coordinate.turns
    if end is not None:
        # no turn is shown further than once round
        return float(min(abs(end), math.tau if angular else size))
    reach = float(SHOWN_TURN if angular else SHOWN_SLIDE * size)
    fastest = freedom.fastest_turn
    return min(reach, FOLLOWER_TURN * SHOWN_TURN / fastest) if fastest > 0.0 else reach

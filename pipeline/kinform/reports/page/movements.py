"""What moves in the view: the simulated run and each freedom, as poses over a parameter, with what happens on the way.

The parameter of a run is time (s). That of a freedom goes from −1 to 1: as far as parts let it, or the function
asks for, and else a little to both sides. Marks name where parts run into each other.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import Literal

import numpy as np

from kinform.design import Design
from kinform.foundation import words
from kinform.foundation.algebra.spatial import quaternions, to_matrix
from kinform.foundation.rounding import SOLVED
from kinform.frozen import dataclass
from kinform.function import DesignersJoint, designers_joints, resolve_joint, stated_ranges
from kinform.model.arrays import Array
from kinform.model.collisions import Collision, RangeEnd
from kinform.model.kinematics import Joint
from kinform.model.names import PartName
from kinform.model.simulation import Simulation
from kinform.reports.page.freedoms import Showing, Span, freedom_motions

MOST_FRAMES = 600
"""Poses of a simulated motion that are embedded; of longer ones an even choice. Twenty seconds at 30 a
second."""


@dataclass(frozen=True, eq=False)
class Mark:
    """Something that happens at one moment of a movement."""

    time: float
    """Parameter of the movement."""
    kind: Literal["collision", "end"]
    """collision: parts meet, and what follows could not happen; end: the run stopped."""
    text: str
    parts: tuple[PartName, ...] = ()
    place: Array | None = None
    """(3,) m, world, at that moment."""


@dataclass(frozen=True, eq=False)
class Movement:
    """Poses of some bodies from one end to the other."""

    kind: Literal["simulation", "freedom", "proposal", "revision"]
    name: str
    note: str
    time: Array
    """(F,) parameter, increasing."""
    bodies: tuple[str, ...]
    places: Array
    """(F, B, 3) m."""
    turns: Array
    """(F, B, 4) wxyz; with `places` the displacement of each body from the pose of the meshes."""
    marks: tuple[Mark, ...] = ()
    joint: str | None = None
    """That drives a freedom."""
    ends: tuple[float, float] = (0.0, 0.0)
    """Values of that joint at −1 and 1 (rad or m)."""
    angular: bool = True
    """Whether they are angles."""

    def at(self, time: float) -> dict[str, Array]:
        """Displacements (4, 4) of the bodies that move, between the two nearest poses."""
        k = int(np.clip(np.searchsorted(self.time, time, side="right") - 1, 0, len(self.time) - 2))
        share = float(np.clip((time - self.time[k]) / (self.time[k + 1] - self.time[k]), 0.0, 1.0))
        out = {}
        for b, name in enumerate(self.bodies):
            first, second = self.turns[k, b], self.turns[k + 1, b]
            mixed = (1.0 - share) * first + share * (second if first @ second >= 0.0 else -second)
            out[name] = np.eye(4)
            out[name][:3, :3] = to_matrix(mixed)
            out[name][:3, 3] = (1.0 - share) * self.places[k, b] + share * self.places[k + 1, b]
        return out

    def values(self, joint: Joint) -> Array:
        """(F,) of a joint of one freedom along it (rad or m): 0 at the pose of the meshes, and continuous."""
        poses = [self._displacements(name) for name in joint.bodies]
        relative = np.linalg.inv(poses[0]) @ poses[1]
        assert joint.axis is not None
        if joint.type == "prismatic":
            return np.asarray(relative[:, :3, 3] @ joint.axis)
        turned = relative[:, :3, :3]
        sines = np.stack([turned[:, k, j] - turned[:, j, k] for j, k in ((1, 2), (2, 0), (0, 1))], axis=1)
        angles = np.unwrap(np.arctan2(sines @ joint.axis, np.trace(turned, axis1=1, axis2=2) - 1.0))
        return np.asarray(angles - angles[np.argmin(np.abs(self.time))])

    def _displacements(self, body: str) -> Array:
        """(F, 4, 4) of a body from the pose of the meshes."""
        out = np.tile(np.eye(4), (len(self.time), 1, 1))
        if body in self.bodies:
            b = self.bodies.index(body)
            out[:, :3, :3] = [to_matrix(turn) for turn in self.turns[:, b]]
            out[:, :3, 3] = self.places[:, b]
        return out


def movements_of(design: Design, size: float) -> list[Movement]:
    """The simulated run, where there is one, then the freedoms; `size` is that of the assembly (m)."""
    known: set[str] = set() if design.kinematics is None else {str(body.name) for body in design.kinematics.bodies}
    run = design.simulation
    out = [] if run is None or len(run.time) < 2 else [_run(design, run, known)]
    if design.kinematics is not None:
        spans = _Spans(design)
        for showing in freedom_motions(design.kinematics, size, spans.known, spans.short):
            out.append(_as_designed(_freedom(design, showing, spans), spans.named.get(showing.driver or "")))
    return out


def _short(design: Design) -> list[str]:
    """Joints, by kinform's names, whose range falls short (KF412): the page shows their ends."""
    found = () if design.report is None else design.report.findings
    names = dict.fromkeys(one.subject[0] for one in found if one.code == "KF412")
    assert design.kinematics is not None
    joints = (resolve_joint(design.assembly, design.kinematics, name).joint for name in names)
    return [str(joint.name) for joint in joints if joint is not None]


def _run(design: Design, run: Simulation, known: set[str]) -> Movement:
    frames = np.unique(np.linspace(0, len(run.time) - 1, min(len(run.time), MOST_FRAMES)).round().astype(int))
    kept = [k for k, name in enumerate(run.body_names) if name in known]
    left = f"; every {len(run.time) / len(frames):.2g}th pose is shown" if len(frames) < len(run.time) else ""
    marks = [_collision(item, design.assembly.units) for item in run.collisions or ()]
    if run.status == "stopped":
        end = float(run.time[-1])
        marks.append(Mark(end, "end", f"stopped at {end:.4g} s: {run.reason}"))
    return Movement(
        kind="simulation",
        name=f"Simulated motion ({run.level})",
        note=f"{run.level} level, {run.time[-1]:.4g} s{left}",
        time=run.time[frames],
        bodies=tuple(run.body_names[k] for k in kept),
        places=run.p_WB[frames][:, kept],
        turns=run.q_WB[frames][:, kept],
        marks=tuple(marks),
    )


def _collision(item: Collision, units: str) -> Mark:
    depth = f", up to {words.length(item.depth, units)} deep" if np.isfinite(item.depth) else ""
    text = f"{item.time:.4g} s: {item.parts[0]} and {item.parts[1]} collide{depth}"
    return Mark(item.time, "collision", text, item.parts, item.place)


def _freedom(design: Design, showing: Showing, spans: _Spans) -> Movement:
    subject = ", ".join(showing.bodies)
    if showing.driver is not None:
        subject = spans.named[showing.driver].name if showing.driver in spans.named else showing.driver
    assert design.kinematics is not None
    moving = [k for k, body in enumerate(design.kinematics.bodies) if body.name in showing.bodies]
    poses = showing.poses[:, moving]
    return Movement(
        kind="freedom",
        name=f"Freedom: {subject} ({'turn' if showing.turns else 'slide'})",
        note=showing.note,
        time=showing.shares,
        bodies=showing.bodies,
        places=poses[..., :3, 3],
        turns=quaternions(poses[..., :3, :3].reshape(-1, 3, 3)).reshape(*poses.shape[:2], 4),
        marks=tuple(spans.marks(showing)),
        joint=showing.driver,
        ends=showing.ends,
        angular=showing.turns,
    )


def _as_designed(made: Movement, joint: DesignersJoint | None) -> Movement:
    """The movement with the parameter in the designer's sense: what goes to plus goes to the right."""
    if joint is None or joint.sign > 0:
        return made
    return replace(
        made,
        time=0.0 - made.time[::-1],
        places=made.places[::-1],
        turns=made.turns[::-1],
        marks=tuple(replace(mark, time=0.0 - mark.time) for mark in reversed(made.marks)),
        ends=(0.0 - made.ends[1], 0.0 - made.ends[0]),
    )


class _Spans:
    """How far to show each joint, and where it stops on the way."""

    def __init__(self, design: Design):
        self.design = design
        kinematics = design.kinematics
        self.short = [] if kinematics is None else _short(design)
        self.named = {} if kinematics is None else designers_joints(design.assembly, kinematics)
        run = design.simulation
        found = () if run is None else run.ranges or ()
        self.ranges = {str(item.joint): item for item in found}

    @cached_property
    def known(self) -> dict[str, Span]:
        """Of joints with one freedom: to where parts meet, and to where the function asks for if that is further."""
        kinematics = self.design.kinematics
        assert kinematics is not None
        asked = dict(stated_ranges(self.design.assembly, kinematics))
        out: dict[str, Span] = {}
        for joint in kinematics.joints:
            if joint.freedoms == 1 and joint.name in self.ranges:
                ends = self.ranges[joint.name].lower, self.ranges[joint.name].upper
                low, high = (self._stop(end) for end in ends)
                if joint.name in self.short:  # where a slide has left its guide
                    low, high = ends[0].leaves if low is None else low, ends[1].leaves if high is None else high
                wanted = asked.get(joint.name, (0.0, 0.0))
                # beyond where parts meet there is something to see, beyond where a linkage turns back there is nothing
                low = min(low, wanted[0]) if low is not None and ends[0].parts else low
                high = max(high, wanted[1]) if high is not None and ends[1].parts else high
                out[joint.name] = Span(low, high)
        return out

    @staticmethod
    def _stop(end: RangeEnd) -> float | None:
        return end.value if end.status == "found" and end.value is not None and np.isfinite(end.value) else None

    def marks(self, showing: Showing) -> list[Mark]:
        """Where the driver of a freedom is stopped."""
        if showing.driver is None or showing.driver not in self.known:
            return []
        item, out = self.ranges[showing.driver], []
        for end, reach, sign in zip((item.lower, item.upper), showing.ends, (-1, 1), strict=True):
            value = self._stop(end)
            if value is None or not end.parts or not 0.0 <= sign * value <= sign * reach * (1.0 + SOLVED):
                continue
            units = self.design.assembly.units
            told = value if showing.driver not in self.named else self.named[showing.driver].sign * value
            shown = words.angle(told, 4) if showing.turns else words.length(told, units)
            text = f"{shown}: {' and '.join(end.parts)} meet"
            share = sign * min(1.0, value / reach) if reach else float(sign)
            out.append(Mark(share, "collision", text, end.parts, end.place))
        return out

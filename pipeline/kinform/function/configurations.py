"""How bodies move relative to one of them: joint coordinates, their ranges, loops that stay closed.

A chain holds the joints on all paths between its bodies and nothing else; poses are displacements from the pose of
the meshes, relative to its root. Joints that are ambiguous, or known by their velocities only, have no poses: a
chain through one is refused with the reason. Ranges are those of the function and those that were found.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Literal

import numpy as np

from kinform.foundation.algebra.screws import Frame, scaled
from kinform.foundation.algebra.subspaces import null_space
from kinform.foundation.graphs.graph import blocks
from kinform.frozen import dataclass
from kinform.function.joint_names import stated_ranges
from kinform.mechanism.loop_system import LoopSystem, loop_system
from kinform.model.arrays import Array, Flags
from kinform.model.assembly import Assembly
from kinform.model.kinematics import Joint, Kinematics

LOOPS_CLOSED = 1e-9
"""Residual (rad, share of the size) at which loops count as closed."""
CLOSING_STEPS = 40
"""Newton's steps to close loops, after which they cannot be closed."""
CLOSING_STEP = 0.3
"""rad, or share of the size, that one of these steps changes a coordinate at most."""
DEPENDENT = 1e-7
"""Relative singular value below which constraints depend on each other, as in the count of freedoms."""
SOLVED = 1e-9
"""The same in least squares."""
RATE_MOVES = 1e-6
"""Rate of a coordinate in a unit motion above which it takes part."""
BODY_MOVES = 1e-9
"""Twist of a body in a unit motion above which it moves."""
ONE_POINT = 1e-9
"""Share of the largest part's size within which the joints of a chain are at one point; rounding."""


@dataclass(frozen=True)
class Coordinate:
    """One coordinate of a chain. Values in rad, or m, of the joint as kinform signs it."""

    joint: str
    turns: bool
    unit: float
    """Coordinate of the system for a value of 1."""
    lower: float
    upper: float
    """±inf where there is no bound, or none is known."""
    known: bool
    """Whether a range is stated or was found."""


@dataclass(frozen=True, eq=False)
class Chain:
    """Bodies, and the coordinates that decide where they are."""

    system: LoopSystem
    frame: Frame
    bodies: tuple[str, ...]
    """In the order of the system's bodies; the first is the root."""
    coordinates: tuple[Coordinate, ...]

    @property
    def looped(self) -> bool:
        """Whether there are loops to close, or ratios to keep."""
        return len(self.system.chords[0]) + len(self.system.ties) > 0

    @property
    def freedoms(self) -> int:
        """Freedoms of first order in the pose of the meshes."""
        return len(null_space(self._rows, DEPENDENT))

    @property
    def _rows(self) -> Array:
        """(6 loops + ties, n) Jacobian of the loops in the pose of the meshes."""
        return np.asarray(self.system.close(np.zeros((1, len(self.coordinates)))).jacobian[0])

    @property
    def lower(self) -> Array:
        """(n,) least coordinates."""
        return np.array([min(c.unit * c.lower, c.unit * c.upper) for c in self.coordinates])

    @property
    def upper(self) -> Array:
        """(n,) greatest coordinates."""
        return np.array([max(c.unit * c.lower, c.unit * c.upper) for c in self.coordinates])

    @property
    def unknown(self) -> tuple[str, ...]:
        """Joints of which no range is known."""
        return tuple(dict.fromkeys(c.joint for c in self.coordinates if not c.known))

    def undetermined(self, body: str) -> tuple[str, ...]:
        """Joints without a known range that can move the body, in the pose of the meshes, while all joints with one
        stand still."""
        held = np.eye(len(self.coordinates))[[c.known for c in self.coordinates]]
        tip = self.system.reach[self.index(body)]
        moved = [
            [c.joint for c, rate in zip(self.coordinates, loose, strict=True) if abs(rate) > RATE_MOVES]
            for loose in null_space(np.concatenate([self._rows, held]), DEPENDENT)
            if np.abs((tip * loose) @ self.system.screws).max() > BODY_MOVES
        ]
        return tuple(dict.fromkeys(name for names in moved for name in names))

    def local(self, points: Array) -> Array:
        """World points (…, 3) m in the system's coordinates."""
        return np.asarray((points - self.frame.centre) / self.frame.length)

    def world(self, poses: Array) -> Array:
        """Displacements (…, 4, 4) of the system as displacements in the world (m)."""
        out = poses.copy()
        turned = (poses[..., :3, :3] @ self.frame.centre[:, None])[..., 0]
        out[..., :3, 3] = poses[..., :3, 3] * self.frame.length + self.frame.centre - turned
        return np.asarray(out)

    def index(self, body: str) -> int:
        """Number of a body in the system."""
        return self.bodies.index(body)


def chain_between(
    assembly: Assembly, kinematics: Kinematics, root: str, tip: str, prefer: Literal["both", "stated"] = "both"
) -> Chain | str:
    """The chain of all paths between two bodies, or why there is none.

    `prefer`: the narrower of stated and found ranges ("both"), or the stated where there is one ("stated").
    """
    names: list[str] = [body.name for body in kinematics.bodies]
    edges = [(names.index(j.bodies[0]), names.index(j.bodies[1])) for j in kinematics.joints]
    extra = len(edges)
    every = blocks(len(names), [*edges, (names.index(root), names.index(tip))])
    used = [k for k in next(block for block in every if extra in block) if k != extra]
    if not used:
        return f"no joints connect '{root}' and '{tip}'"
    return _chain(assembly, kinematics, [kinematics.joints[k] for k in used], root, prefer)


def mechanism_of(assembly: Assembly, kinematics: Kinematics) -> Chain | str:
    """Everything that joints connect with the ground."""
    root = next((body.name for body in kinematics.bodies if body.ground), None)
    if root is None:
        return "there is no ground"
    reached, joints = {root}, list(kinematics.joints)
    grown = True
    while grown:
        more = {name for j in joints for name in j.bodies if reached & set(j.bodies)}
        grown = not more <= reached
        reached |= more
    used = [j for j in joints if set(j.bodies) <= reached]
    return _chain(assembly, kinematics, used, root, "both") if used else "nothing is joined to the ground"


def _chain(assembly: Assembly, kinematics: Kinematics, joints: Sequence[Joint], root: str, prefer: str) -> Chain | str:
    """The chain of these joints, or why it has no poses; what gears tie are coordinates with a fixed ratio."""
    teeth = {coupling.through: coupling for coupling in kinematics.couplings if coupling.meshing is not None}
    for joint in joints:
        if joint.status == "ambiguous":
            return f"joint '{joint.name}' is ambiguous: {joint.reason}"
        if joint.type == "general" and joint.freedoms and joint.name not in teeth:
            return f"joint '{joint.name}' is known by its velocities only"
    geared = [teeth[joint.name] for joint in joints if joint.type == "general" and joint.name in teeth]
    joints = [joint for joint in joints if joint.type != "general" or joint.name not in teeth]
    index = {joint.name: k for k, joint in enumerate(joints)}
    if not all(name in index for coupling in geared for name in coupling.joints):
        return f"the teeth of '{geared[0].through}' couple joints beside the chain"
    bodies = [root, *sorted({name for j in joints for name in j.bodies} - {root})]
    points = np.array([j.point for j in joints if j.point is not None]).reshape(-1, 3)
    frame = Frame.of(points) if len(points) else Frame(np.zeros(3), 1.0)
    half = max((0.5 * part.mesh.diagonal for part in assembly.parts if part.mesh is not None), default=0.0)
    if frame.length <= ONE_POINT * half or len(points) < 2:
        frame = Frame(frame.centre, half or 1.0)
    edges = [(bodies.index(j.bodies[0]), bodies.index(j.bodies[1])) for j in joints]
    ties = [(index[c.joints[0]], index[c.joints[1]], c.meshing.ratio) for c in geared if c.meshing is not None]
    system = loop_system(edges, [j.twists for j in joints], frame, ties)
    ranges = _ranges(assembly, kinematics, prefer)
    coordinates = [c for joint in joints for c in _coordinates(joint, frame, ranges)]
    return Chain(system, frame, tuple(bodies), tuple(coordinates))


def _coordinates(joint: Joint, frame: Frame, ranges: dict[str, tuple[float, float]]) -> Iterator[Coordinate]:
    for twist in joint.twists:
        beside = scaled(twist[:, None], frame)[:, 0]
        turns = float(np.linalg.norm(beside[:3])) > 1e-9 * float(np.linalg.norm(beside[3:]))
        vector = twist[:3] if turns else twist[3:]
        sign = -1.0 if joint.axis is not None and float(vector @ joint.axis) < 0.0 else 1.0
        unit = sign if turns else sign / frame.length
        single = joint.freedoms == 1 and joint.name in ranges
        low, high = ranges[joint.name] if single else (-math.inf, math.inf)
        yield Coordinate(joint.name, turns, unit, low, high, single)


def _ranges(assembly: Assembly, kinematics: Kinematics, prefer: str) -> dict[str, tuple[float, float]]:
    """Known ranges of joints, in kinform's sign."""
    out: dict[str, tuple[float, float]] = {}
    for joint in kinematics.joints:
        if joint.range_status in ("found", "unbounded"):
            low = -math.inf if joint.range_lower is None else joint.range_lower
            high = math.inf if joint.range_upper is None else joint.range_upper
            out[joint.name] = (low, high)
    for name, (low, high) in stated_ranges(assembly, kinematics):
        if prefer == "both" and name in out:
            low, high = max(low, out[name][0]), min(high, out[name][1])
        out[name] = (low, high)
    return out


def close(chain: Chain, q: Array, held: Flags) -> Array | None:
    """The closed configuration (n,) near q that leaves the `held` coordinates as they are; None where Newton's
    steps of least size find none."""
    q = q.copy()
    free = ~held
    for _ in range(CLOSING_STEPS):
        state = chain.system.close(q[None])
        residual = state.residual[0]
        if float(np.abs(residual).max(initial=0.0)) < LOOPS_CLOSED:
            return q
        step = np.linalg.lstsq(state.jacobian[0][:, free], -residual, rcond=SOLVED)[0]
        size = float(np.abs(step).max(initial=0.0))
        q[free] += step * min(1.0, CLOSING_STEP / max(size, 1e-300))
    return None

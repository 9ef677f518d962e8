"""What sensors read of a run: points, turns, distances, angles and reactions at the output times.

Velocities and accelerations are those of the equations of motion, not differences between outputs. Seen from a moving
frame they are those of a point in rotating axes: less the frame's own motion, the centrifugal and the Coriolis part
(Shabana, Dynamics of Multibody Systems, section 2).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.spatial import quaternions
from kinform.foundation.rounding import ARITHMETIC
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags
from kinform.model.sensors import Reading, SensorKind
from kinform.model.simulation import Simulation
from kinform.simulation.mechanism.mechanism import Mechanism
from kinform.simulation.mechanism.states import States

AXES = ("x", "y", "z")


@dataclass(frozen=True, eq=False)
class Probe:
    """A sensor on bodies and joints of a port model, by what they are called; world axes at the pose of the model."""

    name: str
    kind: SensorKind
    body: str = ""
    """Of a distance or an angle the first; of a reaction the one that it acts on."""
    other: str = ""
    """Of a distance or an angle the second."""
    point: Array | None = None
    """(3,) m, on the body: of points and distances."""
    other_point: Array | None = None
    """(3,) m, on the other."""
    axis: Array | None = None
    """(3,) unit: of an angle, carried by the body; None: the whole angle."""
    joint: str = ""
    """Of a reaction."""
    first: bool = False
    """Of a reaction: that it acts on the first body of the joint."""
    frame: str = ""
    """The body in whose axes, and as seen from which, values are; "" for the world."""


def with_readings(run: Simulation, states: States, mechanism: Mechanism, probes: tuple[Probe, ...]) -> Simulation:
    """The run with what the probes read; a reaction reads nothing where there are no forces."""
    columns: list[tuple[Reading, Array]] = []
    seen = _Seen(run, states, mechanism)
    for probe in probes:
        columns += seen.read(probe)
    if not columns:
        return run
    values = np.column_stack([values for _, values in columns])
    return replace(run, readings=tuple(reading for reading, _ in columns), sensed=values)


class _Seen:
    """Motion of points and bodies of a run."""

    def __init__(self, run: Simulation, states: States, mechanism: Mechanism):
        self.run, self.states, self.centre = run, states, mechanism.centre
        self.link = dict(zip(mechanism.bodies, mechanism.link_of.tolist(), strict=True))
        self.settled: Flags = np.asarray(np.isfinite(run.joint_acceleration).all(axis=1, keepdims=True))

    def read(self, probe: Probe) -> list[tuple[Reading, Array]]:
        """The columns of one probe."""
        if probe.kind == "point":
            assert probe.point is not None
            places = zip(("position", "velocity", "acceleration"), ("m", "m/s", "m/s²"), strict=True)
            return [
                column
                for (quantity, unit), values in zip(places, self._point(probe), strict=True)
                for column in _along(probe, quantity, unit, values)
            ]
        if probe.kind == "rotation":
            w, alpha = self._rotation(probe)
            return [
                *_along(probe, "angular velocity", "rad/s", w),
                *_along(probe, "angular acceleration", "rad/s²", alpha),
            ]
        if probe.kind == "distance":
            distance, rate = self._distance(probe)
            return [
                (Reading(probe.name, "distance", "", "m"), distance),
                (Reading(probe.name, "rate", "", "m/s"), rate),
            ]
        if probe.kind == "angle":
            angle, rate = self._whole_angle(probe) if probe.axis is None else self._angle_about(probe, probe.axis)
            return [(Reading(probe.name, "angle", "", "rad"), angle), (Reading(probe.name, "rate", "", "rad/s"), rate)]
        return self._reaction(probe)

    def _turned(self, body: str) -> tuple[Array, Array, Array]:
        """(T, 3, 3) rotation, (T, 3) angular velocity and acceleration of a body."""
        link = self.link[body]
        gained = self.states.accelerations[:, link, :3]
        return (
            self.states.poses[:, link, :3, :3],
            self.states.twists[:, link, :3],
            np.where(self.settled, gained, np.nan),
        )

    def _moved(self, body: str, point: Array) -> tuple[Array, Array, Array]:
        """(T, 3) place, velocity and acceleration of a point of a body; world, the place about the centre."""
        link = self.link[body]
        X, V, A = (of[:, link] for of in (self.states.poses, self.states.twists, self.states.accelerations))
        place = X[:, :3, :3] @ (point - self.centre) + X[:, :3, 3]
        velocity = V[:, 3:] + np.cross(V[:, :3], place)
        acceleration = A[:, 3:] + np.cross(A[:, :3], place) + np.cross(V[:, :3], velocity)
        return place, velocity, np.where(self.settled, acceleration, np.nan)

    def _point(self, probe: Probe) -> tuple[Array, Array, Array]:
        """Place, velocity and acceleration in the frame of the probe."""
        assert probe.point is not None
        p, v, a = self._moved(probe.body, probe.point)
        if not probe.frame:
            return p + self.centre, v, a
        R, w, alpha = self._turned(probe.frame)
        at, carried, gained = self._moved(probe.frame, np.zeros(3))
        arm = p - at
        speed = v - carried - np.cross(w, arm)
        rest = a - gained - np.cross(alpha, arm) - np.cross(w, np.cross(w, arm)) - 2.0 * np.cross(w, speed)
        return _in_axes(R, arm), _in_axes(R, speed), _in_axes(R, rest)

    def _rotation(self, probe: Probe) -> tuple[Array, Array]:
        _, w, alpha = self._turned(probe.body)
        if not probe.frame:
            return w, alpha
        R, spin, gained = self._turned(probe.frame)
        return _in_axes(R, w - spin), _in_axes(R, alpha - gained - np.cross(spin, w - spin))

    def _distance(self, probe: Probe) -> tuple[Array, Array]:
        assert probe.point is not None and probe.other_point is not None
        p, v, _ = self._moved(probe.body, probe.point)
        q, u, _ = self._moved(probe.other, probe.other_point)
        distance = np.linalg.norm(q - p, axis=1)
        with np.errstate(invalid="ignore"):
            return distance, np.einsum("ti,ti->t", q - p, u - v) / distance

    def _relative(self, probe: Probe) -> tuple[Array, Array]:
        """(T, 4) quaternion of the second body in the first, and (T, 3) its angular velocity there."""
        R, w, _ = self._turned(probe.body)
        S, u, _ = self._turned(probe.other)
        return quaternions(R.swapaxes(1, 2) @ S), _in_axes(R, u - w)

    def _whole_angle(self, probe: Probe) -> tuple[Array, Array]:
        q, w = self._relative(probe)
        q = np.where(q[:, :1] < 0.0, -q, q)
        size = np.linalg.norm(q[:, 1:], axis=1)
        with np.errstate(invalid="ignore"):
            rate = np.einsum("ti,ti->t", q[:, 1:], w) / size
        # Where the bodies are as they were drawn, any turn is away from there.
        return 2.0 * np.arctan2(size, q[:, 0]), np.where(size > ARITHMETIC, rate, np.linalg.norm(w, axis=1))

    def _angle_about(self, probe: Probe, axis: Array) -> tuple[Array, Array]:
        """The twist of the swing and twist about the axis: of a turn about it the turn itself."""
        q, w = self._relative(probe)
        c, s = q[:, 0], q[:, 1:] @ axis
        # The rate of a quaternion in the axes of the first is half of (0, ω) ∘ q.
        dc = -0.5 * np.einsum("ti,ti->t", w, q[:, 1:])
        ds = 0.5 * (w * c[:, None] + np.cross(w, q[:, 1:])) @ axis
        with np.errstate(invalid="ignore"):
            rate = 2.0 * (ds * c - s * dc) / (c * c + s * s)
        return _counted(2.0 * np.arctan2(s, c), rate, self.run.time), rate

    def _reaction(self, probe: Probe) -> list[tuple[Reading, Array]]:
        wrenches = self.run.F_A if probe.first else self.run.F_B
        if not len(wrenches):
            return []
        joint = self.run.joint_names.index(probe.joint)
        loose = self.run.undetermined[joint]
        out = []
        for quantity, unit, part in (("force", "N", slice(3, 6)), ("torque", "N·m", slice(0, 3))):
            values, open_ = wrenches[:, joint, part], loose[part]
            if probe.frame:
                values, open_ = _in_axes(self._turned(probe.frame)[0], values), np.repeat(open_.any(), 3)
            columns = _along(probe, quantity, unit, values)
            out += [(replace(at, known=not flag), data) for (at, data), flag in zip(columns, open_, strict=True)]
        return out


def _along(probe: Probe, quantity: str, unit: str, values: Array) -> list[tuple[Reading, Array]]:
    """A column along each axis."""
    return [(Reading(probe.name, quantity, axis, unit), values[:, k]) for k, axis in enumerate(AXES)]


def _in_axes(R: Array, values: Array) -> Array:
    """Vectors (T, 3) of the world in axes that R (T, 3, 3) turns."""
    return np.asarray(np.einsum("tji,tj->ti", R, values))


def _counted(angle: Array, rate: Array, time: Array) -> Array:
    """The angle with whole turns, as the rate tells between outputs."""
    out, turn = angle.copy(), 2.0 * np.pi
    for k in range(1, len(out)):
        mean = 0.5 * (rate[k - 1] + rate[k]) * (time[k] - time[k - 1])
        ahead = out[k - 1] + (mean if np.isfinite(mean) else 0.0)
        out[k] = angle[k] + turn * np.round((ahead - angle[k]) / turn)
    return out

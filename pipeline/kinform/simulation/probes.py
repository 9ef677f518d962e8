"""Which bodies and joints the sensors of an assembly stand for."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from kinform.frozen import dataclass
from kinform.function import resolve_joint
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.kinematics import Kinematics
from kinform.model.mass import MassReport
from kinform.model.sensors import Sensor
from kinform.model.simulation import SimulationLevel
from kinform.simulation.outcome.sensing import Probe


def probes_of(
    assembly: Assembly, kinematics: Kinematics, mass: MassReport | None, joints: Collection[str], level: SimulationLevel
) -> tuple[tuple[Probe, ...], tuple[str, ...]]:
    """The probes of sensors, and in words which sensors read nothing; `joints`: names of those that are simulated."""
    probes, silent = [], []
    for sensor in assembly.simulation.sensors if assembly.simulation is not None else ():
        try:
            probes.append(_Finder(assembly, kinematics, mass).probe(sensor, joints, level))
        except _Unread as why:
            silent.append(f'the sensor "{sensor.name}" reads nothing: {why}')
    return tuple(probes), tuple(silent)


class _Unread(Exception):
    """Why a sensor reads nothing."""


@dataclass(frozen=True)
class _Finder:
    assembly: Assembly
    kinematics: Kinematics
    mass: MassReport | None

    def probe(self, sensor: Sensor, joints: Collection[str], level: SimulationLevel) -> Probe:
        """The sensor on bodies. Raises _Unread."""
        frame = self._body(sensor.frame) if sensor.frame else ""
        if sensor.kind == "reaction":
            return self._reaction(sensor, joints, level, frame)
        body = self._body(sensor.part)
        other = self._body(sensor.other) if sensor.other else ""
        if other == body:
            raise _Unread(f"{sensor.part} and {sensor.other} are parts of one body")
        point = other_point = None
        if sensor.kind in ("point", "distance"):
            point = self._centre(body) if sensor.point is None else sensor.point
        if sensor.kind == "distance":
            other_point = self._centre(other) if sensor.other_point is None else sensor.other_point
        return Probe(sensor.name, sensor.kind, body, other, point, other_point, sensor.axis, frame=frame)

    def _body(self, name: str) -> str:
        try:
            return str(self.kinematics.body_of(self.assembly.parts_of(name)[0]).name)
        except KeyError:
            raise _Unread(f'"{name}" is no part or group') from None

    def _centre(self, body: str) -> Array:
        for found in self.mass.bodies if self.mass is not None else ():
            if found.name == body and found.mass is not None and np.all(np.isfinite(found.centre_of_mass)):
                return found.centre_of_mass
        raise _Unread(f"the centre of mass of {body} is not known: state the point")

    def _reaction(self, sensor: Sensor, joints: Collection[str], level: SimulationLevel, frame: str) -> Probe:
        if level != "dynamic":
            raise _Unread(f"there are no forces at the {level} level")
        meant = resolve_joint(self.assembly, self.kinematics, sensor.joint)
        if meant.joint is None:
            raise _Unread(meant.reason)
        if meant.joint.name not in joints:
            raise _Unread(f'the joint "{meant.joint.name}" is not simulated')
        bodies = tuple(map(str, meant.joint.bodies))
        side = self._body(sensor.part or self._second(sensor.joint, bodies[1]))
        if side not in bodies:
            raise _Unread(f"{sensor.part} is on neither side of {sensor.joint}")
        return Probe(sensor.name, "reaction", side, joint=str(meant.joint.name), first=side == bodies[0], frame=frame)

    def _second(self, name: str, otherwise: str) -> str:
        """The second side of the joint as the designer states it."""
        for intended in self.assembly.function.joints:
            if intended.name == name:
                return intended.between[1] or otherwise
        return otherwise

"""The effort that holds a joint of a design at rest without friction: gravity, loads and springs in a stated pose."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from kinform.foundation.algebra.vectors import cross
from kinform.foundation.rounding import SINGLE
from kinform.frozen import dataclass
from kinform.function.configurations import Chain, mechanism_of
from kinform.function.holding import Force, body_motions, configuration_at, held_motion, holding_effort
from kinform.function.joint_names import resolve_joint, stated_as, stated_ranges
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.function import Drive, SimulationRequest
from kinform.model.kinematics import Joint, Kinematics
from kinform.model.mass import MassReport


def mechanism_at_rest(assembly: Assembly, kinematics: Kinematics, mass: MassReport) -> MechanismAtRest | str:
    """Everything that joints connect with the ground, or why it has no poses."""
    chain = mechanism_of(assembly, kinematics)
    return chain if isinstance(chain, str) else MechanismAtRest(assembly, kinematics, mass, chain)


@dataclass(frozen=True, eq=False)
class MechanismAtRest:
    """A mechanism of which joints are held one at a time."""

    assembly: Assembly
    kinematics: Kinematics
    mass: MassReport
    chain: Chain

    @property
    def gravity(self) -> Array:
        """(3,) m/s²."""
        return np.asarray((self.assembly.simulation or SimulationRequest()).gravity, dtype=np.float64)

    def effort(self, joint: Joint, pose: Mapping[str, float]) -> float | str:
        """N·m or N that holds the joint while other joints have the values (rad or m) of the pose, by the designer's
        names; or why it is not determined."""
        function = self.assembly.function
        if function.springs:
            return "springs between two points are not reckoned with: only a dynamic run with the joint held shows it"
        if any(load.law is not None for load in function.loads):
            return "a load changes over time: only a dynamic run with the joint held shows it"
        wanted = self._values(pose)
        if isinstance(wanted, str):
            return wanted
        q = configuration_at(self.chain, wanted)
        if isinstance(q, str):
            return q
        coordinates = zip(self.chain.coordinates, q, strict=True)
        values: dict[str, float] = {c.joint: float(x) / c.unit for c, x in coordinates}
        drives, springs = self._acting(values)
        return holding_effort(self.chain, q, joint.name, drives, springs, self._force())

    def work(self, joint: Joint, pose: Mapping[str, float]) -> Mapping[str, Array] | None:
        """What the effort of the joint can be recomputed from by virtual work: masses with their centres in the pose
        and the motion (n, 6) of each as the joint moves by one; the forces of loads likewise, and what springs give."""
        wanted = self._values(pose)
        q = wanted if isinstance(wanted, str) else configuration_at(self.chain, wanted)
        if isinstance(q, str):
            return None
        coordinates = zip(self.chain.coordinates, q, strict=True)
        drives, springs = self._acting({c.joint: float(x) / c.unit for c, x in coordinates})
        held = held_motion(self.chain, q, joint.name, drives)
        if isinstance(held, str):
            return None
        rates = held[0] * self.chain.coordinates[held[2]].unit
        twists, poses = (
            body_motions(self.chain, q, rates),
            self.chain.linkage.world(self.chain.system.bodies(q[None])[0]),
        )
        properties = {p.name: p for p in self.mass.bodies}
        moving = [(properties[name], X, twist) for name, X, twist in zip(self.chain.bodies, poses, twists, strict=True)
                  if np.abs(twist).max() > 0.0]  # fmt: skip
        if any(weight.mass is None for weight, _, _ in moving):
            return None
        force = self._force()
        # a wrench about the origin is a force there, and a torque
        wrenches = [(force(weight.name, X), weight, X) for weight, X, _ in moving]
        loads = []
        for found, weight, X in wrenches:
            assert found is not None
            gravity = (weight.mass or 0.0) * self.gravity
            centre = X[:3, :3] @ weight.centre_of_mass + X[:3, 3]
            loads.append((*(found[0] - gravity), *(found[1] - cross(centre, gravity))))
        pulled = zip(rates, self.chain.coordinates, strict=True)
        return {
            "gravity": self.gravity,
            "masses": np.array([weight.mass for weight, _, _ in moving]),
            "centres": np.array([X[:3, :3] @ weight.centre_of_mass + X[:3, 3] for weight, X, _ in moving]),
            "motions": np.array([twist for *_, twist in moving]),
            "loads": np.array(loads),
            "springs": np.array(sum(springs.get(c.joint, 0.0) * rate / c.unit for rate, c in pulled)),
        }

    def _values(self, pose: Mapping[str, float]) -> dict[str, float] | str:
        """Values by derived joints, in kinform's sense, or what is wrong with the pose."""
        wanted: dict[str, float] = {}
        for name, value in pose.items():
            resolution = resolve_joint(self.assembly, self.kinematics, name)
            if resolution.joint is None:
                return f"joint '{name}' is not found: {resolution.reason}"
            wanted[resolution.joint.name] = resolution.sign * value
        for coordinate in self.chain.coordinates:
            asked = wanted.get(coordinate.joint)
            if asked is not None and not coordinate.lower - SINGLE <= asked <= coordinate.upper + SINGLE:
                name, _ = stated_as(self.assembly, self.kinematics, coordinate.joint)
                return f"joint '{name}' would be outside of its range"
        return wanted

    def _acting(self, values: Mapping[str, float]) -> tuple[list[str], dict[str, float]]:
        """Derived joints with drives that hold them, and what springs give on joints at these values."""
        drives: list[str] = []
        springs: dict[str, float] = {}
        for drive in self.assembly.function.drives:
            resolution = resolve_joint(self.assembly, self.kinematics, drive.joint)
            driven = resolution.joint
            if driven is None:
                continue
            if drive.kind == "spring":
                pull = _pull(drive, driven, resolution.sign, values.get(driven.name, 0.0))
                springs[driven.name] = springs.get(driven.name, 0.0) + pull
            elif drive.kind != "damper":
                drives.append(driven.name)
        return drives, springs

    def _force(self) -> Force:
        """Gravity and loads on a body that is displaced by X."""
        assembly, kinematics = self.assembly, self.kinematics
        properties = {p.name: p for p in self.mass.bodies}
        loads = [(kinematics.body_of(assembly.parts_of(load.part)[0]).name, load) for load in assembly.function.loads]

        def force(body: str, X: Array) -> tuple[Array, Array] | None:
            weight = properties[body]
            if weight.mass is None:
                return None
            R, p = X[:3, :3], X[:3, 3]
            total = weight.mass * self.gravity
            moment = cross(R @ weight.centre_of_mass + p, total)
            for name, load in loads:
                if name != body:
                    continue
                turn = R if load.frame == "body" else np.eye(3)
                point = R @ (weight.centre_of_mass if load.point is None else load.point) + p
                if load.force is not None:
                    total = total + turn @ load.force
                    moment = moment + cross(point, turn @ load.force)
                if load.torque is not None:
                    moment = moment + turn @ load.torque
            return total, moment

        return force


def pose_values(assembly: Assembly, kinematics: Kinematics, pose: Mapping[str, float]) -> dict[str, float] | str:
    """The values (rad or m) of derived joints in a pose, in kinform's sense; or what is wrong with it: joints that are
    not there, or have several freedoms, and values outside of stated ranges."""
    ranges = dict(stated_ranges(assembly, kinematics))
    out: dict[str, float] = {}
    for name, value in pose.items():
        resolution = resolve_joint(assembly, kinematics, name)
        if resolution.joint is None:
            return f"joint '{name}' is not found: {resolution.reason}"
        if resolution.joint.freedoms != 1:
            return f"joint '{name}' has several freedoms"
        own = str(resolution.joint.name)
        out[own] = resolution.sign * value
        lower, upper = ranges.get(own, (out[own], out[own]))
        if not lower - SINGLE <= out[own] <= upper + SINGLE:
            return f"joint '{stated_as(assembly, kinematics, own)[0]}' would be outside of its range"
    return out


def _pull(drive: Drive, joint: Joint, sign: int, value: float) -> float:
    """Effort of a spring on a joint at a value."""
    rest = sign * drive.parameters.get("rest", 0.0) * drive.scale(joint.type != "prismatic")
    return drive.parameters["stiffness"] * (rest - value)

"""To which sub-assembly each component of a port model belongs.

A body belongs to the innermost sub-assembly that holds all of its parts, a joint to the innermost one that holds
both bodies, what acts on a joint to the joint's, a load to its body's. "yaw_motor/stator" is a part of "yaw_motor".
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from kinform.behaviour.components import Component, Ground, JointComponent, RigidBody, System

__all__ = ["homes"]


def homes(system: System, parts: Mapping[str, Sequence[str]]) -> dict[str, str]:
    """Path of the sub-assembly of each component of a flat system, by its name; "" where it is in none.

    `parts` are those of each body, by what the body is called.
    """
    out: dict[str, str] = {}
    for body in system.bodies:
        out[body.name] = _shared(part.rpartition("/")[0] for part in parts[body.subject])
    for joint in system.joints:
        out[joint.name] = _shared(_near(system, joint, out, Ground | RigidBody))
    for gear in system.gears:
        out[gear.name] = _shared(_near(system, gear, out, JointComponent))
    for component in system.components:
        if component.name not in out and component.ports[0].name != "terminals":
            out[component.name] = _shared(_near(system, component, out, JointComponent | Ground | RigidBody))
    for component in system.components:
        if component.name not in out:
            out[component.name] = _shared(_near(system, component, out, Component))
    return out


def _near(system: System, component: Component, known: Mapping[str, str], kinds: object) -> list[str]:
    """Homes of the components of these kinds at the nodes of its ports, but not of the other things there."""
    return [
        known[other.name]
        for port in component.ports
        for other, _ in system.at(component.name, port.name)
        if isinstance(other, kinds) and other.name in known  # type: ignore[arg-type]
    ]


def _shared(paths: Iterable[str]) -> str:
    """The innermost path around all these paths."""
    steps = [path.split("/") if path else [] for path in paths]
    out: list[str] = []
    for level in zip(*steps, strict=False):
        if len(set(level)) > 1:
            break
        out.append(level[0])
    return "/".join(out)

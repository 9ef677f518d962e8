"""To which sub-assembly each component of a port model belongs.

A body belongs to the innermost sub-assembly that holds all of its parts, a joint to the innermost one that holds
both bodies, what acts on a joint to the joint's, a load to its body's. "yaw_motor/stator" is a part of "yaw_motor".
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from kinform.behaviour.components import System


def component_owners(system: System, parts: Mapping[str, Sequence[str]]) -> dict[str, str]:
    """Path of the sub-assembly of each component of a flat system, by its name; "" where it is in none.

    `parts` are those of each body, by what the body is called.
    """
    out: dict[str, str] = {}
    for body in system.bodies:
        out[body.name] = _shared(part.rpartition("/")[0] for part in parts[body.subject])
    for joint in system.joints:
        out[joint.name] = _shared(out[body.name] for port in ("a", "b") for body in system.bodies_at(joint.name, port))
    for component in system.components:
        if component.name not in out and component.ports[0].name != "terminals":
            met = [
                other.name
                for port in component.ports
                for other in system.bodies_at(component.name, port.name) or system.joints_at(component.name, port.name)
            ]
            out[component.name] = _shared(out[name] for name in met)
    for component in system.components:
        if component.name not in out:  # supplies of motors
            near = [other.name for other, _ in system.at(component.name, "terminals")]
            out[component.name] = _shared(out[name] for name in near if name in out)
    return out


def _shared(paths: Iterable[str]) -> str:
    """The innermost path around all these paths."""
    steps = [path.split("/") if path else [] for path in paths]
    out: list[str] = []
    for level in zip(*steps, strict=False):
        if len(set(level)) > 1:
            break
        out.append(level[0])
    return "/".join(out)

"""What bodies are called where people read: their own names come from the alphabet, which may choose a motor's horn.

A body of several parts is "body of" the part by which the function names it, else of its largest part. Names in
results, fingerprints, locks and JSON stay what the contract says.
"""

from __future__ import annotations

from kinform.kinematics.joints.bodies.extents import part_volumes
from kinform.model.assembly import Assembly
from kinform.model.kinematics import Kinematics


def body_titles(assembly: Assembly, kinematics: Kinematics) -> dict[str, str]:
    """As in {"horn": "body of base"}: of bodies that are called otherwise than by their best known part."""
    groups = {str(group.name) for group in assembly.groups}
    named = [side for joint in assembly.function.joints for side in joint.between]
    volume = part_volumes(assembly)
    out = {}
    for body in kinematics.bodies:
        if body.name in groups or len(body.parts) < 2:
            continue
        chief = next((name for name in named if name in body.parts), None)
        largest = min(body.parts, key=lambda part: (-volume.get(part, 0.0), part))
        if (chief or str(largest)) != body.name:
            out[str(body.name)] = f"body of {chief or largest}"
    return out

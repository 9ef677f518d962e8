"""Idle turns of all bodies of an assembly, with the balls that touch at points or along lines."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from functools import partial

from kinform.kinematics.bodies.stated_joints import Pair, pair_between
from kinform.kinematics.mobility.idle import idle_freedoms
from kinform.kinematics.pair.answer import Answers, ask
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.contacts import Patch
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import Body, Joint
from kinform.model.names import BodyName, PartName
from kinform.model.surfaces import MeshSurfaces

__all__ = ["idle_turns", "touching_balls"]


def idle_turns(
    assembly: Assembly,
    bodies: tuple[Body, ...],
    joints: tuple[Joint, ...],
    patches: tuple[Patch, ...],
    size: float,
    balls: Mapping[tuple[int, PartName], Array],
    answers: Answers | None,
) -> dict[BodyName, Array]:
    """Idle turns (k, 6) of each body."""
    of_part = {part: body.name for body in bodies for part in body.parts}
    intended: dict[Pair, list[IntendedJoint]] = defaultdict(list)
    for wanted in assembly.function.joints:
        pair = pair_between(assembly, of_part, wanted.between)
        if pair is not None:
            intended[pair].append(wanted)
    around: dict[BodyName, list[Joint]] = defaultdict(list)
    for joint in joints:
        for name in joint.bodies:
            around[name].append(joint)
    out: dict[BodyName, Array] = {}
    for body in bodies:
        mine = around[body.name]
        indices = [k for j in mine for k in j.patches]
        carried = [patches[k] for k in indices]
        if any(not j.patches for j in mine):
            continue
        own = {}
        if len(mine) > 1:
            # a ball between others rolls; what lies on one other body only is there to move on it
            own = {n: balls[k, p] for n, k in enumerate(indices) for p in body.parts if (k, p) in balls}
        named = [w for j in mine for w in intended[j.bodies]]
        given = (body.ground, mine, carried, named, size, own)
        find = partial(idle_freedoms, body, mine, carried, named, size, own)
        out[body.name] = ask(answers, "idle", given, find)
    return out


def touching_balls(
    assembly: Assembly, surfaces: Mapping[str, MeshSurfaces], patches: Sequence[Patch]
) -> dict[tuple[int, PartName], Array]:
    """Centres (3,) of the spheres that touch at points or along lines, by patch and part."""
    parts = {part.name: part for part in assembly.parts}
    out = {}
    for k, patch in enumerate(patches):
        if patch.kind not in ("point", "line"):
            continue
        for name, number in zip(patch.parts, patch.surfaces, strict=True):
            mesh, X_WP = parts[name].mesh, parts[name].X_WP
            known = None if mesh is None or number < 0 else surfaces.get(mesh.digest)
            surface = None if known is None else known.surfaces[number]
            if surface is not None and surface.kind == "sphere":
                out[k, name] = X_WP[:3, :3] @ surface.point + X_WP[:3, 3]
    return out

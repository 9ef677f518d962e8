"""What the catalog keeps of one design. SI and radians, world axes at the pose of the meshes."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from typing import Literal

import numpy as np

from kinform.consistency import verdict_of
from kinform.consistency.judgement import VerdictKind
from kinform.design import Design
from kinform.errors import StageError
from kinform.foundation.graphs.graph import forest
from kinform.frozen import dataclass
from kinform.function import resolve_joint
from kinform.function.amounts import amount_of
from kinform.model.assembly import Assembly
from kinform.model.findings import CheckReport
from kinform.model.function import IntendedJoint, Requirement
from kinform.model.kinematics import Joint, Kinematics

Triple = tuple[float, float, float]

Verdict = Literal["verified", "no errors found", "findings", "not verified"]
VERDICTS: dict[VerdictKind, Verdict] = {
    "consistent": "verified", "no errors found": "no errors found", "inconsistent": "findings",
    "not verified": "not verified",
}  # fmt: skip
"""By the kind of the gate's verdict."""


@dataclass(frozen=True)
class CatalogJoint:
    """A joint of a design, and what the designer calls it where the function states it."""

    name: str
    type: str
    status: str
    freedoms: int
    axis: Triple | None
    point: Triple | None
    """m."""
    pitch: float | None
    """m a turn."""
    lower: float | None
    """rad or m; ±inf where unbounded, None where not known."""
    upper: float | None
    intended: str | None
    wanted_lower: float | None
    """Of the range that the function states, about the designer's axis."""
    wanted_upper: float | None


@dataclass(frozen=True)
class CatalogRequirement:
    """A requirement of a design, and whether it is met; None: nobody knows."""

    name: str
    kind: str
    met: bool | None


@dataclass(frozen=True)
class Entry:
    """What one design does."""

    path: str
    """Of the results file, relative to the folder of the catalog, with slashes."""
    digest: str
    """SHA-256 of the results file."""
    name: str
    units: str
    parts: tuple[str, ...]
    bodies: int
    instantaneous: int
    finite: int | None
    effective: int
    idle: int
    loops: int
    """Independent loops of the graph of bodies and joints."""
    mass: float | None
    """kg, of everything; None where that of a part is not known."""
    size: Triple | None
    """m, sides of the box around all meshes along the world's axes."""
    verdict: Verdict | None
    """None where it was not checked."""
    joints: tuple[CatalogJoint, ...]
    requirements: tuple[CatalogRequirement, ...]
    graph: str = ""
    """The same for designs whose graph of bodies and joints, with the types of joints and the ground, is the same."""


def entry_of(design: Design, path: str, digest: str) -> Entry:
    """The entry of a design whose results file is at `path`. Raises StageError where joints are not known."""
    kinematics = design.kinematics
    if kinematics is None:
        raise StageError("`kinform catalog`", "joints")
    mobility = kinematics.mobility
    return Entry(
        path, digest,
        name=design.assembly.name,
        units=design.assembly.units,
        parts=tuple(str(part.name) for part in design.assembly.parts),
        bodies=len(kinematics.bodies),
        instantaneous=mobility.instantaneous,
        finite=mobility.finite,
        effective=mobility.effective,
        idle=mobility.idle,
        loops=_loops(kinematics),
        mass=_mass(design),
        size=_size(design.assembly),
        verdict=None if design.report is None else VERDICTS[verdict_of(design.report).kind],
        joints=_joints(design.assembly, kinematics),
        requirements=tuple(_requirement(wanted, design.report) for wanted in design.assembly.function.requirements),
        graph=graph_of(
            [body.ground for body in kinematics.bodies],
            [(j.type, _index(kinematics, j.bodies[0]), _index(kinematics, j.bodies[1])) for j in kinematics.joints],
        ),
    )  # fmt: skip


def graph_of(grounds: Sequence[bool], joints: Iterable[tuple[str, int, int]]) -> str:
    """A hash of a graph that is the same however bodies are numbered: of bodies, whether each is the ground, and
    joints, each its type and its two bodies.

    Colours of bodies are refined by those of their neighbours until they part no further (Weisfeiler and Lehman 1968).
    Graphs that are not the same can have one hash where they are as regular as two triangles and a hexagon.
    """
    edges = list(joints)
    colours = ["ground" if ground else "body" for ground in grounds]
    for _ in range(len(colours)):
        around: list[list[str]] = [[] for _ in colours]
        for kind, a, b in edges:
            around[a].append(f"{kind} {colours[b]}")
            around[b].append(f"{kind} {colours[a]}")
        finer = [_hash(colour, *sorted(near)) for colour, near in zip(colours, around, strict=True)]
        if len(set(finer)) == len(set(colours)) and _ > 0:
            break
        colours = finer
    told = [f"{kind} {' '.join(sorted((colours[a], colours[b])))}" for kind, a, b in edges]
    return _hash(*sorted(colours), "joints", *sorted(told))


def _hash(*words: str) -> str:
    return hashlib.sha256("\0".join(words).encode()).hexdigest()[:32]


def _index(kinematics: Kinematics, body: str) -> int:
    return next(k for k, one in enumerate(kinematics.bodies) if one.name == body)


def _loops(kinematics: Kinematics) -> int:
    """Joints less those of a spanning forest."""
    index = {body.name: k for k, body in enumerate(kinematics.bodies)}
    edges = [(index[a], index[b]) for a, b in (joint.bodies for joint in kinematics.joints)]
    return len(edges) - sum(edge >= 0 for edge in forest(len(index), edges, 0).edge) if index else 0


def _mass(design: Design) -> float | None:
    if design.mass is None:
        return None
    found = amount_of(design.assembly, design.mass, [part.name for part in design.assembly.parts])
    return None if isinstance(found, str) else found.mass


def _size(assembly: Assembly) -> Triple | None:
    corners = []
    for part in assembly.parts:
        if part.mesh is not None and len(part.mesh.vertices):
            corners.append(part.mesh.vertices @ part.X_WP[:3, :3].T + part.X_WP[:3, 3])
    return _triple(np.ptp(np.concatenate(corners), axis=0)) if corners else None


def _joints(assembly: Assembly, kinematics: Kinematics) -> tuple[CatalogJoint, ...]:
    stated: dict[str, IntendedJoint] = {}
    for intended in assembly.function.joints:
        derived = resolve_joint(assembly, kinematics, intended.name).joint
        if derived is not None:
            stated.setdefault(str(derived.name), intended)
    out = []
    for joint in kinematics.joints:
        wanted = stated.get(joint.name)
        limits = (None, None) if wanted is None or wanted.range is None else wanted.range
        out.append(
            CatalogJoint(
                str(joint.name), joint.type, joint.status, joint.freedoms,
                _triple(joint.axis), _triple(joint.point), joint.pitch, *_range(joint),
                None if wanted is None else wanted.name, *limits,
            )
        )  # fmt: skip
    return tuple(out)


def _range(joint: Joint) -> tuple[float | None, float | None]:
    if joint.range_status == "unbounded":
        return -np.inf, np.inf
    return joint.range_lower, joint.range_upper


def _requirement(wanted: Requirement, report: CheckReport | None) -> CatalogRequirement:
    """Met only where a rule decided it and found nothing, be it accepted; what none looked at is not known."""
    said = () if report is None else report.statements
    decided = [s.holds for s in said if s.name == wanted.name and s.kind in ("requirement", "limit") and s.decided]
    return CatalogRequirement(wanted.name, wanted.kind, all(decided) if decided else None)


def _triple(values: object) -> Triple | None:
    if values is None:
        return None
    x, y, z = (float(value) + 0.0 for value in np.asarray(values))
    return (x, y, z)

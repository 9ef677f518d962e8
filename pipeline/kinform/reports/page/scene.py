"""What the viewer draws, as JSON and one blob of bytes: parts, patches, joints, overlaps, motions."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinform.consistency import words
from kinform.form.units import metres_per
from kinform.model.assembly import Mesh
from kinform.model.contacts import Patch
from kinform.model.design import Design
from kinform.model.kinematics import Body, Joint
from kinform.model.names import PartName
from kinform.reports.json_views import plain
from kinform.reports.page.colours import FITS, OVERLAP, body_colours
from kinform.reports.page.freedoms import Showing, freedom_motions
from kinform.reports.page.meshes import Shape, shape_of
from kinform.reports.page.overlaps import overlap_shapes
from kinform.reports.page.packing import Blob, quantised
from kinform.reports.page.words import joint_sentence, patch_words

__all__ = ["MOST_FRAMES", "Scene", "subjects", "wanted_names"]

Array = NDArray[np.float64]

MOST_FRAMES = 600
"""Poses of a simulated motion that are embedded; of longer ones an even choice."""
MOST_SAMPLES = 400
"""Samples of one contact patch that are drawn; of larger ones an even choice."""


@dataclass(frozen=True, eq=False)
class Scene:
    """The drawn side of one design."""

    design: Design

    @cached_property
    def shapes(self) -> dict[str, Shape]:
        """Each distinct mesh once, by digest."""
        return {m.digest: shape_of(m, self.design.surfaces.get(m.digest)) for m in self._meshes}

    @cached_property
    def _meshes(self) -> list[Mesh]:
        found = {part.mesh.digest: part.mesh for part in self.design.assembly.parts if part.mesh is not None}
        return list(found.values())

    @cached_property
    def bodies(self) -> tuple[Body, ...]:
        """Bodies; each part by itself where joints are not known."""
        if self.design.kinematics is not None:
            return self.design.kinematics.bodies
        return tuple(Body(part.name, (part.name,), False) for part in self.design.assembly.parts)  # type: ignore[arg-type]

    @cached_property
    def colours(self) -> list[str]:
        """Of each body."""
        return body_colours([body.ground for body in self.bodies])

    @cached_property
    def body_index(self) -> dict[str, int]:
        """The number of each part's body."""
        return {part: k for k, body in enumerate(self.bodies) for part in body.parts}

    @cached_property
    def overlaps(self) -> list[Shape | None]:
        """Solids of the interferences, in the world."""
        return overlap_shapes(self.design)

    @cached_property
    def box(self) -> tuple[Array, Array]:
        """Lowest and highest corner (3,) m of everything that is drawn."""
        places = [_corners(p.mesh) @ p.X_WP[:3, :3].T + p.X_WP[:3, 3] for p in self.design.assembly.parts if p.mesh]
        places += [p.X_WP[None, :3, 3] for p in self.design.assembly.parts if p.mesh is None]
        places += [joint.point[None] for joint in self.joints if joint.point is not None]
        run = self.design.simulation
        if not any(p.mesh for p in self.design.assembly.parts) and run is not None and run.p_WB.size:
            places.append(run.p_WB.reshape(-1, 3))
        found = np.concatenate(places) if places else np.zeros((1, 3))
        low, high = found.min(axis=0), found.max(axis=0)
        if float((high - low).max()) <= 0.0:
            low, high = low - 0.05, high + 0.05
        return low, high

    @property
    def size(self) -> float:
        """Diagonal of the box (m)."""
        return float(np.linalg.norm(self.box[1] - self.box[0]))

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """Derived joints; none where they are not known."""
        return () if self.design.kinematics is None else self.design.kinematics.joints

    @cached_property
    def wanted(self) -> dict[str, list[str]]:
        """Names that the designer gave to derived joints."""
        return wanted_names(self.design)

    @cached_property
    def freedoms(self) -> list[Showing]:
        """Freedoms as motions."""
        return [] if self.design.kinematics is None else freedom_motions(self.design.kinematics, self.size)

    def packed(self) -> tuple[dict[str, Any], str]:
        """JSON of the scene, and the bytes it points into as base64 of deflate."""
        blob = Blob()
        numbers = {digest: k for k, digest in enumerate(self.shapes)}
        meshes = [_mesh(blob, shape) for shape in self.shapes.values()]
        overlaps = [] if self.design.contacts is None else self.design.contacts.interferences
        low, high = self.box
        scene = {
            "name": self.design.assembly.name,
            "low": low,
            "high": high,
            "unit": self.design.assembly.units,
            "metres": metres_per(self.design.assembly.units),
            "meshes": meshes,
            "bodies": [
                {"name": body.name, "ground": body.ground, "colour": colour}
                for body, colour in zip(self.bodies, self.colours, strict=True)
            ],
            "parts": [
                {
                    "name": part.name,
                    "body": self.body_index.get(part.name, 0),
                    "mesh": -1 if part.mesh is None else numbers[part.mesh.digest],
                    "pose": part.X_WP.T.ravel(),
                }
                for part in self.design.assembly.parts
            ],
            "joints": [self._joint(joint) for joint in self.joints],
            "patches": self._patches(blob),
            "fits": FITS,
            "overlapColour": OVERLAP,
            "overlaps": [
                {
                    "parts": item.parts,
                    "mated": item.mated,
                    "place": item.place,
                    "depth": words.length(item.depth, self.design.assembly.units, 3),
                    "body": self.body_index.get(item.parts[0], 0),
                    "mesh": None if shape is None else _mesh(blob, shape),
                }
                for item, shape in zip(overlaps, self.overlaps, strict=True)
            ],
            "findings": self._findings(),
            "motions": self._motions(blob),
        }
        return plain(scene), blob.text()

    def _joint(self, joint: Joint) -> dict[str, Any]:
        number = {body.name: k for k, body in enumerate(self.bodies)}
        point, size = self.placed(joint)
        return {
            "name": joint.name,
            "wanted": ", ".join(self.wanted.get(joint.name, [])),
            "type": joint.type,
            "status": joint.status,
            "text": joint_sentence(joint, self.design.assembly.units),
            "bodies": [number[name] for name in joint.bodies],
            "axis": joint.axis,
            "axis2": joint.axis2,
            "point": point,
            "right": joint.pitch is None or joint.pitch >= 0.0,
            "twists": joint.twists if joint.type == "general" else [],
            "size": size,
        }

    def placed(self, joint: Joint) -> tuple[Array, float]:
        """Where the joint's sign stands, and how large it is: about as large as its contact."""
        points = [self._patch(k).points for k in joint.patches]
        extent, centre = 0.0, None
        if any(map(len, points)):
            every = np.concatenate(points)
            centre = 0.5 * (every.min(axis=0) + every.max(axis=0))
            extent = 0.5 * float(np.linalg.norm(every.max(axis=0) - every.min(axis=0)))
        point = joint.point
        if point is None:
            point = centre if centre is not None else 0.5 * (self.box[0] + self.box[1])
        elif centre is not None and joint.axis is not None and joint.type in ("revolute", "cylindrical", "screw"):
            point = point + joint.axis * float(joint.axis @ (centre - point))
        return point, float(np.clip(1.25 * extent, 0.045 * self.size, 0.16 * self.size))

    def _patch(self, index: int) -> Patch:
        assert self.design.contacts is not None
        return self.design.contacts.patches[index]

    def _patches(self, blob: Blob) -> dict[str, Any]:
        """Discs for the samples of all patches: place, normal, radius as seven columns."""
        patches = () if self.design.contacts is None else self.design.contacts.patches
        owner = {k: n for n, joint in enumerate(self.joints) for k in joint.patches}
        rows, items, start = [], [], 0
        largest = 0.0
        for k, patch in enumerate(patches):
            step = -(-len(patch.points) // MOST_SAMPLES) or 1
            points, normals = patch.points[::step], patch.normals[::step]
            radii = np.sqrt(np.maximum(patch.weights[::step], 0.0) * step / np.pi)
            largest = max(largest, float(radii.max(initial=0.0)))
            rows.append(np.column_stack([points, normals, radii]))
            items.append(
                {
                    "parts": patch.parts,
                    "body": self.body_index.get(patch.parts[0], 0),
                    "fit": patch.fit,
                    "text": patch_words(patch, self.design.assembly.units),
                    "joint": owner.get(k, -1),
                    "start": start,
                    "count": len(points),
                }
            )
            start += len(points)
        table = np.concatenate(rows) if rows else np.zeros((0, 7))
        low, high = self.box
        pad = 0.02 * self.size
        lows = np.concatenate([low - pad, [-1.0] * 3, [0.0]])
        sizes = np.concatenate([high - low + 2 * pad, [2.0] * 3, [largest]])
        offset = blob.columns(quantised(table, lows, sizes)) if len(table) else 0
        return {"items": items, "rows": len(table), "offset": offset, "low": lows, "size": sizes}

    def _findings(self) -> list[dict[str, Any]]:
        found = [] if self.design.report is None else self.design.report.findings
        out = []
        for finding in found:
            parts, joints = subjects(self.design, finding.subject)
            out.append({"code": finding.code, "parts": parts, "joints": joints, "place": finding.place})
        return out

    def _motions(self, blob: Blob) -> list[dict[str, Any]]:
        motions = []
        run = self.design.simulation
        index: dict[str, int] = {body.name: k for k, body in enumerate(self.bodies)}
        if run is not None and len(run.time) > 1:
            frames = np.unique(np.linspace(0, len(run.time) - 1, min(len(run.time), MOST_FRAMES)).round().astype(int))
            kept = [k for k, name in enumerate(run.body_names) if name in index]
            left = f"; every {len(run.time) / len(frames):.2g}th pose is shown" if len(frames) < len(run.time) else ""
            stopped = f"stopped at {run.time[-1]:.4g} s: {run.reason}" if run.status == "stopped" else ""
            motions.append(
                {
                    "kind": "simulation",
                    "name": f"Simulated motion ({run.level})",
                    "note": f"{run.level} level, {run.time[-1]:.4g} s{left}",
                    "marks": [{"time": run.time[-1], "text": stopped}] if stopped else [],
                    "time": run.time[frames],
                    "bodies": [index[run.body_names[k]] for k in kept],
                    **_frames(blob, run.p_WB[frames][:, kept], run.q_WB[frames][:, kept]),
                }
            )
        for showing in self.freedoms:
            moving = [index[name] for name in showing.bodies]
            poses = showing.poses[:, moving]
            what = "turn" if showing.turns else "slide"
            subject = ", ".join(showing.bodies)
            if showing.driver is not None:
                subject = self.wanted.get(showing.driver, [showing.driver])[0]
            motions.append(
                {
                    "kind": "freedom",
                    "name": f"Freedom: {subject} ({what})",
                    "note": showing.note,
                    "marks": [],
                    "time": np.linspace(-1.0, 1.0, len(poses)),
                    "bodies": moving,
                    **_frames(blob, poses[..., :3, 3], _quaternions(poses[..., :3, :3])),
                }
            )
        return motions


def subjects(design: Design, names: Iterable[str]) -> tuple[list[str], list[str]]:
    """The parts and the derived joints that names stand for: parts, groups, bodies, joints, intended joints."""
    parts: dict[str, None] = {}
    joints: dict[str, None] = {}
    assembly, kinematics = design.assembly, design.kinematics
    known = {part.name for part in assembly.parts}
    groups = {group.name: group.parts for group in assembly.groups}
    bodies: dict[str, tuple[PartName, ...]] = {}
    if kinematics is not None:
        bodies.update((body.name, body.parts) for body in kinematics.bodies)
    derived = {} if kinematics is None else {joint.name: joint for joint in kinematics.joints}
    wanted = {joint.name: joint for joint in assembly.function.joints}
    for name in names:
        if name in known:
            parts.setdefault(name)
        elif name in groups or name in bodies:
            parts.update(dict.fromkeys(groups.get(name) or bodies[name]))
        elif name in derived:
            joints.setdefault(name)
        elif name in wanted and kinematics is not None:
            ends = {kinematics.body_of(assembly.parts_of(side)[0]).name for side in wanted[name].between}
            direct = [joint.name for joint in derived.values() if set(joint.bodies) == ends]
            joints.update(dict.fromkeys(direct))
            if not direct:
                parts.update(dict.fromkeys(p for side in wanted[name].between for p in assembly.parts_of(side)))
    return list(parts), list(joints)


def wanted_names(design: Design) -> dict[str, list[str]]:
    """Names that the designer gave to derived joints, by kinform's; those of sub-assemblies last."""
    names: dict[str, list[str]] = {}
    for joint in sorted(design.assembly.function.joints, key=lambda j: (j.name.count("/"), j.name)):
        for found in subjects(design, [joint.name])[1]:
            names.setdefault(found, []).append(joint.name)
    return names


def _corners(mesh: Mesh) -> Array:
    low, high = mesh.box
    return np.array([[(low, high)[b >> k & 1][k] for k in range(3)] for b in range(8)])


def _mesh(blob: Blob, shape: Shape) -> dict[str, Any]:
    low = shape.vertices.min(axis=0) if len(shape.vertices) else np.zeros(3)
    size = shape.vertices.max(axis=0) - low if len(shape.vertices) else np.zeros(3)
    return {
        "vertices": len(shape.vertices),
        "faces": len(shape.faces),
        "lines": len(shape.lines),
        "low": low,
        "size": size,
        "places": blob.columns(quantised(shape.vertices, low, size)),
        "triangles": blob.triangles(shape.faces),
        "edges": blob.columns(_halves(shape.lines)),
    }


def _halves(lines: NDArray[np.int64]) -> NDArray[np.int64]:
    """Vertex numbers (E, 2), sorted, as low and high 16 bits (E, 4)."""
    ordered = lines[np.lexsort((lines[:, 1], lines[:, 0]))]
    return np.column_stack([ordered & 0xFFFF, ordered >> 16])


def _frames(blob: Blob, places: Array, turns: Array) -> dict[str, Any]:
    """Poses (T, B, 3) m and (T, B, 4) wxyz as columns that change little from frame to frame."""
    frames, bodies = places.shape[:2]
    low = places.min(axis=(0, 1)) if bodies else np.zeros(3)
    size = (places.max(axis=(0, 1)) if bodies else np.zeros(3)) - low
    lows, sizes = np.concatenate([low, [-1.0] * 4]), np.concatenate([size, [2.0] * 4])
    table = np.concatenate([places, _continuous(turns)], axis=2)
    numbers = quantised(table.reshape(-1, 7), lows, sizes).reshape(frames, 7 * bodies)
    return {"frames": frames, "offset": blob.columns(numbers), "low": lows, "size": sizes}


def _continuous(turns: Array) -> Array:
    """Quaternions (T, B, 4) without jumps of sign from one time to the next."""
    flips = np.where(np.einsum("tbi,tbi->tb", turns[1:], turns[:-1]) < 0.0, -1.0, 1.0)
    signs = np.cumprod(np.concatenate([np.ones((1, turns.shape[1])), flips]), axis=0)
    return np.asarray(turns * signs[..., None])


def _quaternions(R: Array) -> Array:
    """wxyz of rotations (…, 3, 3), by the largest of the four."""
    m = R
    t = np.stack(
        [
            1 + m[..., 0, 0] + m[..., 1, 1] + m[..., 2, 2],
            1 + m[..., 0, 0] - m[..., 1, 1] - m[..., 2, 2],
            1 - m[..., 0, 0] + m[..., 1, 1] - m[..., 2, 2],
            1 - m[..., 0, 0] - m[..., 1, 1] + m[..., 2, 2],
        ],
        axis=-1,
    )
    a, b, c = m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]
    d, e, f = m[..., 1, 0] + m[..., 0, 1], m[..., 0, 2] + m[..., 2, 0], m[..., 2, 1] + m[..., 1, 2]
    rows = np.stack(
        [
            np.stack([t[..., 0], a, b, c], -1),
            np.stack([a, t[..., 1], d, e], -1),
            np.stack([b, d, t[..., 2], f], -1),
            np.stack([c, e, f, t[..., 3]], -1),
        ],
        axis=-2,
    )
    best = np.take_along_axis(rows, t.argmax(-1)[..., None, None], axis=-2)[..., 0, :]
    return np.asarray(best / np.linalg.norm(best, axis=-1, keepdims=True))

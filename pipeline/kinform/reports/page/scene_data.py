"""The scene as the viewer takes it: JSON with the names, and one blob of bytes with the numbers."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinform.foundation import words
from kinform.foundation.units import metres_per
from kinform.model.arrays import Array
from kinform.model.findings import Finding
from kinform.model.kinematics import Joint
from kinform.reports.constants import EYE_RISE, EYE_TURN, FINDING_MARGIN, FINDING_SHIFT, FINDING_ZOOM, OVERLAP_COLOUR
from kinform.reports.page.focus import Focus
from kinform.reports.page.meshes import Shape
from kinform.reports.page.movements import Movement
from kinform.reports.page.packing import Blob, quantised
from kinform.reports.page.phrases import joint_sentence, patch_words
from kinform.reports.page.scene import Scene
from kinform.reports.page.subjects import as_stated
from kinform.reports.values.plain import fields, plain

FIT_COLOURS = {"clearance": "#3f7fbf", "touch": "#2e9e76", "transition": "#c9962b", "interference": "#c2410c"}
"""Of contact patches by their fit."""
MOST_SAMPLES = 400
"""Samples of one contact patch that are drawn; of larger ones an even choice. Chosen, not measured: on
most patches they cover each other already."""
BOX_MARGIN = 0.02
"""Share of the assembly's size by which contact samples may leave its box, for numbers are packed in
shares of it. Chosen, not measured."""


def embedded_scene(scene: Scene) -> tuple[dict[str, Any], str]:
    """JSON of the scene, and the bytes it points into as base64 of deflate."""
    blob = Blob()
    numbers = {digest: k for k, digest in enumerate(scene.shapes)}
    meshes = [packed_mesh(blob, shape) for shape in scene.shapes.values()]
    overlaps = [] if scene.design.contacts is None else scene.design.contacts.interferences
    found = () if scene.design.report is None else scene.design.report.findings
    low, high = scene.box
    drawn = {
        "name": scene.design.assembly.name,
        "low": low,
        "high": high,
        "unit": scene.design.assembly.units,
        "metres": metres_per(scene.design.assembly.units),
        "meshes": meshes,
        "bodies": [
            {"name": body.name, "title": scene.titles.get(body.name, ""), "ground": body.ground, "colour": colour}
            for body, colour in zip(scene.bodies, scene.colours, strict=True)
        ],
        "parts": [
            {
                "name": part.name,
                "body": scene.body_index.get(part.name, 0),
                "mesh": -1 if part.mesh is None else numbers[part.mesh.digest],
                "pose": part.X_WP.T.ravel(),
                "colour": part.own_colour or "",
            }
            for part in scene.design.assembly.parts
        ],
        "joints": [_joint(scene, joint) for joint in scene.joints],
        "patches": _patches(scene, blob),
        "fits": FIT_COLOURS,
        "overlapColour": OVERLAP_COLOUR,
        "overlaps": [
            fields(item, "parts", "mated", "place")
            | {
                "depth": words.length(item.depth, scene.design.assembly.units, 3),
                "body": scene.body_index.get(item.parts[0], 0),
                "mesh": None if shape is None else packed_mesh(blob, shape),
            }
            for item, shape in zip(overlaps, scene.overlaps, strict=True)
        ],
        "findings": [_finding(finding, focus) for finding, focus in zip(found, scene.focuses, strict=True)],
        "look": {
            "turn": EYE_TURN,
            "rise": EYE_RISE,
            "margin": FINDING_MARGIN,
            "zoom": FINDING_ZOOM,
            "shift": FINDING_SHIFT,
        },
        "motions": [
            _movement(scene, blob, movement)
            for movement in (*scene.movements, *(one.movement for one in scene.proposed))
        ],
    }
    return plain(drawn), blob.text()


def _joint(scene: Scene, joint: Joint) -> dict[str, Any]:
    number = scene.body_number
    point, size = scene.sign_of(joint)
    wanted = scene.wanted.get(joint.name, [])
    return {
        "name": joint.name,
        "wanted": ", ".join(wanted),
        **fields(joint, "type", "status"),
        "text": joint_sentence(as_stated(scene.design, joint, wanted), scene.design.assembly.units),
        "bodies": [number[name] for name in joint.bodies],
        **fields(joint, "axis", "axis2"),
        "point": point,
        "right": joint.pitch is None or joint.pitch >= 0.0,
        "twists": joint.twists if joint.type == "general" else [],
        "size": size,
    }


def _patches(scene: Scene, blob: Blob) -> dict[str, Any]:
    """Discs for the samples of all patches: place, normal, radius as seven columns."""
    patches = () if scene.design.contacts is None else scene.design.contacts.patches
    owner = {k: n for n, joint in enumerate(scene.joints) for k in joint.patches}
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
                "body": scene.body_index.get(patch.parts[0], 0),
                "fit": patch.fit,
                "text": patch_words(patch, scene.design.assembly.units),
                "joint": owner.get(k, -1),
                "start": start,
                "count": len(points),
            }
        )
        start += len(points)
    table = np.concatenate(rows) if rows else np.zeros((0, 7))
    low, high = scene.box
    pad = BOX_MARGIN * scene.size
    lows = np.concatenate([low - pad, [-1.0] * 3, [0.0]])
    sizes = np.concatenate([high - low + 2 * pad, [2.0] * 3, [largest]])
    offset = blob.columns(quantised(table, lows, sizes)) if len(table) else 0
    return {"items": items, "rows": len(table), "offset": offset, "low": lows, "size": sizes}


def _finding(finding: Finding, focus: Focus) -> dict[str, Any]:
    return {
        "code": finding.code,
        **fields(focus, "parts", "joints", "place"),
        "motion": focus.movement,
        **fields(focus, "time", "meeting"),
    }


def _movement(scene: Scene, blob: Blob, movement: Movement) -> dict[str, Any]:
    """A movement as the viewer takes it: marks by time, poses as columns of the blob."""
    number: dict[str, int] = {body.name: k for k, body in enumerate(scene.bodies)}
    scale, unit = _shown(scene, movement)
    return {
        **fields(movement, "kind", "name", "note"),
        "marks": [
            fields(mark, "time", "kind", "text", "parts", "place")
            | {"body": scene.body_index[mark.parts[0]] if mark.parts else 0}
            for mark in movement.marks
        ],
        "time": movement.time,
        "ends": [scale * end for end in movement.ends],
        "unit": unit,
        "moved": _moved(movement),
        "bodies": [number[name] for name in movement.bodies],
        **packed_frames(blob, movement.places, movement.turns),
    }


def _shown(scene: Scene, movement: Movement) -> tuple[float, str]:
    """Factor and unit in which the value of a driving joint is shown; no unit where there is none."""
    if movement.joint is None:
        return 1.0, ""
    if movement.angular:
        return 180.0 / math.pi, "°"
    unit = words.length_unit(max(map(abs, movement.ends)), scene.design.assembly.units)
    return 1.0 / metres_per(unit), f" {unit}"


def _moved(movement: Movement) -> str:
    """What the slider of a movement changes."""
    if movement.kind == "simulation":
        return "time"
    if movement.joint is None:
        return "share of the way"
    return "angle" if movement.angular else "travel"


def packed_mesh(blob: Blob, shape: Shape) -> dict[str, Any]:
    """A mesh as the viewer takes it: numbers in the blob, and where."""
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


def packed_frames(blob: Blob, places: Array, turns: Array) -> dict[str, Any]:
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

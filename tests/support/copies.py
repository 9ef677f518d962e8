"""A design and its copies: the same thing at another size, at another place, in other files.

`copy_of` writes a manifest and its meshes anew under a `Change`; `derived` takes a manifest to joints, `checked` to
findings. `answers` is what copies must have in common, by the names of the original.
"""

from __future__ import annotations

import tomllib
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from kinform import form, stages
from kinform.design import Design
from kinform.foundation.units import metres_per
from kinform.model.assembly import Part
from kinform.model.findings import CheckReport
from kinform.model.kinematics import Joint
from support.toml_text import toml

__all__ = [
    "Change",
    "Copy",
    "answers",
    "axis_errors",
    "bodies_of",
    "checked",
    "copy_of",
    "derived",
    "joints_of",
    "turned",
]

Array = NDArray[np.float64]
Table = dict[str, Any]

LINES = ("revolute", "cylindrical", "screw")
"""Types of joints whose axis has a place."""
LEFT_OUT = ("drive", "load", "require")
"""Tables of `[function]` that a copy lacks, as it lacks `[simulation]` and `[check]`: a copy is for joints."""


@dataclass(frozen=True, eq=False)
class Change:
    """What a copy has differently. World frame of the original, SI."""

    scale: float = 1.0
    """About the origin; of everything that is a length, stated tolerances included."""
    rotation: Array = field(default_factory=lambda: np.eye(3))
    """(3, 3) about the origin, after scaling."""
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """m, after both."""
    baked: bool = False
    """Poses go into the vertices, as in files of an exported assembly; else the files stay in part frames."""
    files: str = "obj"
    """obj: doubles, to the last bit. stl: binary, float32."""
    noise: float = 0.0
    """m, before scaling: standard deviation of each coordinate of each vertex."""
    shuffled: bool = False
    """Names that sort the other way; parts and facets in another order."""
    seed: int = 0
    """Of noise and shuffling."""

    @property
    def X(self) -> Array:
        """(4, 4) from the original's world to the copy's."""
        out = np.eye(4)
        out[:3, :3] = self.scale * self.rotation
        out[:3, 3] = self.offset
        return out


@dataclass(frozen=True)
class Copy:
    """The manifest of a copy; what its parts and groups are called in the original."""

    path: Path
    originals: Mapping[str, str]


def turned(seed: int) -> Array:
    """A rotation (3, 3) that is nothing in particular."""
    return np.asarray(Rotation.random(random_state=np.random.default_rng(seed)).as_matrix())


def copy_of(manifest: Path, folder: Path, change: Change) -> Copy:
    """Write a copy of a design without sub-assemblies into a folder.

    Every meshed part gets a file of its own: its welded vertices, so two parts of one mesh stay two parts of one
    mesh unless they are baked or made noisy.
    """
    stated = tomllib.loads(manifest.read_text(encoding="utf-8"))
    assert "subassembly" not in stated, "copies are flat"
    units = metres_per(stated["assembly"]["units"])
    placed = {str(part.name): part for part in form.load(manifest, allow_outside=True).parts}
    names = _names(stated, change.shuffled)
    folder.mkdir(parents=True, exist_ok=True)
    write = _Writer(folder, units, change, names, np.random.default_rng(change.seed))
    tables = {key: stated[key] for key in ("schema", "assembly", "materials", "fasteners") if key in stated}
    if "ground" in stated["assembly"]:
        tables["assembly"] = stated["assembly"] | {"ground": names[stated["assembly"]["ground"]]}
    tables["part"] = [write.part(table, placed[table["name"]]) for table in stated["part"]]
    tables["group"] = [_renamed(table, names) for table in stated.get("group", ())]
    tables["assume"] = [_placed(_renamed(table, names), units, change) for table in stated.get("assume", ())]
    lengths = {key: change.scale if key in ("contact", "weld") else 1.0 for key in stated.get("tolerances", {})}
    tables["tolerances"] = {key: lengths[key] * value for key, value in stated.get("tolerances", {}).items()}
    function = {key: value for key, value in stated.get("function", {}).items() if key not in LEFT_OUT}
    joints = [_placed(_renamed(table, names), units, change) for table in function.pop("joint", ())]
    tables["function"] = function | {"joint": joints}
    if change.shuffled:
        tables["part"].reverse()
    path = folder / manifest.name
    path.write_text(toml(tables), encoding="utf-8")
    return Copy(path, {new: old for old, new in names.items()})


def derived(manifest: Path) -> Design:
    """A manifest to bodies, joints and mobility."""
    return stages.joints(stages.contacts(stages.import_(manifest)))


def checked(manifest: Path) -> Design:
    """A manifest to findings, without ranges; a copy states nothing to simulate."""
    return stages.check(stages.simulate(stages.mass(derived(manifest)), ranges=False))


def bodies_of(design: Design, originals: Mapping[str, str]) -> dict[str, frozenset[str]]:
    """The parts of each body, as the original calls them."""
    assert design.kinematics is not None
    return {body.name: frozenset(originals[part] for part in body.parts) for body in design.kinematics.bodies}


def joints_of(design: Design, originals: Mapping[str, str]) -> dict[frozenset[frozenset[str]], Joint]:
    """Joints by the parts of their bodies, as the original calls them."""
    assert design.kinematics is not None
    bodies = bodies_of(design, originals)
    return {frozenset(bodies[name] for name in joint.bodies): joint for joint in design.kinematics.joints}


def answers(design: Design, originals: Mapping[str, str]) -> Table:
    """What copies have in common: bodies, joints with type and status, patches, severities of findings."""
    assert design.contacts is not None
    joints = joints_of(design, originals)
    patches = Counter((tuple(sorted(originals[part] for part in p.parts)), p.kind) for p in design.contacts.patches)
    report = design.report
    return {
        "bodies": frozenset(bodies_of(design, originals).values()),
        "joints": {between: (joint.type, joint.status) for between, joint in joints.items()},
        "patches": dict(patches),
        "findings": None if report is None else severities_of(report),
    }


def severities_of(report: CheckReport) -> dict[str, list[str]]:
    """By code, the severities of its findings, sorted."""
    found: dict[str, list[str]] = {}
    for finding in report.findings:
        found.setdefault(finding.code, []).append(finding.severity)
    return {code: sorted(severities) for code, severities in found.items()}


def axis_errors(original: Design, copy: Design, copied: Copy, change: Change) -> dict[str, tuple[float, float]]:
    """By joint of the original: how far the axis of the copy is from where it should be, in rad and in shares of the
    assembly's size; of joints of one type in both."""
    theirs = joints_of(copy, copied.originals)
    same = {name: name for name in copied.originals.values()}
    size = _size(original)
    out = {}
    for between, joint in joints_of(original, same).items():
        other = theirs.get(between)
        if other is None or other.type != joint.type or joint.axis is None or other.axis is None:
            continue
        axis = change.rotation @ joint.axis
        tilt = float(np.arctan2(np.linalg.norm(np.cross(axis, other.axis)), abs(axis @ other.axis)))
        far = 0.0
        if joint.point is not None and other.point is not None and joint.type in LINES:
            arm = other.point - (change.X[:3, :3] @ joint.point + change.X[:3, 3])
            far = float(np.linalg.norm(np.cross(arm, axis))) / (change.scale * size)
        out[joint.name] = tilt, far
    return out


def _size(design: Design) -> float:
    """Diagonal of the assembly's box (m)."""
    boxes = np.array([part.mesh.placed_box(part.X_WP) for part in design.assembly.parts if part.mesh is not None])
    return float(np.linalg.norm(boxes[:, 1].max(axis=0) - boxes[:, 0].min(axis=0)))


def _names(stated: Table, shuffled: bool) -> dict[str, str]:
    """New names of parts and groups by the old ones."""
    old = [table["name"] for key in ("part", "group") for table in stated.get(key, ())]
    if not shuffled:
        return {name: name for name in old}
    return {name: f"{len(old) - rank:03d} of {len(old)}" for rank, name in enumerate(sorted(old))}


def _renamed(table: Table, names: Mapping[str, str]) -> Table:
    """A table whose parts and groups have their new names."""
    out = dict(table)
    for key in ("between", "parts"):
        if key in table:
            out[key] = [names[name] for name in table[key]]
    if "parts" in table:
        out["name"] = names[table["name"]]
    return out


def _placed(table: Table, units: float, change: Change) -> Table:
    """A joint or assumption where the copy has it."""
    out = dict(table)
    for key in ("axis", "axis2"):
        if key in table:
            out[key] = (change.rotation @ table[key]).tolist()
    if "point" in table:
        out["point"] = ((change.X[:3, :3] @ table["point"]) + change.X[:3, 3] / units).tolist()
    if "pitch" in table:
        out["pitch"] = change.scale * table["pitch"]
    if "range" in table and table["type"] == "prismatic":
        out["range"] = [change.scale * end for end in table["range"]]
    return out


@dataclass(frozen=True, eq=False)
class _Writer:
    """Writes the parts of one copy."""

    folder: Path
    units: float
    change: Change
    names: Mapping[str, str]
    rng: np.random.Generator

    def part(self, table: Table, part: Part) -> Table:
        """The table of a part, its file written."""
        change = self.change
        kept = ("material", "density", "solid", "mass", "centre_of_mass", "inertia")
        out: Table = {"name": self.names[table["name"]]} | {key: table[key] for key in kept if key in table}
        R_WP, p_WP = change.rotation @ part.X_WP[:3, :3], change.X[:3, :3] @ part.X_WP[:3, 3] + change.X[:3, 3]
        if part.mesh is not None:
            vertices = part.mesh.vertices
            if change.noise:
                vertices = vertices + change.noise * self.rng.normal(size=vertices.shape)
            vertices = change.scale * vertices
            if change.baked:
                vertices, R_WP, p_WP = vertices @ R_WP.T + p_WP, np.eye(3), np.zeros(3)
            faces = self.rng.permutation(part.mesh.faces) if change.shuffled else part.mesh.faces
            out["mesh"] = f"{table['name']}.{change.files}"
            {"obj": _obj, "stl": _stl}[change.files](self.folder / out["mesh"], vertices / self.units, faces)
        if not (np.array_equal(R_WP, np.eye(3)) and not p_WP.any()):
            x, y, z, w = Rotation.from_matrix(R_WP).as_quat()
            out |= {"position": (p_WP / self.units).tolist(), "quaternion": [w, x, y, z]}
        return out


def _obj(path: Path, vertices: Array, faces: NDArray[np.int64]) -> None:
    lines = ["v " + " ".join(repr(float(x)) for x in vertex) for vertex in vertices]
    lines += ["f " + " ".join(str(index + 1) for index in face) for face in faces]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


def _stl(path: Path, vertices: Array, faces: NDArray[np.int64]) -> None:
    record = np.zeros(len(faces), dtype=[("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    record["v"] = vertices[faces]
    path.write_bytes(bytes(80) + len(faces).to_bytes(4, "little") + record.tobytes())

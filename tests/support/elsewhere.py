"""A whole design described elsewhere: moved, turned, at another size, mirrored, in another unit, order and other names.

`described_elsewhere` writes a manifest with all that it states, its sub-assemblies and its meshes, anew under an
`Elsewhere`. What a manifest states has to turn, grow and change its sign with the geometry; physics does too: with
lengths times s, density and time as they were, gravity goes with s, forces with s⁴ and torques with s⁵, and all
motions are those of the original, s times as large.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from kinform import form
from kinform.foundation.units import metres_per
from kinform.model.assembly import Part
from support.toml_text import toml

__all__ = ["Elsewhere", "described_elsewhere"]

Array = NDArray[np.float64]
Table = dict[str, Any]

SLIDES = ("prismatic",)
"""Types of joints whose values are lengths."""
POLAR = ("prismatic", "planar")
"""Types of joints whose axis is mirrored as an arrow; the others turn, so theirs is mirrored as a sense of turning."""
GRAVITY = [0.0, 0.0, -9.81]


@dataclass(frozen=True, eq=False)
class Elsewhere:
    """How the other description differs. World frame of the original, SI."""

    scale: float = 1.0
    units: str | None = None
    """Of the files; default those of the original."""
    mirrored: bool = False
    """Along x of every frame."""
    rotation: Array = field(default_factory=lambda: np.eye(3))
    """(3, 3) about the origin, after scaling and mirroring."""
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """m, after all of these."""
    reordered: bool = False
    """Names that sort the other way, and parts, groups, joints and drives in reverse."""
    retold: bool = False
    """Facets and vertices of the meshes in another order, facets begun at other corners."""
    reframed: bool = False
    """Each mesh in another frame of its own, turned and moved by as much as it is large."""
    ground: Callable[[Table], str] | None = None
    """Name of another ground, from the table of the manifest."""

    @property
    def S(self) -> Array:
        """(3, 3): to the size and the hand of the copy."""
        return self.scale * np.diag([-1.0 if self.mirrored else 1.0, 1.0, 1.0])

    @property
    def hand(self) -> float:
        """-1 where mirrored: the sign of what turns."""
        return -1.0 if self.mirrored else 1.0

    @property
    def frame(self) -> Array:
        """(4, 4): the original's world as a frame of the copy's."""
        out = np.eye(4)
        out[:3, :3], out[:3, 3] = self.rotation, self.offset
        return out


def described_elsewhere(manifest: Path, folder: Path, change: Elsewhere) -> tuple[Path, dict[str, str]]:
    """Write the other description into a folder; its manifest, and what its parts and groups are in the original."""
    return _Manifest(manifest, folder, change, change.frame).write()


@dataclass(eq=False)
class _Manifest:
    """One manifest, that of a sub-assembly included: in its own frame everything is only scaled and mirrored."""

    path: Path
    folder: Path
    change: Elsewhere
    frame: Array
    """(4, 4), m: on top of that."""

    def write(self) -> tuple[Path, dict[str, str]]:
        self.stated: Table = tomllib.loads(self.path.read_text(encoding="utf-8"))
        self.own = metres_per(self.stated["assembly"]["units"])
        self.units = self.change.units or self.stated["assembly"]["units"]
        self.metres = metres_per(self.units)
        self.longer = self.change.scale * self.own / self.metres  # of numbers that are lengths
        self.R = self.frame[:3, :3]
        self.folder.mkdir(parents=True, exist_ok=True)
        self.names = self._names()
        self.inner: dict[str, dict[str, str]] = {}
        tables: Table = {
            k: self.stated[k] for k in ("schema", "materials", "fasteners", "friction", "check") if k in self.stated
        }
        tables["subassembly"] = [self._subassembly(t) for t in self.stated.get("subassembly", ())]
        tables["assembly"] = self._assembly()
        loaded = (
            {str(p.name): p for p in form.load(self.path, allow_outside=True).parts} if self.stated.get("part") else {}
        )
        tables["part"] = [self._part(t, loaded[t["name"]]) for t in self.stated.get("part", ())]
        tables["group"] = [self._group(t) for t in self.stated.get("group", ())]
        tables["assume"] = [self._joint(t) for t in self.stated.get("assume", ())]
        lengths = ("contact", "weld", "axis_offset")
        tables["tolerances"] = {
            k: self.longer * v if k in lengths else v for k, v in self.stated.get("tolerances", {}).items()
        }
        if "function" in self.stated:
            tables["function"] = self._function()
        if "simulation" in self.stated:
            tables["simulation"] = self._simulation()
        if self.change.reordered:
            for table in (tables, tables.get("function", {})):
                for value in table.values():
                    if isinstance(value, list):
                        value.reverse()
        path = self.folder / self.path.name
        path.write_text(toml(tables), encoding="utf-8")
        originals = {new: old for old, new in self.names.items()}
        for prefix, inner in self.inner.items():
            originals |= {f"{prefix}/{new}": f"{prefix}/{old}" for new, old in inner.items()}
        return path, originals

    def _names(self) -> dict[str, str]:
        old = sorted(t["name"] for key in ("part", "group") for t in self.stated.get(key, ()))
        if not self.change.reordered:
            return {name: name for name in old}
        return {name: f"{len(old) - rank:03d} {name}" for rank, name in enumerate(old)}

    def name(self, old: str) -> str:
        """A part or group, perhaps of a sub-assembly, in the copy."""
        if old in self.names:
            return self.names[old]
        for prefix, inner in self.inner.items():
            if old == prefix:
                return old
            if old.startswith(prefix + "/"):
                news = {theirs: new for new, theirs in inner.items()}
                return f"{prefix}/{news.get(old[len(prefix) + 1 :], old[len(prefix) + 1 :])}"
        return old

    def _assembly(self) -> Table:
        out = self.stated["assembly"] | {"units": self.units}
        if self.change.ground is not None:
            out["ground"] = self.change.ground(self.stated)
        if "ground" in out:
            out["ground"] = self.name(out["ground"])
        return out

    def _subassembly(self, table: Table) -> Table:
        inner = _Manifest(self.path.parent / table["file"], self.folder / f"in {table['name']}", self.change, np.eye(4))
        path, originals = inner.write()
        self.inner[table["name"]] = originals
        return {"name": table["name"], "file": str(path.relative_to(self.folder))} | self._pose(
            _pose_of(table, self.own)
        )

    def _pose(self, X: Array) -> Table:
        """A pose in the frame of the original's manifest, as the copy has it."""
        S = self.change.S
        R = self.R @ S @ X[:3, :3] @ np.linalg.inv(S)
        p = self.R @ S @ X[:3, 3] + self.frame[:3, 3]
        if np.array_equal(R, np.eye(3)) and not p.any():
            return {}
        x, y, z, w = Rotation.from_matrix(R).as_quat()
        return {"position": (p / self.metres).tolist(), "quaternion": [w, x, y, z]}

    def _part(self, table: Table, part: Part) -> Table:
        kept = ("material", "density", "solid", "colour")
        out: Table = {"name": self.names[table["name"]]} | {key: table[key] for key in kept if key in table}
        if "mass" in table:
            out |= self._mass(table, np.eye(3), np.zeros(3))
        X, X_NP = part.X_WP, self._reframed(table, part)
        if part.mesh is not None:
            out["mesh"] = f"{table['name']}.obj"
            vertices = part.mesh.vertices @ X_NP[:3, :3].T + X_NP[:3, 3]
            _obj(self.folder / out["mesh"], *self._mesh(vertices, part.mesh.faces))
            X = X @ np.linalg.inv(X_NP)
        return out | self._pose(X)

    def _reframed(self, table: Table, part: Part) -> Array:
        """(4, 4) from the frame of a part to the one that its mesh has in the copy."""
        X = np.eye(4)
        if self.change.reframed and part.mesh is not None and "mass" not in table:
            rng = np.random.default_rng(len(part.mesh.faces))
            X[:3, :3] = Rotation.random(random_state=rng).as_matrix()
            X[:3, 3] = rng.normal(size=3) * np.linalg.norm(np.ptp(part.mesh.vertices, axis=0))
        return X

    def _mesh(self, vertices: Array, faces: NDArray[np.int64]) -> tuple[Array, NDArray[np.int64]]:
        """In the units of the copy."""
        vertices = vertices @ self.change.S.T / self.metres
        if self.change.mirrored:
            faces = faces[:, ::-1]
        if self.change.retold:
            rng = np.random.default_rng(len(faces))
            order = rng.permutation(len(vertices))
            place = np.argsort(order)
            vertices, faces = vertices[order], rng.permutation(place[faces])
            faces = np.array([np.roll(f, k) for f, k in zip(faces, rng.integers(0, 3, len(faces)), strict=True)])
        return vertices, faces

    def _mass(self, table: Table, R: Array, p: Array) -> Table:
        s, M = self.change.scale, R @ self.change.S / self.change.scale
        out: Table = {"mass": s**3 * table["mass"]}
        if "centre_of_mass" in table:
            out["centre_of_mass"] = (self.longer * M @ table["centre_of_mass"] + p / self.metres).tolist()
        if "inertia" in table:
            out["inertia"] = (s**5 * M @ np.array(table["inertia"]) @ M.T).tolist()
        return out

    def _group(self, table: Table) -> Table:
        out = table | {"name": self.names[table["name"]], "parts": [self.name(p) for p in table["parts"]]}
        return out | self._mass(table, self.R, self.frame[:3, 3]) if "mass" in table else out

    def point(self, p: Any) -> Any:
        if p and isinstance(p[0], list):
            return [self.point(q) for q in p]
        return (
            self.R @ self.change.S @ np.array(p) * self.own / self.metres + self.frame[:3, 3] / self.metres
        ).tolist()

    def arrow(self, d: Any) -> Any:
        if d and isinstance(d[0], list):
            return [self.arrow(e) for e in d]
        return (self.R @ self.change.S @ np.array(d) / self.change.scale).tolist()

    def sense(self, d: Any) -> Any:
        """An axis of turning."""
        return (self.change.hand * np.array(self.arrow(d))).tolist()

    def _joint(self, table: Table) -> Table:
        out = dict(table)
        for key in ("axis", "axis2"):
            if key in table:
                out[key] = (self.arrow if table["type"] in POLAR else self.sense)(table[key])
        if "between" in table:
            out["between"] = [self.name(n) for n in table["between"]]
        if "point" in table:
            out["point"] = self.point(table["point"])
        if "pitch" in table:
            out["pitch"] = self.change.hand * self.longer * table["pitch"]
        if "range" in table and table["type"] in SLIDES:
            out["range"] = [self.longer * end for end in table["range"]]
        return out

    def _slides(self, joint: str) -> bool:
        return any(t["name"] == joint and t["type"] in SLIDES for t in self.stated["function"].get("joint", ()))

    def _value(self, joint: str, value: float) -> float:
        return self.longer * value if self._slides(joint) else value

    def _effort(self, joint: str, value: float) -> float:
        return self.change.scale ** (4 if self._slides(joint) else 5) * value

    def _law(self, law: Table, by: Callable[[float], float]) -> Table:
        out = dict(law)
        for key in ("value", "amplitude", "offset", "rate"):
            if key in law:
                out[key] = by(law[key])
        if "values" in law:
            out["values"] = [by(v) for v in law["values"]]
        assert "file" not in law
        return out

    def _function(self) -> Table:
        out = {k: self.stated["function"][k] for k in ("mobility", "complete") if k in self.stated["function"]}
        rest: dict[str, Callable[[Table], Table]] = {
            "joint": self._joint, "coupling": self._coupling, "drive": self._drive, "load": self._load,
            "require": self._require,
        }  # fmt: skip
        unknown = set(self.stated["function"]) - set(out) - set(rest)
        assert not unknown, unknown
        return out | {k: [f(t) for t in self.stated["function"].get(k, ())] for k, f in rest.items()}

    def _coupling(self, table: Table) -> Table:
        first, second = table["joints"]
        ratio = table["ratio"]
        if self._slides(first) != self._slides(second):
            ratio = ratio * self.longer if self._slides(first) else ratio / self.longer
        return table | {"ratio": ratio}

    def _drive(self, table: Table) -> Table:
        joint, out, s = table["joint"], dict(table), self.change.scale
        if table["kind"] == "motion":
            return out | {"law": self._law(table["law"], lambda v: self._value(joint, v))}
        if table["kind"] == "effort":
            return out | {"law": self._law(table["law"], lambda v: self._effort(joint, v))}
        of_value = s ** (3 if self._slides(joint) else 5)
        if table["kind"] == "spring":
            rest = self._value(joint, table.get("rest", 0.0))
            return out | {"stiffness": of_value * table["stiffness"], "rest": rest}
        if table["kind"] == "damper":
            return out | {"damping": of_value * table["damping"]}
        if table["kind"] == "friction":
            return (
                out
                | {k: self._effort(joint, table[k]) for k in ("effort", "static_effort") if k in table}
                | {k: self.longer * table[k] for k in ("radius", "thrust_radius", "length") if k in table}
            )
        assert table["kind"] == "servo" and "position_gain" not in table, table["kind"]
        out |= {k: of_value * table[k] for k in ("kp", "kd", "ki") if k in table}
        out |= {"limit": self._effort(joint, table["limit"])} if "limit" in table else {}
        return out | {"law": self._law(table["law"], lambda v: self._value(joint, v))}

    def _load(self, table: Table) -> Table:
        s, out = self.change.scale, table | {"part": self.name(table["part"])}
        if "force" in table:
            out["force"] = (s**4 * np.array(self.arrow(table["force"]))).tolist()
        if "torque" in table:
            out["torque"] = (s**5 * np.array(self.sense(table["torque"]))).tolist()
        return out | ({"point": self.point(table["point"])} if "point" in table else {})

    def _require(self, table: Table) -> Table:
        s, out, kind = self.change.scale, dict(table), table["kind"]
        assert kind in KINDS, kind
        for key in ("part", "of"):
            if key in table:
                out[key] = self.name(table[key])
        if "between" in table:
            out["between"] = [self.name(n) for n in table["between"]]
        for key in ("point", "direction", "directions", "axis"):
            if key in table:
                out[key] = (self.point if key == "point" else self.arrow)(table[key])
        if "region" in table:
            region = dict(table["region"])
            assert region["type"] != "box", "a box is along the axes of its manifest"
            for key in ("points", "directions", "axis"):
                if key in region:
                    region[key] = (self.point if key == "points" else self.arrow)(region[key])
            out["region"] = region
        lengths = {"reach": ("tolerance",), "clear": ("distance",), "centre_of_mass": ("tolerance",)}
        lengths |= {"fit": ("minimum", "maximum")}
        for key in lengths.get(kind, ()):
            if key in table:
                out[key] = self.longer * table[key]
        powers = {"mass": {"minimum": 3, "maximum": 3}, "inertia": {"minimum": 5, "maximum": 5}}
        powers |= {"balance": {"limit": 4}, "reaction": {"force": 4, "torque": 5}}
        for key, power in powers.get(kind, {}).items():
            if key in table:
                out[key] = s**power * table[key]
        if kind in ("torque", "hold"):
            out["limit"] = self._effort(table["joint"], table["limit"])
        if kind == "speed":
            out["limit"] = self._value(table["joint"], table["limit"])
        if "poses" in table:
            out["poses"] = [{j: self._value(j, v) for j, v in pose.items()} for pose in table["poses"]]
        return out

    def _simulation(self) -> Table:
        stated = self.stated["simulation"]
        out = stated | {"gravity": (self.change.scale * np.array(self.arrow(stated.get("gravity", GRAVITY)))).tolist()}
        assert "sensor" not in stated
        for joint, initial in stated.get("initial", {}).items():
            numbers = {k: v for k, v in initial.items() if isinstance(v, (int, float))}
            out["initial"] = out.get("initial", {}) | {
                joint: initial | {k: self._value(joint, v) for k, v in numbers.items()}
            }
        return out


KINDS = ("reach", "clear", "centre_of_mass", "fit", "mass", "inertia", "balance", "reaction", "torque", "hold", "speed",
         "retained", "efficiency", "self_locking")  # fmt: skip
"""Kinds of requirements that can be described elsewhere."""


def _pose_of(table: Table, metres: float) -> Array:
    X = np.eye(4)
    X[:3, 3] = metres * np.array(table.get("position", (0, 0, 0)))
    if "quaternion" in table:
        w, x, y, z = table["quaternion"]
        X[:3, :3] = Rotation.from_quat([x, y, z, w]).as_matrix()
    elif "rpy" in table:
        X[:3, :3] = Rotation.from_euler("xyz", table["rpy"], degrees=True).as_matrix()
    return X


def _obj(path: Path, vertices: Array, faces: NDArray[np.int64]) -> None:
    lines = ["v " + " ".join(repr(float(x)) for x in vertex) for vertex in vertices]
    lines += ["f " + " ".join(str(index + 1) for index in face) for face in faces]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")

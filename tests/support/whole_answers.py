"""The whole answer of kinform to a design, as its original description would have it, and what differs between two.

`answer` runs a manifest and brings what was found back to the frame, the size, the hand and the names of the original;
`differences` compares two such answers number by number.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import kinform
from kinform.consistency import verdict
from kinform.design import Design
from kinform.reports import summary
from support.elsewhere import Elsewhere

__all__ = ["answer", "differences"]

Array = NDArray[np.float64]
UP = np.array([0.4123, 0.5311, 0.7404])
"""A direction that no axis is square to: the sense of an axis, whatever its canonical sign."""
SLIDING = ("prismatic",)
ABSOLUTE = ("KF110",)
"""Rules that know how large a metre is."""


def answer(
    manifest: Path, change: Elsewhere, originals: Mapping[str, str], *, ranges: bool | None = None
) -> dict[str, Any]:
    """Every part of the answer by a name of its own; lengths in shares of the original's size where they are places."""
    design = kinform.run(manifest, ranges=ranges).design
    return _Answer(design, change, originals).all()


class _Answer:
    def __init__(self, design: Design, change: Elsewhere, originals: Mapping[str, str]):
        self.design, self.change, self.originals = design, change, originals
        self.values = summary(design)
        assert design.kinematics is not None
        self.bodies = {
            body.name: "+".join(sorted(originals.get(p, p) for p in body.parts)) for body in design.kinematics.bodies
        }
        within = {part: self.bodies[body.name] for body in design.kinematics.bodies for part in body.parts}
        groups = {g.name: within[g.parts[0]] for g in design.assembly.groups if g.parts}
        self.tokens = {**within, **groups, **self.bodies}
        self.joint_names, self.signs = {}, {}
        for joint in design.kinematics.joints:
            first, second = (self.bodies[name] for name in joint.bodies)
            sign = 1.0 if first <= second else -1.0
            if joint.axis is not None:
                sign *= np.sign(self.axis(joint.axis, joint.type) @ UP)
            self.joint_names[joint.name] = "~".join(sorted((first, second)))
            self.signs[joint.name] = sign
        self.types = {joint.name: joint.type for joint in design.kinematics.joints}
        self.tokens |= self.joint_names
        self.scale = change.scale
        meshed = [p for p in design.assembly.parts if p.mesh is not None]
        ends = [p.mesh.vertices @ p.X_WP[:3, :3].T + p.X_WP[:3, 3] for p in meshed if p.mesh is not None]
        where = self.place(np.vstack(ends)) if ends else np.array([[0.0] * 3, [1.0] * 3])
        self.size = float(np.linalg.norm(np.ptp(where, axis=0)))

    def place(self, p: Any) -> Array:
        return (np.array(p) - self.change.offset) @ self.change.rotation @ np.linalg.inv(self.change.S).T

    def arrow(self, d: Any) -> Array:
        return np.linalg.solve(self.change.S / self.change.scale, self.change.rotation.T @ np.array(d))

    def axis(self, a: Any, kind: str) -> Array:
        return self.arrow(a) * (1.0 if kind in ("prismatic", "planar") else self.change.hand)

    def named(self, name: str) -> str:
        """A body or a joint; a part stands for its body, as the two may have one name."""
        if name in self.tokens:
            return self.tokens[name]
        if "~" in name and all(n in self.tokens for n in name.split("~")):
            return "~".join(sorted(self.tokens[n] for n in name.split("~")))
        return name

    def part(self, name: str) -> str:
        return self.originals.get(name, name)

    def all(self) -> dict[str, Any]:
        report = self.design.report
        assert report is not None
        out: dict[str, Any] = {"exit code": verdict(report)}
        for rule in report.rules:
            if rule.code not in ABSOLUTE:
                out[f"rule {rule.code}"] = rule.outcome
        self._findings(out)
        self._joints(out)
        self._simulation(out)
        self._contacts(out)
        self._mass(out)
        return out

    def _findings(self, out: dict[str, Any]) -> None:
        seen: dict[str, list[Any]] = {}
        for f in self.design.report.findings:
            if f.code in ABSOLUTE:
                continue
            about = ", ".join(sorted(self.named(s) for s in f.subject))
            where = None if f.place is None else self.place(f.place) / self.size
            seen.setdefault(f"finding {f.code} {about}", []).append((f.severity, where, _amounts(f.found), f.message))
        for key, found in seen.items():
            out[key] = [severity for severity, *_ in found]
            if len(found) == 1:
                out[f"~place of {key}"] = found[0][1]
                if not any(word in (found[0][3]) for word in ("(",)):
                    out[f"~found of {key}"] = found[0][2]

    def _joints(self, out: dict[str, Any]) -> None:
        k = self.design.kinematics
        out["bodies"] = sorted(self.bodies.values())
        for joint in k.joints:
            name = self.joint_names[joint.name]
            out[f"joint {name}"] = (joint.type, joint.status, joint.freedoms, sorted(r.type for r in joint.readings))
            out[f"held {name}"] = joint.held
            if joint.axis is not None and joint.status not in ("ambiguous",):
                axis = self.axis(joint.axis, joint.type)
                out[f"axis of {name}"] = axis * np.sign(axis @ UP)
                if joint.type in ("revolute", "screw", "cylindrical") and joint.point is not None:
                    p = self.place(joint.point)
                    out[f"line of {name}"] = (p - axis * (axis @ p)) / self.size
            if joint.pitch is not None:
                out[f"pitch of {name}"] = joint.pitch * self.change.hand / self.scale / self.size
            ways = sorted(way.kind for way in joint.releases)
            out[f"~releases of {name}"] = ways
        for one in self.values["joints"]["intended"]:
            out[f"intended {one['name']}"] = one["answer"]
        m = dict(self.values["joints"]["mobility"])
        for key, value in m.items():
            out[f"mobility {key}"] = value
        out["idle bodies"] = sorted(self.named(b) for b in k.mobility.idle_bodies)
        out["uncertain"] = sorted(self.named(b) for b in k.mobility.uncertain)
        out["singular"] = (k.mobility.singular, k.mobility.infinitesimal, k.mobility.on_edge)
        out["certificates"] = len(k.mobility.certificates)
        out["~finite reason"] = bool(k.mobility.finite_reason)
        if self.change.ground is None:  # of two bodies either leaves the other
            out["separations"] = sorted(sorted(self.named(b) for b in s.bodies) for s in k.separations)
        out["separations reason"] = bool(k.separations_reason)
        for c in self.values["mobility"]["couplings"]:
            if "ratio" in c and isinstance(c["ratio"], float):
                out[f"~coupling {sorted(self.named(j) for j in c.get('joints', ()))}"] = abs(c["ratio"])

    def _value(self, joint: str, value: float | None) -> float | None:
        if value is None:
            return None
        return value / self.scale / self.size if self.types.get(joint) in SLIDING else value

    def _simulation(self, out: dict[str, Any]) -> None:
        run = self.values["simulation"]
        if run is None:
            return
        out["run"] = (run["status"], run["level"], run["samples"])
        out["run failures"] = len(run["failures"])
        for course in run["joints"]:
            if course["intended_name"] is None:
                continue
            length = course["unit"] == "m"
            by = 1.0 / self.scale / self.size if length else 1.0
            if course["type"] in ("revolute", "prismatic", "screw"):
                for key, value in course["intended_position"].items():
                    out[f"course {course['intended_name']} {key}"] = value * by
                out[f"course {course['intended_name']} fastest"] = course["fastest"] * by
        for use in run["drives"]:
            power = 4 if self.types.get(use["joint"]) in SLIDING else 5
            name = self.named(use["joint"])
            for key in ("peak", "rms"):
                out[f"drive {name} {key}"] = use[key] / self.scale**power
            out[f"~drive {name} work"] = use["work"] / self.scale**5
        for item in run["ranges"] or ():
            name, sign = self.named(item["joint"]), self.signs.get(item["joint"], 1.0)
            ends = [item["lower"], item["upper"]]
            if sign < 0:
                ends.reverse()
            for which, end in zip(("lower", "upper"), ends, strict=True):
                value = self._value(item["joint"], end["value"])
                out[f"range {name} {which}"] = end["status"]
                out[f"range {name} {which} value"] = None if value is None else sign * value
                out[f"~range {name} {which} parts"] = sorted(self.part(p) for p in end["parts"])
            out[f"range {name} left out"] = len(item["left_out"])
        out["ranges"] = run["ranges"] is not None
        collisions = run["collisions"]
        out["collisions"] = (
            None
            if collisions is None
            else sorted("~".join(sorted(self.part(p) for p in c["parts"])) for c in collisions)
        )
        for c in collisions or ():
            name = "~".join(sorted(self.part(p) for p in c["parts"]))
            out[f"collision {name} time"] = c["time"]
            out[f"~collision {name} depth"] = None if c["depth"] is None else c["depth"] / self.scale / self.size
        out["not collided"] = sorted(
            "~".join(sorted(self.part(p) for p in c["parts"])) for c in run["collisions_unknown"]
        )

    def _contacts(self, out: dict[str, Any]) -> None:
        contacts = self.design.contacts
        kinds: dict[str, list[str]] = {}
        areas: dict[str, float] = {}
        for p in contacts.patches:
            name = "~".join(sorted(self.part(x) for x in p.parts))
            kinds.setdefault(name, []).append(p.kind)
            areas[name] = areas.get(name, 0.0) + p.area / self.scale**2 / self.size**2
        for name, found in kinds.items():
            out[f"patches {name}"] = sorted(set(found))
            out[f"~pieces of patches {name}"] = sorted(found)
            out[f"~area {name}"] = areas[name]
        for one in self.values["contacts"]["interferences"]:
            name = "~".join(sorted(self.part(x) for x in one["parts"]))
            for key in ("volume", "depth"):
                if isinstance(one.get(key), float):
                    out[f"~{key} {name}"] = one[key] / (self.scale * self.size) ** (3 if key == "volume" else 1)
        out["suggestions"] = sorted(
            "~".join(sorted(self.part(x) for x in s.get("parts", ()))) for s in self.values["contacts"]["suggestions"]
        )

    def _mass(self, out: dict[str, Any]) -> None:
        for one in self.values["mass"]["bodies"]:
            if one["mass"] is not None:
                name = self.named(one["name"])
                out[f"mass {name}"] = one["mass"] / self.scale**3
                if one["centre_of_mass"] is not None:
                    out[f"centre of mass {name}"] = self.place(one["centre_of_mass"]) / self.size


def _amounts(text: str | None) -> list[str]:
    """Words of a size, without its numbers, which are of the unit."""
    return re.sub(r"[-+]?\d[\d.e+-]*", "#", text or "").split()


def differences(one: Mapping[str, Any], other: Mapping[str, Any], within: float = 1e-5) -> dict[str, tuple[Any, Any]]:
    """What differs, by its name: keys that begin with ~ are of less weight."""
    out = {}
    for key in sorted(one.keys() | other.keys()):
        a, b = one.get(key, "absent"), other.get(key, "absent")
        if not _same(a, b, within):
            out[key] = a, b
    return out


def _same(a: Any, b: Any, within: float) -> bool:
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return a.shape == b.shape and bool(np.all(np.abs(a - b) <= within * np.maximum(1.0, np.abs(a))))
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return False
    if isinstance(a, float) and isinstance(b, float):
        return abs(a - b) <= within * max(1e-3, abs(a), abs(b))
    return bool(a == b)

"""The lock: behaviour that was derived once and that the designer accepted, in a file that people review.

JSON in mm, degrees and grams, each value rounded to a tenth of the tolerance that stands beside it, sorted by name: the
same behaviour gives the same bytes, and a change of behaviour is a change of a few lines. Findings and motion are
not in it: a baseline keeps those, and requirements judge these.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from kinform.changes.behaviours import Axis, BodyMass, JointState, Snapshot, Vector
from kinform.changes.change import Change
from kinform.changes.comparison import Comparison, compare
from kinform.changes.tolerance import Tolerance
from kinform.design import Design
from kinform.errors import InputError, Problem
from kinform.foundation.escapes import json_text
from kinform.foundation.texts import parse_json
from kinform.frozen import dataclass
from kinform.model.assembly import Source
from kinform.model.findings import CheckReport, Finding, stated

if TYPE_CHECKING:
    from kinform.consistency import Outcome

GRAIN_SHARE = 0.1
"""Values are rounded to this share of their tolerance: rounding cannot make a difference by itself. Of two
roundings each is off by half of it, a tenth of the tolerance together."""


SCHEMA = "kinform/behaviour-lock/1"
CODE, NAME = "KF450", "behaviour-differs-from-lock"

ACCEPTED = Tolerance(length=1e-5, angle=math.radians(0.05), mass=1e-6, share=5e-3)
"""What a lock lets pass where nothing else is stated: 0.01 mm, 0.05°, 1 mg, 0.5 %."""

TOLERANCES = {
    "length_mm": ("length", 1e-3), "angle_deg": ("angle", math.radians(1.0)), "mass_g": ("mass", 1e-3),
    "mass_percent": ("share", 1e-2),
}  # fmt: skip
"""By key in the file: the field of `Tolerance`, and what a unit of the file is in SI."""

FREE = "free"
"""The end of a range at which nothing stops the joint."""


@dataclass(frozen=True)
class Lock:
    """An accepted behaviour, and what still counts as the same."""

    behaviour: Snapshot
    tolerance: Tolerance
    file: str
    lines: Mapping[str, int]
    """By name of a body or joint: the line on which it stands."""


def write_lock(behaviour: Snapshot, tolerance: Tolerance = ACCEPTED) -> str:
    """The text of a lock. Raises ValueError where joints are not known."""
    if behaviour.joints is None or behaviour.bodies is None:
        raise ValueError("joints are not known")
    grain = _Grain(tolerance)
    masses = {body.name: body for body in behaviour.masses or ()}
    lock: dict[str, Any] = {
        "schema": SCHEMA,
        "assembly": behaviour.assembly,
        "tolerances": {key: _short(getattr(tolerance, name) / size) for key, (name, size) in TOLERANCES.items()},
        "mobility": dict(behaviour.mobility or ()),
        "ground": behaviour.ground,
        "bodies": [
            {"name": name, "parts": list(parts), **(_mass(masses[name], grain) if name in masses else {})}
            for name, parts in behaviour.bodies
        ],
        "joints": [_joint(joint, grain) for joint in behaviour.joints],
    }
    if behaviour.interferences is not None:
        lock["overlaps"] = [
            {"parts": list(parts), "depth_mm": grain.length(depth)} for parts, depth in behaviour.interferences
        ]
    return _text(lock) + "\n"


def read_lock(text: str, file: str) -> Lock:
    """The lock in a text; raises InputError, naming `file`, where it is none."""
    try:
        lock = parse_json(text)
        if not isinstance(lock, dict) or lock.get("schema") != SCHEMA:
            stated = lock.get("schema") if isinstance(lock, dict) else None
            raise ValueError(f"its schema is {stated!r}, not {SCHEMA!r}")
        behaviour = _read(lock)
        names = [name for name, _ in behaviour.bodies or ()] + [str(joint.name) for joint in behaviour.joints or ()]
        return Lock(behaviour, _read_tolerance(lock["tolerances"]), file, _lines(text, names))
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        message = f"{error.args[0]!r} is missing" if isinstance(error, KeyError) else str(error)
        problem = Problem(
            f"this is no lock of kinform: {message}", file, None, "write it anew: kinform lock F.h5 -o FILE"
        )
        raise InputError([problem]) from None


def with_lock(report: CheckReport, design: Design, lock: Lock) -> CheckReport:
    """The report with a finding for each difference from the lock, and what became of the rule KF450."""
    from kinform.changes.behaviours import snapshot
    from kinform.consistency import amended

    return amended(report, design, _outcome(compare(lock.behaviour, snapshot(design), lock.tolerance), lock))


def _outcome(comparison: Comparison, lock: Lock) -> Outcome:
    from kinform.consistency import Outcome

    findings = tuple(_finding(change, lock) for change in comparison.changes)
    findings += tuple(_new(what, lock) for what in comparison.new)
    lacking = [what for what, why in comparison.missing if why.endswith("after")]
    if lacking:
        return Outcome("inconclusive", findings, f"{', '.join(lacking)} of {lock.file} have not been computed")
    return Outcome("decided", findings)


def _new(what: str, lock: Lock) -> Finding:
    return Finding(
        CODE, NAME, "note", (what,), f"{what} are new: {lock.file} does not hold them", file=lock.file,
        remedy="Take them in: kinform lock F.h5 -o FILE, and review the file.",
    )  # fmt: skip


def _finding(change: Change, lock: Lock) -> Finding:
    place = Source(lock.file, lock.lines.get(change.subject[0]))
    return Finding(
        CODE, NAME, "error", change.subject, f"{change.message}, against {lock.file}", change.after, change.before,
        place=change.place, file=lock.file, line=lock.lines.get(change.subject[0]),
        remedy="Repair the design; or accept the change: kinform lock F.h5 -o FILE, and review the file.",
        witness=stated(place, _dumped(change.subject[0])),
    )  # fmt: skip


class _Grain:
    """Rounds to a tenth of a tolerance, in mm, degrees and grams."""

    def __init__(self, tolerance: Tolerance):
        self.tolerance = tolerance

    def length(self, metres: float) -> float:
        return _rounded(1e3 * metres, GRAIN_SHARE * 1e3 * self.tolerance.length)

    def angle(self, radians: float) -> float:
        return _rounded(math.degrees(radians), GRAIN_SHARE * math.degrees(self.tolerance.angle))

    def mass(self, kilograms: float) -> float:
        grain = GRAIN_SHARE * max(1e3 * self.tolerance.mass, self.tolerance.share * 1e3 * kilograms)
        return _rounded(1e3 * kilograms, grain)

    def moments(self, values: Sequence[float]) -> list[float]:
        """g·mm²."""
        grain = 1e9 * GRAIN_SHARE * self.tolerance.share * max(map(abs, values))
        return [_rounded(1e9 * value, grain) for value in values]

    def place(self, point: Vector) -> list[float]:
        return [self.length(x) for x in point]


def _rounded(value: float, grain: float) -> float:
    """The nearest decimal number as coarse as the grain allows; whole numbers as such."""
    if not math.isfinite(value) or grain <= 0.0:
        return value
    decimal = round(value, -math.floor(math.log10(grain))) + 0.0
    return int(decimal) if decimal == int(decimal) and abs(decimal) < 2**53 else decimal


def _short(value: float) -> float:
    return float(f"{value:.9g}")


def _mass(body: BodyMass, grain: _Grain) -> dict[str, Any]:
    return {
        "mass_g": None if body.mass is None else grain.mass(body.mass),
        "centre_of_mass_mm": None if body.centre_of_mass is None else grain.place(body.centre_of_mass),
        "principal_moments_g_mm2": None if body.principal_moments is None else grain.moments(body.principal_moments),
        "inertia_g_mm2": None if body.inertia is None else grain.moments(body.inertia),
    }


def _joint(joint: JointState, grain: _Grain) -> dict[str, Any]:
    row: dict[str, Any] = {
        "name": joint.name, "bodies": list(joint.bodies), "type": joint.type, "status": joint.status,
        "freedoms": joint.freedoms,
    }  # fmt: skip
    for name, axis in (("axis", joint.axis), ("axis2", joint.axis2)):
        if axis is not None:
            # 1e-6 rad is far below any tolerance of angles that a lock has
            row[name] = [round(x, 6) + 0.0 for x in axis.direction]
    point = joint.centre if joint.axis is None or joint.axis.point is None else joint.axis.point
    if point is not None:
        row["point_mm"] = grain.place(point)
    if joint.pitch is not None:
        row["pitch_mm"] = grain.length(joint.pitch)
    if joint.range_status != "unknown" or joint.range_lower is not None or joint.range_upper is not None:
        unit, say = ("mm", grain.length) if joint.slides else ("deg", grain.angle)
        limits = [x if x is None else FREE if math.isinf(x) else say(x) for x in (joint.range_lower, joint.range_upper)]
        row["range"] = {"status": joint.range_status, unit: limits}
    return row


def _text(value: Any) -> str:
    """JSON with a line a body, a joint and an overlap."""
    lines = []
    for key, item in value.items():
        if isinstance(item, list) and item:
            inner = ",\n  ".join(_dumped(entry) for entry in item)
            lines.append(f" {json.dumps(key)}: [\n  {inner}\n ]")
        else:
            lines.append(f" {json.dumps(key)}: {_dumped(item)}")
    return "{\n" + ",\n".join(lines) + "\n}"


def _dumped(value: Any) -> str:
    return json_text(json.dumps(value, ensure_ascii=False, allow_nan=False))


def _lines(text: str, names: Iterable[str]) -> dict[str, int]:
    """The first line (from 1) that names each of them, as the lock is written."""
    wanted = {f'"name": {_dumped(name)}': name for name in names}
    lines: dict[str, int] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        for start in re.findall(r'"name": "(?:[^"\\]|\\.)*"', line):
            if start in wanted:
                lines.setdefault(wanted[start], number)
    return lines


def _read(lock: Mapping[str, Any]) -> Snapshot:
    """The behaviour in a lock, as far as a lock has it: no simulation, no findings."""
    bodies, joints = lock["bodies"], lock["joints"]
    weighed = [body for body in bodies if "mass_g" in body]
    light = [body for body in bodies if "mass_g" not in body]
    if weighed and light:
        raise ValueError(f"body {light[0]['name']!r} has no mass_g, and others have")
    overlaps = lock.get("overlaps")
    return Snapshot(
        assembly=str(lock["assembly"]),
        bodies=tuple((str(body["name"]), tuple(map(str, body["parts"]))) for body in bodies),
        ground=None if lock["ground"] is None else str(lock["ground"]),
        joints=tuple(_read_joint(joint) for joint in joints),
        mobility=tuple((name, _read_count(name, count)) for name, count in lock["mobility"].items()),
        masses=tuple(_read_mass(body) for body in weighed) if weighed else None,
        interferences=None
        if overlaps is None
        else tuple(
            ((str(item["parts"][0]), str(item["parts"][1])), 1e-3 * float(item["depth_mm"])) for item in overlaps
        ),
        simulation=None,
        findings=None,
        ranges=tuple(str(joint["name"]) for joint in joints if "range" in joint) or None,
    )


def _read_count(name: str, count: object) -> int | None:
    if count is not None and (not isinstance(count, int) or isinstance(count, bool)):
        raise ValueError(f"mobility {name} is {count!r}, and has to be a whole number or null")
    return count


def _read_mass(body: Mapping[str, Any]) -> BodyMass:
    mass = body["mass_g"]
    return BodyMass(
        str(body["name"]),
        None if mass is None else 1e-3 * float(mass),
        _read_vector(body.get("centre_of_mass_mm"), 1e-3),
        _read_vector(body.get("principal_moments_g_mm2"), 1e-9),
        _read_tensor(body.get("inertia_g_mm2")),
    )


def _read_tensor(values: Sequence[float] | None) -> tuple[float, ...] | None:
    if values is None:
        return None
    if len(values) != 6:
        raise ValueError("inertia_g_mm2 has to have six numbers: xx, yy, zz, xy, xz, yz")
    return tuple(1e-9 * float(value) for value in values)


def _read_joint(joint: Mapping[str, Any]) -> JointState:
    """A joint of a lock; its point is that of its axis, or its centre where its axes meet there."""
    kind, axis = str(joint["type"]), _read_direction(joint.get("axis"))
    axis2 = _read_direction(joint.get("axis2"))
    point = _read_vector(joint.get("point_mm"), 1e-3)
    limits = joint.get("range", {})
    scale = 1e-3 if kind == "prismatic" else math.pi / 180.0
    lower, upper = limits.get("mm", limits.get("deg", (None, None)))
    centred = kind in ("spherical", "universal")
    first, second = joint["bodies"]
    pitch = joint.get("pitch_mm")
    return JointState(
        name=str(joint["name"]),
        bodies=(str(first), str(second)),
        type=kind,
        status=str(joint["status"]),
        freedoms=int(joint["freedoms"]),
        axis=None if axis is None else Axis(axis, None if centred else point),
        axis2=None if axis2 is None else Axis(axis2, None),
        centre=point if centred else None,
        pitch=None if pitch is None else 1e-3 * float(pitch),
        range_lower=None if lower is None else -math.inf if lower == FREE else scale * float(lower),
        range_upper=None if upper is None else math.inf if upper == FREE else scale * float(upper),
        range_status=str(limits.get("status", "unknown")),
    )


def _read_vector(values: Iterable[float] | None, scale: float) -> Vector | None:
    if values is None:
        return None
    x, y, z = (scale * float(value) for value in values)
    return (x, y, z)


def _read_direction(values: Iterable[float] | None) -> Vector | None:
    direction = _read_vector(values, 1.0)
    # By so much a direction in a lock may miss the length 1; more is a mistake of who wrote it. Numbers of three digits
    # pass.
    if direction is not None and abs(math.hypot(*direction) - 1.0) > 1e-3:
        raise ValueError(f"the direction {list(direction)} is not of length 1")
    return direction


def _read_tolerance(stated: Mapping[str, Any]) -> Tolerance:
    values = {key: float(stated[key]) for key in TOLERANCES}
    for key, value in values.items():
        if not (math.isfinite(value) and value >= 0.0):
            raise ValueError(f"the tolerance {key} is {value:g}, and has to be a finite number from 0")
    return Tolerance(**{name: size * values[key] for key, (name, size) in TOLERANCES.items()})

"""What `kinform show --format json` prints: one object a topic, SI and radians, world axes.

The object of `joints` is a contract that scripts rely on; in all of them a value that is not known, not
finite, or not computed yet is null.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from dataclasses import asdict
from typing import Any

import numpy as np

from kinform.behaviour.joints import KINDS
from kinform.errors import StageError
from kinform.kinematics import Motions, insight
from kinform.model.assembly import Assembly, Part
from kinform.model.collisions import JointRange
from kinform.model.design import Design
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import Joint, Kinematics, Mobility, Release
from kinform.model.mass import MassProperties
from kinform.model.simulation import Simulation
from kinform.reports import as_json
from kinform.reports.motions import freedom_text, metres

__all__ = [
    "TOPICS",
    "coordinates",
    "joint_evidence",
    "joint_json",
    "mobility_counts",
    "plain",
    "release",
    "summary",
    "summary_json",
]


def summary(design: Design, topic: str | None = None) -> dict[str, Any]:
    """The values of one topic, or of all of them, as JSON has them: dicts, lists, text, numbers, None.

    Topics: assembly, contacts, joints, mobility, mass, behaviour, simulation, findings. Raises StageError when the
    stage of the topic has not run, and ValueError for another topic.
    """
    if topic is None:
        known = {name: summary(design, name) if _known(design, name) else None for name in TOPICS}
        return {"schema": "kinform/design/1", **known}
    if topic not in TOPICS:
        raise ValueError(f"unknown topic {topic!r}: expected one of {', '.join(TOPICS)}")
    if not _known(design, topic):
        raise StageError(f"`kinform show {topic}`", TOPICS[topic][0])
    head = {"schema": f"kinform/{topic}/1", "assembly": design.assembly.name, "units": design.assembly.units}
    found: dict[str, Any] = plain(head | TOPICS[topic][2](design))
    return found


def summary_json(design: Design, topic: str | None = None) -> str:
    """`summary` as JSON text, ending in a newline."""
    return json.dumps(summary(design, topic), indent=1, allow_nan=False) + "\n"


def joint_evidence(design: Design, name: str) -> dict[str, Any]:
    """All the evidence of one joint. Raises StageError when joints are not known, KeyError for another name."""
    if not _known(design, "joints"):
        raise StageError("`kinform show joints`", TOPICS["joints"][0])
    found = insight(design, name)
    of_patch = ("parts", "surfaces", "kind", "one_sided", "area", "gap", "fit")
    evidence: dict[str, Any] = plain(
        {
            "schema": "kinform/joint/1",
            "assembly": design.assembly.name,
            "units": design.assembly.units,
            "joint": _joint(found.joint, found.joint.name in _ranged(design)),
            "patches": [
                _fields(item, "index", "role", "share", "rows") | _fields(item.patch, *of_patch)
                for item in found.patches
            ],
            **_fields(found, "rows", "samples", "last_free", "first_held"),
            "thresholds": _fields(found, "free", "held"),
            "alternatives": [
                _fields(item, "without", "frees", "type", "freedoms", "status", "axis") for item in found.alternatives
            ],
            **_fields(found, "tried"),
            "remark": found.remark or None,
        }
    )
    return evidence


def joint_json(design: Design, name: str) -> str:
    """`joint_evidence` as JSON text, ending in a newline."""
    return json.dumps(joint_evidence(design, name), indent=1, allow_nan=False) + "\n"


def plain(value: Any) -> Any:
    """The value as JSON has it: arrays as lists, and null for what is not a finite number."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, (np.ndarray, np.generic)):
        return plain(value.tolist())
    if isinstance(value, float):
        return value + 0.0 if math.isfinite(value) else None
    return value


def mobility_counts(mobility: Mobility) -> dict[str, int | None]:
    """All counts by name."""
    return {
        "instantaneous": mobility.instantaneous,
        "finite": mobility.finite,
        "effective": mobility.effective,
        "idle": mobility.idle,
        "redundant": mobility.redundant,
        "blocked_mobility": mobility.blocked,
    }


def coordinates(run: Simulation) -> Iterator[tuple[str, str, str, int]]:
    """Of each joint coordinate of a run its name ("joint", or of several "joint.angle"), the type of the
    joint, the unit (rad, m, or 1 for the quaternion of a spherical joint, whose rates are rad/s), the column.
    """
    for joint, (name, kind) in enumerate(zip(run.joint_names, run.joint_types, strict=True)):
        labels = KINDS[kind].coordinates
        for column, (label, rotational) in enumerate(labels, start=int(run.joint_offset[joint])):
            unit = "1" if kind == "spherical" else "rad" if rotational else "m"
            yield (name if len(labels) == 1 else f"{name}.{label}"), kind, unit, column


def _fields(record: object, *names: str) -> dict[str, Any]:
    return {name: getattr(record, name) for name in names}


def _assembly(design: Design) -> dict[str, Any]:
    assembly = design.assembly
    return {
        "ground": assembly.ground,
        "parts": [_part(part) for part in assembly.parts],
        "groups": [_fields(group, "name", "parts") for group in assembly.groups],
        "subassemblies": [_fields(sub, "name", "file", "mobility") for sub in assembly.subassemblies],
        "assumptions": [
            _fields(assumption, "between", "type", "ignore", "axis", "point", "pitch", "reason")
            for assumption in assembly.assumptions
        ],
        "function": _function(assembly),
        "tolerances": asdict(assembly.tolerances),
        "files": assembly.files,
        "notes": assembly.notes,
    }


def _part(part: Part) -> dict[str, Any]:
    mesh = part.mesh
    return {
        "name": part.name,
        "mesh": None if mesh is None else _fields(mesh, "path", "body", "digest") | asdict(mesh.health),
        "pose": part.X_WP,
        **_fields(part, "solid", "material", "density"),
        "mass": None if part.override is None else part.override.mass,
        "units": part.units,
    }


def _function(assembly: Assembly) -> dict[str, Any]:
    def joint(wanted: IntendedJoint) -> dict[str, Any]:
        return _fields(wanted, "name", "between", "type", "axis", "axis2", "point", "pitch", "range")

    function = assembly.function
    return {"mobility": function.mobility, "joints": [joint(wanted) for wanted in function.joints]}


def _contacts(design: Design) -> dict[str, Any]:
    contacts = design.contacts
    assert contacts is not None
    of_patch = (
        "parts", "surfaces", "kind", "one_sided", "area", "gap", "fit", "axis", "point", "radii", "misalignment",
        "offset", "chord",
    )  # fmt: skip
    of_overlap = ("parts", "volume", "depth", "place", "mated", "method")
    return {
        "patches": [{"index": i} | _fields(patch, *of_patch) for i, patch in enumerate(contacts.patches)],
        "interferences": [_fields(overlap, *of_overlap) for overlap in contacts.interferences],
        "suggestions": [
            _fields(hint, "parts", "kind", "fastens", "confidence", "evidence", "axis", "point")
            for hint in contacts.suggestions
        ],
        "pairs": [{"parts": pair, "tolerance": contacts.tolerance.get(pair)} for pair in contacts.candidates],
    }


def _joints(design: Design) -> dict[str, Any]:
    kinematics = design.ranged or _kinematics(design)
    computed = _ranged(design)
    return {
        "bodies": [_fields(body, "name", "parts", "ground", "merged") for body in kinematics.bodies],
        "joints": [_joint(joint, joint.name in computed) for joint in kinematics.joints],
        "mobility": mobility_counts(kinematics.mobility),
        "separations": [
            _fields(item, "bodies", "contacts") | {"releases": [release(way) for way in item.releases]}
            for item in kinematics.separations
        ],
        "separations_reason": kinematics.separations_reason or None,
    }


def _ranged(design: Design) -> set[str]:
    """Names of the joints whose range has been computed."""
    run = design.simulation
    return set() if run is None or run.ranges is None else {item.joint for item in run.ranges}


def _joint(joint: Joint, computed: bool) -> dict[str, Any]:
    """Its range is null as long as it has not been computed: one that was computed and is not known says so."""
    of_blocker = ("parts", "patch", "area", "share", "place", "gap", "forbids")
    limits = {"lower": joint.range_lower, "upper": joint.range_upper, "status": joint.range_status}
    return {
        **_fields(joint, "name", "bodies", "type", "axis", "point"),
        **({"axis2": joint.axis2} if joint.type == "universal" else {}),
        **_fields(joint, "pitch", "freedoms"),
        **({"twists": joint.twists} if joint.type == "general" else {}),
        **_fields(joint, "evidence", "status", "reason", "motion"),
        "range": limits if computed else None,
        "patches": joint.patches,
        "blocked_by": [_fields(blocker, *of_blocker) for blocker in joint.blockers],
        "singular_values": joint.singular_values,
        **_fields(joint, "held", "held_reason", "extremes"),
        "releases": [release(way) for way in joint.releases],
    }


def release(way: Release) -> dict[str, Any]:
    """A way to leave, as JSON has it."""
    return _fields(way, "kind", "direction", "point", "twist", "extreme", "words")


def _mobility(design: Design) -> dict[str, Any]:
    kinematics = _kinematics(design)
    mobility = kinematics.mobility
    return {
        **mobility_counts(mobility),
        **_fields(mobility, "idle_bodies", "uncertain", "finite_reason", "infinitesimal", "singular"),
        "certificates": [asdict(certificate) for certificate in mobility.certificates],
        "bodies": [body.name for body in kinematics.bodies],
        "gruebler": mobility.gruebler,
        "freedoms": mobility.freedoms if len(mobility.freedoms) == mobility.instantaneous else None,
        "named": _named(kinematics),
        "redundancies": [
            _fields(one, "kind", "text", "rows", "joints", "patches", "directions", "wrenches")
            for one in mobility.redundancies
        ],
        "misfit": asdict(kinematics.misfit),
        "misaligned": [
            {"joint": joint, "angle": angle, "offset": offset} for joint, angle, offset in kinematics.misaligned
        ],
        "couplings": [asdict(coupling) for coupling in kinematics.couplings],
    }


def _named(kinematics: Kinematics) -> list[dict[str, Any]]:
    motions = Motions.of(kinematics)
    return [
        {
            "text": freedom_text(freedom, metres),
            **_fields(freedom, "driver", "body", "kind", "axis", "point", "pitch", "idle", "looped"),
            "moves": list(motions.twists(freedom)),
            "drives": [{"joint": joint, "twist": twist, "rate": rate} for joint, twist, rate in freedom.drives],
        }
        for freedom in kinematics.mobility.named
    ]


def _mass(design: Design) -> dict[str, Any]:
    report = design.mass
    assert report is not None
    return {
        "valid": report.valid,
        "parts": [_properties(part) for part in report.parts],
        "bodies": [_properties(body) for body in report.bodies],
        "problems": [{"part": part, "message": message} for part, message in report.problems],
    }


def _properties(item: MassProperties) -> dict[str, Any]:
    names = ("name", "mass", "volume", "centre_of_mass", "inertia", "principal_moments", "principal_axes")
    return _fields(item, *names, "mass_bound", "origin") | {"reason": item.reason or None}


def _behaviour(design: Design) -> dict[str, Any]:
    from kinform.behaviour import counts
    from kinform.exports.port_model import network

    model = design.behaviour
    assert model is not None
    levels = [
        {"system": path, "unknowns": found.unknowns, "equations": found.equations, "balanced": found.balanced}
        for path, found in counts(model.nested)
    ]
    return {
        "counts": levels,
        **network(model.nested),
        "failures": [{"subject": subject, "message": why} for subject, why in model.failures],
        "forces_missing": [{"subject": subject, "message": why} for subject, why in model.forces_missing],
    }


def _simulation(design: Design) -> dict[str, Any]:
    run = design.simulation
    assert run is not None
    ran = bool(len(run.time))
    return {
        "status": run.status,
        "reason": run.reason or None,
        "level": run.level or None,
        "duration": run.time[-1] if ran else None,
        "samples": len(run.time),
        "bodies": run.body_names,
        "joints": [_course(run, *coordinate) for coordinate in coordinates(run)] if ran else [],
        "residual": run.residual.max() if len(run.residual) else None,
        "balance": run.balance.max() if run.level == "dynamic" and len(run.balance) else None,
        "drives": [_fields(use, "joint", "kind", "peak", "rms", "peak_power", "work") for use in run.drives],
        "gears": [
            {
                "joint": name,
                "peak": np.abs(run.gear_effort[:, k]).max(axis=0, initial=0.0),
                "peak_force": np.abs(run.gear_force[:, k]).max(initial=0.0),
            }
            for k, name in enumerate(run.gear_names)
        ],
        "undetermined": {
            name: [label for label, flag in zip(_COMPONENTS, flags, strict=True) if flag]
            for name, flags in zip(run.joint_names, run.undetermined, strict=False)
        },
        "assumptions": run.assumptions,
        "failures": [{"subject": subject, "message": message} for subject, message in run.failures],
        "ranges": None if run.ranges is None else [_range(item) for item in run.ranges],
        "collisions": None
        if run.collisions is None
        else [_fields(item, "parts", "time", "place", "depth") for item in run.collisions],
        "collisions_unknown": [{"parts": [a, b], "reason": why} for a, b, why in run.uncollided],
    }


_COMPONENTS = ("tau_x", "tau_y", "tau_z", "f_x", "f_y", "f_z")


def _range(item: JointRange) -> dict[str, Any]:
    of_end = ("status", "value", "parts", "place", "reason", "leaves")
    return {
        "joint": item.joint,
        "status": item.status,
        "lower": _fields(item.lower, *of_end),
        "upper": _fields(item.upper, *of_end),
        "left_out": item.left_out,
    }


def _course(run: Simulation, name: str, kind: str, unit: str, column: int) -> dict[str, Any]:
    values = run.joint_position[:, column]
    return {
        "name": name,
        "type": kind,
        "unit": unit,
        "start": values[0],
        "end": values[-1],
        "lowest": values.min(),
        "highest": values.max(),
        "fastest": np.abs(run.joint_velocity[:, column]).max(),
    }


def _findings(design: Design) -> dict[str, Any]:
    assert design.report is not None
    return as_json.document(design.report, design)


def _kinematics(design: Design) -> Kinematics:
    assert design.kinematics is not None
    return design.kinematics


def _known(design: Design, topic: str) -> bool:
    return getattr(design, TOPICS[topic][1]) is not None


TOPICS: dict[str, tuple[str, str, Callable[[Design], dict[str, Any]]]] = {
    "assembly": ("import", "assembly", _assembly),
    "contacts": ("contacts", "contacts", _contacts),
    "joints": ("joints", "kinematics", _joints),
    "mobility": ("joints", "kinematics", _mobility),
    "mass": ("mass", "mass", _mass),
    "behaviour": ("simulate", "behaviour", _behaviour),
    "simulation": ("simulate", "simulation", _simulation),
    "findings": ("check", "report", _findings),
}
"""By topic: the command that computes it, the field of Design that holds it, and its values."""

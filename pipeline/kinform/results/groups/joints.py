"""`/joints`: bodies, joints with what carries and what blocks them, and what snapping left over."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import h5py
import numpy as np

from kinform.model.arrays import freeze
from kinform.model.kinematics import Blocker, Body, Coupling, Joint, Kinematics, Meshing, Misfit, Release, Separation
from kinform.results.table import (
    flag,
    integer,
    pair,
    read_ragged,
    read_records,
    read_rows,
    read_texts,
    real,
    text,
    texts,
    vector,
    write_ragged,
    write_records,
    write_rows,
    write_texts,
)
from kinform.reuse.inputs import only_bodies

__all__ = ["read", "read_bodies", "read_decisions", "write", "write_decisions"]

_BODIES = (text("name"), texts("parts"), flag("ground"), texts("merged"))
_JOINTS = (
    text("name"), pair("bodies", text, ("body_a", "body_b")), text("type"), vector("axis", "1"),
    vector("point", "m"), vector("axis2", "1"), real("pitch", "m a turn"), integer("freedoms"),
    texts("evidence"), text("status"), text("reason"), real("range_lower", "rad or m"),
    real("range_upper", "rad or m"), text("range_status"), text("motion"),
)  # fmt: skip
_BLOCKERS = (
    integer("joint"), pair("parts", text, ("part_a", "part_b")), integer("patch"), real("area", "m²"),
    real("share", "1"), vector("place", "m"), real("gap", "m"), text("forbids"),
)  # fmt: skip
_HELD = (integer("held", optional=True), integer("extremes", optional=True), text("held_reason"))
_RELEASE = (
    text("kind"), vector("direction", "1"), vector("point", "m"), flag("extreme"),
    text("words"), vector("twist", "rad/s, m/s (ω; v)", ("wx", "wy", "wz", "vx", "vy", "vz")),
)  # fmt: skip
"""Columns of a release, wherever one is stored."""
_RELEASES = (integer("joint"), *_RELEASE)
_SEPARATIONS = (texts("bodies"), texts("contacts"))
_WAYS_APART = (integer("separation"), *_RELEASE)
_MISFIT = (real("angle", "rad"), real("distance", "m"), text("angle_at"), text("distance_at"))
_COUPLINGS = (
    pair("joints", text, ("joint_a", "joint_b")), real("ratio", "rad or m over rad or m"), text("kind"),
    text("through"), text("status"), real("uncertainty", "rad or m over rad or m"), text("reason"),
)  # fmt: skip
_MESHINGS = (
    integer("coupling"), real("ratio", "rad or m over rad or m"), pair("teeth", integer, ("teeth_a", "teeth_b")),
    pair("pitches", real, ("pitch_a", "pitch_b"), "rad or m"), real("deviation", "rad or m"), real("play", "rad or m"),
    pair("reach", real, ("reach_lower", "reach_upper"), "rad or m"), vector("place", "m"), vector("flank", "1"), vector("back", "1"),
)  # fmt: skip
_DECISIONS = (text("key"), text("decision"), text("seal"))
_MISALIGNED = (text("joint"), real("angle", "rad"), real("offset", "m"))


def write(group: h5py.Group, kinematics: Kinematics) -> None:
    """Write bodies and joints; twists, patches and singular values are ragged, one item a joint."""
    joints = kinematics.joints
    write_records(group, "bodies", _BODIES, kinematics.bodies)
    write_records(group, "joints", _JOINTS, joints)
    write_ragged(group, "twists", [joint.twists for joint in joints], "rad/s, m/s (ω; v)", width=6)
    write_ragged(group, "singular_values", [joint.singular_values for joint in joints], "1")
    write_ragged(group, "patches", [joint.patches for joint in joints], "1", dtype="<i8")
    blockers = [vars(blocker) | {"joint": i} for i, joint in enumerate(joints) for blocker in joint.blockers]
    write_rows(group, "blockers", _BLOCKERS, blockers)
    held = [vars(joint) | {"held": None if joint.held is None else int(joint.held)} for joint in joints]
    write_rows(group, "held", _HELD, held)
    releases = [vars(release) | {"joint": i} for i, joint in enumerate(joints) for release in joint.releases]
    write_rows(group, "releases", _RELEASES, releases)
    apart = kinematics.separations
    write_records(group, "separations", _SEPARATIONS, apart)
    ways = [vars(release) | {"separation": i} for i, item in enumerate(apart) for release in item.releases]
    write_rows(group, "separation_releases", _WAYS_APART, ways)
    write_texts(group, "separations_reason", [kinematics.separations_reason])
    write_records(group, "misfit", _MISFIT, [kinematics.misfit])
    fields = [column.field for column in _MISALIGNED]
    rows = [dict(zip(fields, row, strict=True)) for row in kinematics.misaligned]
    write_rows(group, "misaligned", _MISALIGNED, rows)
    write_records(group, "couplings", _COUPLINGS, kinematics.couplings)
    teeth = [(k, coupling.meshing) for k, coupling in enumerate(kinematics.couplings) if coupling.meshing is not None]
    rows = [vars(mesh) | {"coupling": k, "flank": mesh.normals[0], "back": mesh.normals[1]} for k, mesh in teeth]
    write_rows(group, "meshings", _MESHINGS, rows)


def write_decisions(group: h5py.Group, decisions: Mapping[str, tuple[str, str]]) -> None:
    """Write what contact decides of single pairs, packed, by the hash of what decides it."""
    rows = [{"key": key, "decision": text, "seal": seal} for key, (text, seal) in sorted(decisions.items())]
    write_rows(group, "decisions", _DECISIONS, rows)


def read_decisions(group: h5py.Group) -> dict[str, tuple[str, str]]:
    """What `write_decisions` wrote."""
    if "decisions" not in group:
        return {}
    rows = read_rows(group, "decisions", _DECISIONS)
    return {row["key"]: (row["decision"], row["seal"]) for row in rows}


def _separations(group: h5py.Group) -> dict[str, Any]:
    if "separations" not in group:
        return {}
    (reason,) = read_texts(group, "separations_reason")
    rows = read_rows(group, "separations", _SEPARATIONS)
    ways: list[list[Release]] = [[] for _ in rows]
    for row in read_rows(group, "separation_releases", _WAYS_APART):
        ways[row.pop("separation")].append(Release(**row))
    found = [Separation(**row, releases=tuple(own)) for row, own in zip(rows, ways, strict=True)]
    return {"separations": tuple(found), "separations_reason": reason}


def read(group: h5py.Group) -> dict[str, Any]:
    """The fields of Kinematics that `write` wrote."""
    (misfit,) = read_records(group, "misfit", _MISFIT, Misfit)
    return {
        "bodies": read_records(group, "bodies", _BODIES, Body),
        "joints": _read_joints(group),
        "misfit": misfit,
        **_separations(group),
        "misaligned": tuple(tuple(row.values()) for row in read_rows(group, "misaligned", _MISALIGNED)),
        "couplings": _couplings(group),
    }


def _couplings(group: h5py.Group) -> tuple[Coupling, ...]:
    if "couplings" not in group:
        return ()
    rows = read_rows(group, "couplings", _COUPLINGS, added=("reason",))
    teeth = {}
    for row in read_rows(group, "meshings", _MESHINGS) if "meshings" in group else ():
        normals = freeze(np.stack([row.pop("flank"), row.pop("back")]))
        owner = row.pop("coupling")
        teeth[owner] = Meshing(**row, normals=normals)
    return tuple(Coupling(**row, meshing=teeth.get(k)) for k, row in enumerate(rows))


def read_bodies(group: h5py.Group) -> Kinematics:
    """Which parts move as one, and nothing of how."""
    return only_bodies(read_records(group, "bodies", _BODIES, Body))


def _read_joints(group: h5py.Group) -> tuple[Joint, ...]:
    rows = read_rows(group, "joints", _JOINTS, added=("motion",))
    blockers: list[list[Blocker]] = [[] for _ in rows]
    for row in read_rows(group, "blockers", _BLOCKERS):
        blockers[row.pop("joint")].append(Blocker(**row))
    releases: list[list[Release]] = [[] for _ in rows]
    held: list[dict[str, Any]] = [{} for _ in rows]
    if "held" in group:
        for i, row in enumerate(read_rows(group, "held", _HELD)):
            held[i] = row | {"held": None if row["held"] is None else bool(row["held"])}
        for row in read_rows(group, "releases", _RELEASES):
            releases[row.pop("joint")].append(Release(**row))
    ragged = zip(
        read_ragged(group, "twists"),
        read_ragged(group, "singular_values"),
        read_ragged(group, "patches"),
        strict=True,
    )
    return tuple(
        Joint(
            **row,
            twists=twists,
            singular_values=singular,
            patches=tuple(patches.tolist()),
            blockers=tuple(owned),
            releases=tuple(ways),
            **kept,
        )
        for row, owned, ways, kept, (twists, singular, patches) in zip(
            rows, blockers, releases, held, ragged, strict=True
        )
    )

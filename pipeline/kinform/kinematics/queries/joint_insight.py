"""Why a joint is what it is: its patches, the singular values, and what would make it another.

The alternatives are real: patches are left out and the rest is decided again. Which sets are worth trying,
the candidate motions say: a motion becomes free once every patch that it would break is gone.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from kinform.foundation.name_hints import did_you_mean
from kinform.frozen import dataclass
from kinform.kinematics.joints.bodies.classification import evidence_between
from kinform.kinematics.joints.bodies.extents import Extents
from kinform.kinematics.joints.pair.decision import decide
from kinform.kinematics.joints.pair.evidence import Evidence, Member
from kinform.kinematics.joints.pair.hypotheses import candidate_motions, motion_words
from kinform.kinematics.joints.pair.preserved import preserved_motions
from kinform.kinematics.queries.design_view import DesignView
from kinform.model.arrays import Array
from kinform.model.contacts import Patch
from kinform.model.kinematics import Joint, JointStatus, JointType, body_of_part

MOST_PATCHES = 40
"""Joints with more patches are not decided again without each. Chosen, not measured."""
MOST_PATCH_SETS = 24
"""Sets of several patches that are tried, the smallest area first. Chosen, not measured."""


PatchUse = Literal["carries", "blocks", "ends", "ignored"]


@dataclass(frozen=True, eq=False)
class PatchRole:
    """A patch between the two bodies and what it does in the decision."""

    index: int
    """Into Contacts.patches."""
    patch: Patch
    role: PatchUse
    """ignored: a stray touch, or not what decides a joint that somebody stated."""
    share: float
    """Of the area that decides, with wide gaps counting less; 0 where ignored."""
    rows: int
    """Rows of J: samples that bound the patch; 0 for parts of one body."""


@dataclass(frozen=True, eq=False)
class Alternative:
    """What the contact would leave without some patches."""

    without: tuple[int, ...]
    """Indices into Contacts.patches."""
    frees: str
    """The motion that these patches forbid, in words; empty for one tried by itself."""
    type: JointType
    freedoms: int
    status: JointStatus
    axis: Array | None


@dataclass(frozen=True, eq=False)
class Insight:
    """The evidence of one joint."""

    joint: Joint
    patches: tuple[PatchRole, ...]
    rows: int
    """Of J, of all patches that carry or block."""
    samples: int
    """Weighted samples from which the singular values come."""
    last_free: float | None
    """Greatest singular value that counts as free; None where there is none."""
    first_held: float | None
    """Least that counts as held, or, where ambiguous, that might."""
    free: float
    """Threshold below which a value is free."""
    held: float
    """Threshold above which it is held."""
    alternatives: tuple[Alternative, ...]
    """Only those of other type or freedoms."""
    tried: int
    """Sets of patches without which the joint was decided again."""
    remark: str
    """What was not looked at, and why; empty where all was."""


def insight(design: DesignView, name: str) -> Insight:
    """The evidence of the joint of this name. Raises KeyError for another name, listing those that there are."""
    kinematics = design.kinematics
    assert kinematics is not None
    joint = next((j for j in kinematics.joints if j.name == name), None)
    if joint is None:
        known = did_you_mean(name, (str(j.name) for j in kinematics.joints), "the joints")
        raise KeyError(f"no joint is named {name!r}: {known}")
    tolerances = design.assembly.tolerances
    evidence = _evidence(design, joint)
    roles = _roles(design, joint, evidence)
    values = joint.singular_values
    free = values[values < tolerances.free]
    held = values[values >= tolerances.free]
    alternatives, tried, remark = _alternatives(design, joint, evidence)
    return Insight(
        joint=joint,
        patches=roles,
        rows=sum(role.rows for role in roles if role.role != "ignored"),
        samples=0 if evidence is None else len(evidence.rows),
        last_free=float(free.max()) if len(free) else None,
        first_held=float(held.min()) if len(held) else None,
        free=tolerances.free,
        held=tolerances.held,
        alternatives=alternatives,
        tried=tried,
        remark=remark,
    )


def patches_between(design: DesignView, first: str, second: str) -> list[Member]:
    """The patches between two bodies."""
    assert design.kinematics is not None
    of_part = body_of_part(design.kinematics.bodies)
    patches = () if design.contacts is None else design.contacts.patches
    sides = [tuple(of_part[part] for part in patch.parts) for patch in patches]
    return [(k, p, sides[k][0] != first) for k, p in enumerate(patches) if set(sides[k]) == {first, second}]


def _evidence(design: DesignView, joint: Joint, without: frozenset[int] = frozenset()) -> Evidence | None:
    assert design.kinematics is not None
    members = [member for member in patches_between(design, *joint.bodies) if member[0] not in without]
    if not members or design.contacts is None:
        return None
    bodies = [body for body in design.kinematics.bodies if body.name in joint.bodies]
    return evidence_between(members, bodies, design.assembly, design.contacts, Extents(design.assembly))


def _roles(design: DesignView, joint: Joint, evidence: Evidence | None) -> tuple[PatchRole, ...]:
    assert design.kinematics is not None
    rows = np.bincount(design.kinematics.matrix.patch, minlength=1)
    roles: dict[int, PatchUse] = dict.fromkeys(joint.patches, "carries")
    roles |= dict.fromkeys((one.patch for one in joint.at_stop), "ends")
    roles |= dict.fromkeys((blocker.patch for blocker in joint.blockers), "blocks")
    total = float(evidence.areas.sum()) if evidence is not None else 1.0
    shares = {item.index: item.area / total for item in evidence.items} if evidence is not None else {}
    out = []
    for k, patch, _ in patches_between(design, *joint.bodies):
        out.append(
            PatchRole(k, patch, roles.get(k, "ignored"), shares.get(k, 0.0), int(rows[k]) if k < len(rows) else 0)
        )
    return tuple(out)


def _alternatives(
    design: DesignView, joint: Joint, evidence: Evidence | None
) -> tuple[tuple[Alternative, ...], int, str]:
    """The joint decided again without each patch, and without what each candidate motion breaks."""
    if evidence is None:
        return (), 0, "no contact patch decides this joint"
    if len(evidence.items) > MOST_PATCHES:
        return (), 0, f"not decided again without each patch: there are {len(evidence.items)}, more than {MOST_PATCHES}"
    tolerances = design.assembly.tolerances
    sets: dict[frozenset[int], str] = {frozenset([item.index]): "" for item in evidence.items}
    wider: list[tuple[float, frozenset[int], str]] = []
    candidates = candidate_motions(evidence, tolerances.alignment)
    twists = np.array([m.twist for m in candidates]).reshape(-1, 6).T
    preserved = preserved_motions(evidence, twists)
    for k, motion in enumerate(candidates):
        broken = np.flatnonzero(~preserved[:, k])
        without = frozenset(evidence.items[i].index for i in broken)
        if 0 < len(broken) < len(evidence.items):
            wider.append((float(evidence.areas[broken].sum()), without, motion_words(motion)))
    for _, without, words in sorted(wider, key=lambda w: (w[0], sorted(w[1])))[:MOST_PATCH_SETS]:
        if not sets.get(without):
            sets[without] = words
    out, tried = [], 0
    for without, words in sorted(sets.items(), key=lambda s: (len(s[0]), sorted(s[0]))):
        rest = _evidence(design, joint, without)
        if rest is None:
            continue
        tried += 1
        decision = decide(rest, tolerances)
        form, freedoms = decision.form, decision.basis.shape[1]
        if (form.type, freedoms, decision.status) != (joint.type, joint.freedoms, joint.status):
            out.append(Alternative(tuple(sorted(without)), words, form.type, freedoms, decision.status, form.axis))
    remark = "" if len(wider) <= MOST_PATCH_SETS else "not every set of patches that holds a motion was tried"
    return _least(out), tried, remark


def _least(alternatives: Sequence[Alternative]) -> tuple[Alternative, ...]:
    """Without those that leave out more than another for the same outcome."""
    kept: list[Alternative] = []
    for item in alternatives:
        smaller = (
            other for other in kept
            if set(other.without) < set(item.without)
            and (other.type, other.freedoms, other.status) == (item.type, item.freedoms, item.status)
        )  # fmt: skip
        if next(smaller, None) is None:
            kept.append(item)
    return tuple(kept)

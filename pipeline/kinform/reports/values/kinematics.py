"""Joints, mobility and ways to come apart as JSON has them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from kinform.design import Design
from kinform.function import designers_joints, joint_as_stated, resolve_joint
from kinform.kinematics import Motions
from kinform.model.kinematics import Joint, Kinematics, Mobility, Release
from kinform.reports.freedom_phrases import freedom_text, metres
from kinform.reports.values.plain import fields

if TYPE_CHECKING:
    from kinform.consistency.comparisons.answers import Answer


def joint_values(design: Design) -> dict[str, Any]:
    """Bodies and joints, and how they come apart."""
    from kinform.consistency.comparisons.answers import answer_counts, answers

    kinematics = design.ranged or _kinematics(design)
    computed = ranged(design)
    given = answers(design)
    stated = InDesignersSense(design)
    return {
        "bodies": [fields(body, "name", "parts", "ground", "merged") for body in kinematics.bodies],
        "joints": [
            one_joint(joint, joint.name in computed) | stated.of_derived(joint.name) for joint in kinematics.joints
        ],
        "intended": [asdict(answer) | stated.of_intended(answer.name) for answer in given],
        "answers": dict(answer_counts(one.answer for one in given)) | {"share_undecided": _share(given)},
        "sides": [asdict(one) for one in kinematics.sides],
        "asides": [asdict(aside) for aside in kinematics.asides],
        "mobility": mobility_counts(kinematics.mobility),
        "separations": [
            fields(item, "bodies", "contacts") | {"releases": [release(way) for way in item.releases]}
            for item in kinematics.separations
        ],
        "separations_reason": kinematics.separations_reason or None,
        "slides": [
            fields(item, "bodies") | {"releases": [release(way) for way in item.releases]} for item in kinematics.slides
        ],
    }


class InDesignersSense:
    """Derived joints in the designer's names, order and sense."""

    def __init__(self, design: Design):
        assembly, kinematics, computed = design.assembly, design.ranged or _kinematics(design), ranged(design)
        self._named = {name: one.name for name, one in designers_joints(assembly, kinematics).items()}
        self._found = {}
        for intended in assembly.function.joints:
            joint = joint_as_stated(resolve_joint(assembly, kinematics, intended.name))
            if joint is not None:
                limits = _limits(joint) if joint.name in computed else None
                self._found[intended.name] = {"bodies": joint.bodies, "axis": joint.axis, "range": limits}

    def of_intended(self, name: str) -> dict[str, Any]:
        """What was found for an intended joint; nulls where nothing was."""
        found = self._found.get(name, {})
        return {f"found_{key}": found.get(key) for key in ("axis", "range")}

    def of_derived(self, name: str) -> dict[str, Any]:
        """What the designer calls a derived joint, and how it reads then; nulls where it has no name."""
        intended = self._named.get(name)
        found = {} if intended is None else self._found[intended]
        return {"intended_name": intended} | {f"intended_{key}": found.get(key) for key in ("bodies", "axis", "range")}


def _share(given: Sequence[Answer]) -> float | None:
    """Of the undecided among the answers; null without any."""
    return sum(one.answer == "undecided" for one in given) / len(given) if given else None


def body_values(design: Design) -> dict[str, Any]:
    """Bodies, and why each part is in its own where that follows from the function. Joints left out are null where
    nobody looked for them, in results of an older version."""
    kinematics = _kinematics(design)
    return {
        "bodies": [fields(body, "name", "parts", "ground", "merged") for body in kinematics.bodies],
        "membership": [asdict(one) for one in kinematics.membership],
        "unparted": [asdict(one) for one in kinematics.unparted],
        "left_out": None if kinematics.left_out is None else [asdict(one) for one in kinematics.left_out],
    }


def ranged(design: Design) -> set[str]:
    """Names of the joints whose range has been computed."""
    run = design.simulation
    return set() if run is None or run.ranges is None else {item.joint for item in run.ranges}


def one_joint(joint: Joint, computed: bool) -> dict[str, Any]:
    """Its range is null as long as it has not been computed: one that was computed and is not known says so."""
    of_blocker = ("parts", "patch", "area", "share", "place", "gap", "forbids")
    return {
        **fields(joint, "name", "bodies", "type", "axis", "point"),
        **({"axis2": joint.axis2} if joint.type == "universal" else {}),
        **fields(joint, "pitch", "freedoms"),
        **({"twists": joint.twists} if joint.type == "general" else {}),
        **fields(joint, "evidence", "status", "reason", "motion"),
        "range": _limits(joint) if computed else None,
        "patches": joint.patches,
        "blocked_by": [fields(blocker, *of_blocker) for blocker in joint.blockers],
        "readings": [
            fields(one, "type", "axis", "point", "pitch", "freedoms", "cause", "words") for one in joint.readings
        ],
        **fields(joint, "at_rest", "closed", "open"),
        "at_stop": [fields(one, "parts", "patch", "area", "place", "sense", "ends") for one in joint.at_stop],
        **fields(joint, "axis_uncertainty", "point_uncertainty"),
        "singular_values": joint.singular_values,
        **fields(joint, "held", "held_reason", "extremes"),
        "releases": [release(way) for way in joint.releases],
    }


def _limits(joint: Joint) -> dict[str, Any]:
    return {"lower": joint.range_lower, "upper": joint.range_upper, "status": joint.range_status}


def release(way: Release) -> dict[str, Any]:
    """A way to leave, as JSON has it."""
    return fields(way, "kind", "direction", "point", "twist", "extreme", "words")


def mobility_values(design: Design) -> dict[str, Any]:
    """Counts, freedoms, redundancies and couplings."""
    kinematics = _kinematics(design)
    mobility = kinematics.mobility
    return {
        **mobility_counts(mobility),
        **fields(mobility, "idle_bodies", "uncertain", "finite_reason", "infinitesimal", "singular", "on_edge"),
        "certificates": [asdict(certificate) for certificate in mobility.certificates],
        "bodies": [body.name for body in kinematics.bodies],
        "gruebler": mobility.gruebler,
        "freedoms": mobility.freedoms if len(mobility.freedoms) == mobility.instantaneous else None,
        "named": _named(kinematics),
        "redundancies": [
            fields(one, "kind", "text", "rows", "joints", "patches", "directions", "wrenches")
            for one in mobility.redundancies
        ],
        "misfit": asdict(kinematics.misfit) | {"moves": [asdict(move) for move in kinematics.moves]},
        "misaligned": [
            {"joint": joint, "angle": angle, "offset": offset} for joint, angle, offset in kinematics.misaligned
        ],
        "couplings": [asdict(coupling) for coupling in kinematics.couplings],
    }


def mobility_counts(mobility: Mobility) -> dict[str, int | None]:
    """All counts by name."""
    counts = fields(mobility, "instantaneous", "finite", "effective", "idle", "redundant")
    ends = {"low_mobility": mobility.low, "high_mobility": mobility.high}
    return counts | {"blocked_mobility": mobility.blocked, "contact_mobility": mobility.by_contact} | ends


def _named(kinematics: Kinematics) -> list[dict[str, Any]]:
    motions = Motions.of(kinematics)
    return [
        {
            "text": freedom_text(freedom, metres),
            **fields(freedom, "driver", "body", "kind", "axis", "point", "pitch", "idle", "looped"),
            "moves": list(motions.twists(freedom)),
            "drives": [{"joint": joint, "twist": twist, "rate": rate} for joint, twist, rate in freedom.drives],
        }
        for freedom in kinematics.mobility.named
    ]


def _kinematics(design: Design) -> Kinematics:
    assert design.kinematics is not None
    return design.kinematics

"""Designs that were found in a catalog."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING

from rich.console import RenderableType

from kinform.foundation.words import counted
from kinform_cli.tables import Rows
from kinform_cli.text import NONE, dumps, number

if TYPE_CHECKING:
    from kinform.catalog import CatalogJoint, CatalogRequirement, Entry


_NUMBERS = ("mobility", "loops", "mass kg")


def render(entries: Sequence[Entry], states: Sequence[str], total: int) -> RenderableType:
    """One row a design; `states` says what has become of its results file."""
    if not entries:
        return f"none of {counted(total, 'design')} does all of this"
    rows = Rows(
        "design",
        "joints",
        *_NUMBERS,
        "size mm",
        "gate",
        "results",
        right=_NUMBERS,
        names=["design"],
        texts=["joints", "gate"],
    )
    for entry, state in zip(entries, states, strict=True):
        rows.add(
            entry.name,
            joints_in_words(entry.joints),
            str(entry.effective),
            str(entry.loops),
            number(entry.mass),
            NONE if entry.size is None else " × ".join(number(1e3 * side) for side in entry.size),
            _gate(entry),
            f"{entry.path} ({state})" if state else entry.path,
        )
    return rows


def joints_in_words(joints: Iterable[CatalogJoint]) -> str:
    """As in "2 revolute, 1 screw"; the doubtful are said to be so."""
    kinds = Counter(j.type if j.status in ("determined", "inferred") else f"{j.status} {j.type}" for j in joints)
    return ", ".join(f"{many} {kind}" for kind, many in sorted(kinds.items())) or "none"


def _gate(entry: Entry) -> str:
    if not entry.requirements:
        return entry.verdict or "not checked"
    return f"{entry.verdict or 'not checked'}, {_requirements_met(entry.requirements)}"


def _requirements_met(requirements: Sequence[CatalogRequirement]) -> str:
    open_ones = sum(r.met is None for r in requirements)
    if open_ones == len(requirements):
        return f"{counted(len(requirements), 'requirement')} not checked"
    met = f"{sum(r.met is True for r in requirements)} of {counted(len(requirements), 'requirement')} met"
    return met + (f", {open_ones} not checked" if open_ones else "")


def as_json(entries: Sequence[Entry], states: Sequence[str]) -> str:
    """The designs with everything that the catalog knows; `file` is "", "changed" or "gone". SI, radians."""
    designs = []
    for entry, state in zip(entries, states, strict=True):
        joints = [_without_ends(joint) | {"range": _range(joint)} for joint in entry.joints]
        designs.append(asdict(entry) | {"joints": joints, "file": state})
    return dumps({"schema": "kinform/catalog/1", "designs": designs})


def _without_ends(joint: CatalogJoint) -> dict[str, object]:
    ends = ("lower", "upper", "wanted_lower", "wanted_upper")
    return {key: value for key, value in asdict(joint).items() if key not in ends}


def _range(joint: CatalogJoint) -> dict[str, object]:
    """Null for an unbounded side and for one that is not known: `found` tells them apart."""
    derived = None if joint.lower is None and joint.upper is None else [joint.lower, joint.upper]
    wanted = None if joint.wanted_lower is None else [joint.wanted_lower, joint.wanted_upper]
    return {"found": derived, "intended": wanted}

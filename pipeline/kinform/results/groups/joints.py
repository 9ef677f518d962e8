"""`/joints`: bodies, joints with what carries and what blocks them, what snapping left over, and single decisions."""

from __future__ import annotations

from typing import Any

import h5py

from kinform.design import Design
from kinform.frozen import dataclass
from kinform.model.kinematics import Body, Kinematics
from kinform.results.held import HeldGroup
from kinform.results.layout import Layout, Ragged, Row, Table, Texts

LAYOUT = Layout(
    Kinematics,
    Table("bodies"),
    Table(
        "joints",
        Ragged("twists", width=6),
        Ragged("singular_values"),
        Ragged("patches"),
        Table("blockers", owner="joint"),
        Row("held", "held", "extremes", "held_reason"),
        Ragged("at_rest", width=6),
        Ragged("closed", width=6),
        Row("one_sided", "open"),
        Table("at_stop", owner="joint"),
        Row("uncertainty", "axis_uncertainty", "point_uncertainty"),
        Table("readings", owner="joint"),
        Table("releases", owner="joint", first=("kind", "direction", "point", "extreme", "words")),
    ),
    Table(
        "separations",
        Table(
            "separation_releases",
            field="releases",
            owner="separation",
            first=("kind", "direction", "point", "extreme", "words"),
        ),
    ),
    Texts("separations_reason"),
    Table(
        "slides",
        Table(
            "slide_releases", field="releases", owner="slide", first=("kind", "direction", "point", "extreme", "words")
        ),
    ),
    Table("misfit"),
    Table("moves"),
    Table("misaligned"),
    Table("asides"),
    Table("membership"),
    Table("unparted"),
    Table("left_out"),
    Table("sides"),
    Table("couplings", Table("meshings", field="meshing", owner="coupling")),
)
"""The matrix and the mobility have groups of their own."""


@dataclass(frozen=True)
class _Decision:
    key: str
    decision: str
    seal: str


@dataclass(frozen=True)
class _Decisions:
    """Answers to questions about single pairs, bodies and loops, packed, by the hash of all that decides them."""

    decisions: tuple[_Decision, ...]


DECISIONS = Layout(_Decisions, Table("decisions"))


def write(group: h5py.Group, design: Design) -> None:
    """Write bodies and joints, and the decisions that they were made of."""
    LAYOUT.write(group, design.kinematics)
    decisions = design.fingerprints.decisions
    if decisions:
        DECISIONS.write(group, _Decisions(tuple(_Decision(key, *kept) for key, kept in sorted(decisions.items()))))


def read(group: HeldGroup) -> dict[str, Any]:
    """The fields of Kinematics that `write` wrote. Files of older versions do not say which joints were left out."""
    fields = LAYOUT.read_fields(group)
    return fields if "left_out" in group else fields | {"left_out": None}


def read_bodies(group: HeldGroup) -> tuple[Body, ...]:
    """The bodies alone."""
    bodies: tuple[Body, ...] = Layout(Kinematics, Table("bodies")).read_fields(group)["bodies"]
    return bodies


def read_decisions(group: HeldGroup) -> dict[str, tuple[str, str]]:
    """Packed answers and their seals, by the hash of the question."""
    if "decisions" not in group:
        return {}
    return {item.key: (item.decision, item.seal) for item in DECISIONS.read(group).decisions}

"""How sure the answer of a decision is: suspects in the order of a table, and what becomes of the joint without them.

A doubtful answer is `ambiguous`, never silently one or the other. `PRECEDENCE` has all that may make it so: generators
of suspects (`suspects`), each with the test of the reading that is kept if they are right. The first that is confirmed
is the answer.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import cast

import numpy as np

from kinform.foundation.words import counted
from kinform.frozen import dataclass
from kinform.kinematics.joints.pair.coarse_flats import flats_of_rings, prisms, torn_flats, without_turns
from kinform.kinematics.joints.pair.freedoms import freedoms
from kinform.kinematics.joints.pair.one_sided import (
    at_end_of_guide,
    ends,
    ends_one_motion,
    lets_turn,
    seats,
    several_ways,
    turns_ended,
)
from kinform.kinematics.joints.pair.preserved import preserved_motions
from kinform.kinematics.joints.pair.scraps import flanks, is_scrap, slivers
from kinform.kinematics.joints.pair.slots import is_slot, pins
from kinform.kinematics.joints.pair.strays import bends, points_apart, strays, without_bends
from kinform.kinematics.joints.pair.suspects import ROLES, AtRest, OtherReading, Suspect
from kinform.kinematics.joints.pair.uncertainty import (
    near_axes,
    scattered_facets,
    unknown_contact,
    unknown_facets,
    vague_axes,
    weak_rows,
)
from kinform.model.arrays import Array, Flags
from kinform.model.kinematics import JointStatus, ReadingCause

MISSED_AXES = 0.5
"""Axes that miss each other by less than this share of the contact tolerance are meant to be one. Chosen, not
measured."""
TILTED_AXES = 4.0
"""So are axes within this many times the alignment. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class Certainty:
    """How sure an answer is, why, and what else it may be."""

    status: JointStatus
    reason: str
    other: OtherReading | None = None


Freedoms = Callable[[AtRest, Suspect, Array, Array], Array | None]
"""The freedoms (6, k) of the pair if suspects are right, of those (6, m) that the rest leaves and what is new among
them (6, n); None where they are no such suspects."""


@dataclass(frozen=True, eq=False)
class Case:
    """A line of the table."""

    suspects: Callable[[AtRest], Iterator[Suspect]]
    freedoms: Freedoms | None = None
    """Of roles whose reading is kept."""
    unless: tuple[Case, ...] = ()
    """Cases that explain the same contact."""


def _whatever(pair: AtRest, of: Suspect, free: Array, freed: Array) -> Array | None:
    """All that the rest leaves."""
    return free


SEAT = Case(seats, ends_one_motion)
PIN = Case(pins, is_slot, unless=(SEAT,))
PRECEDENCE = (
    Case(unknown_contact),
    Case(weak_rows),
    Case(points_apart),
    Case(unknown_facets, unless=(SEAT, PIN)),
    Case(scattered_facets, unless=(SEAT, PIN)),
    Case(strays, unless=(SEAT,)),
    Case(near_axes),
    Case(torn_flats),
    Case(vague_axes),
    Case(flats_of_rings),
    Case(prisms, without_turns),
    Case(bends, without_bends),
    SEAT,
    PIN,
    Case(flanks, _whatever),
    Case(slivers, is_scrap),
    Case(ends, at_end_of_guide),
    Case(turns_ended, lets_turn),
    Case(several_ways),
)
"""What comes first decides: what makes the joint unknown before what leaves it two readings."""


def certainty(pair: AtRest) -> Certainty:
    """How sure the freedoms at rest are."""
    for case in PRECEDENCE:
        found = _found(pair, case)
        if found is not None and all(_found(pair, other) is None for other in case.unless):
            return found
    weakest = f"; the weakest constraint has singular value {pair.values[pair.count]:.2g}" if pair.count < 6 else ""
    return Certainty("determined", f"the contact leaves {counted(pair.count, 'freedom')}{weakest}")


def _found(pair: AtRest, case: Case) -> Certainty | None:
    """What the first suspects of a case that are right make of the answer."""
    for one in case.suspects(pair):
        found = _doubt(pair, one) if case.freedoms is None else _readings(pair, one, case.freedoms)
        if found is not None:
            return found
    return None


def _doubt(pair: AtRest, of: Suspect) -> Certainty | None:
    """That the answer is in doubt, if it is."""
    words = of.words
    if of.role == "widen":
        left = _left_if_wide(pair, of)
        words += f": as one axis they would leave {left} of 6 freedoms"
        return Certainty("ambiguous", words) if left > pair.count else None
    certain = of.role == "drop" and not pair.freed(_others(pair, of))[1].shape[1]
    return None if certain else Certainty("ambiguous", words)


def _readings(pair: AtRest, of: Suspect, freedoms_if: Freedoms) -> Certainty | None:
    """Both readings, if there are two."""
    holds_more = of.role in ("prism", "bend")
    free, freed = (pair.basis, pair.basis) if holds_more else pair.freed(_others(pair, of))
    basis = freedoms_if(pair, of, free, freed) if freed.shape[1] else None
    if basis is None:
        return None
    first, form = pair.form.type, pair.evidence.form(basis)
    if of.role == "bend":
        words = of.words
    elif of.role == "prism":
        words = f"{first} if {of.words}; {form.type} if they are {ROLES[of.role]}: a stated joint tells"
    else:
        words = f"{first} if {_faces_in_words(pair, of)} holds; {form.type} if it is {ROLES[of.role]}"
    out = () if holds_more else of.items
    return Certainty("ambiguous", words, OtherReading(form, basis, out, cast(ReadingCause, of.role)))


def _others(pair: AtRest, of: Suspect) -> Flags:
    """(items,) all but the suspects."""
    keep = np.ones(len(pair.evidence.items), dtype=bool)
    keep[list(of.items)] = False
    return keep


def _left_if_wide(pair: AtRest, of: Suspect) -> int:
    """How many freedoms are left if axes that miss each other by little are one."""
    evidence, wide = pair.evidence, ~_others(pair, of)
    widened = replace(
        evidence,
        angle=np.where(wide, np.maximum(evidence.angle, TILTED_AXES * pair.tolerances.alignment), evidence.angle),
        position=evidence.position + np.where(wide, MISSED_AXES * evidence.contact, 0.0),
    )
    preserved = preserved_motions(widened, pair.twists)
    basis, _ = freedoms(widened, pair.twists, preserved, np.ones(len(wide), dtype=bool), pair.tolerances)
    return int(basis.shape[1])


def _faces_in_words(pair: AtRest, of: Suspect) -> str:
    """Patches in words: "the plane of 12.5 mm² between base and rod"."""
    items = [pair.evidence.items[k] for k in of.items]
    area = 1e6 * sum(item.patch.area for item in items)
    largest = max(items, key=lambda item: (item.patch.area, item.patch.parts))
    kinds = largest.patch.kind if len(items) == 1 else f"{largest.patch.kind} (in {len(items)} pieces)"
    return f"the {kinds} of {area:.3g} mm² between {' and '.join(largest.patch.parts)}"

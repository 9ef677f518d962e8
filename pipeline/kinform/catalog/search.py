"""Finds designs by what they do."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from kinform.catalog.build import digest_of
from kinform.catalog.entry import CatalogJoint, Entry
from kinform.catalog.store import entry_from, open_catalog
from kinform.foundation.rounding import SINGLE
from kinform.frozen import dataclass

MOST_ALIKE = 20
"""Designs that are named as like another one; a choice."""
LOOKED_AT = 120
"""Designs of the same graph and mobility, those of the nearest size, whose axes are compared: 0.05 s. A choice."""


JOINT_TYPES = (
    "fixed", "revolute", "prismatic", "cylindrical", "spherical", "planar", "screw", "universal", "general",
)  # fmt: skip
_COUNTED = re.compile(r"(?P<type>[a-z]+)(?::(?P<count>\d+)(?P<more>\+?))?")


@dataclass(frozen=True)
class Wanted:
    """What is asked of a design; None and empty: anything. kg, m."""

    joints: tuple[tuple[str, int, int | None], ...] = ()
    """(type, at least, at most or None)."""
    joint_count: int | None = None
    mobility: int | None = None
    """Effective."""
    instantaneous: int | None = None
    loops: int | None = None
    least_mass: float | None = None
    greatest_mass: float | None = None
    greatest_size: float | None = None
    """Longest side of the box around it."""
    text: tuple[str, ...] = ()
    """Each in the name of the design, of its file, of a part, or of an intended joint; case does not matter."""
    meets: tuple[str, ...] = ()
    """Kinds or names of requirements that are met."""
    verified: bool = False


def joint_count(text: str) -> tuple[str, int, int | None]:
    """(type, at least, at most) of "revolute" (one or more), "revolute:2" (two), "revolute:2+" (two or more).

    Raises ValueError that says what is wrong.
    """
    match = _COUNTED.fullmatch(text.strip().lower())
    if match is None:
        raise ValueError(f"{text!r} is not a joint type, nor TYPE:COUNT as in revolute:2 or revolute:2+")
    if match["type"] not in JOINT_TYPES:
        raise ValueError(f"{match['type']!r} is no joint type: expected one of {', '.join(JOINT_TYPES)}")
    if match["count"] is None:
        return match["type"], 1, None
    count = int(match["count"])
    return match["type"], count, None if match["more"] else count


def find(path: str | Path, wanted: Wanted) -> tuple[tuple[Entry, ...], int]:
    """The designs of the catalog at `path` that do what is wanted, sorted by name and file, and how many it has.

    What is not known of a design (a mass without densities, a requirement that nobody checked) never matches.
    Raises InputError where there is no catalog.
    """
    conditions, values = _conditions(wanted)
    where = f" WHERE {' AND '.join(conditions)}" if conditions else ""
    with open_catalog(path) as database:
        rows = database.execute(f"SELECT * FROM designs{where} ORDER BY name, path", values).fetchall()
        total = database.execute("SELECT count(*) FROM designs").fetchone()[0]
        return tuple(entry_from(database, row) for row in rows), int(total)


def like(path: str | Path, entry: Entry, most: int = MOST_ALIKE) -> tuple[tuple[tuple[float, Entry], ...], int]:
    """The designs of the catalog at `path` that do the same as this one, with how far each is from it, the nearest
    first; and how many designs it has.

    The same: graph of bodies and joints with their types, and mobility. The distance is `distance`; beyond
    the nearest `most` none are given. Raises InputError where there is no catalog.
    """
    with open_catalog(path) as database:
        rows = database.execute(
            "SELECT * FROM designs WHERE graph = ? AND effective = ? ORDER BY path", (entry.graph, entry.effective)
        ).fetchall()
        total = database.execute("SELECT count(*) FROM designs").fetchone()[0]
        size = _extent(entry)
        near = sorted(rows, key=lambda row: (_ratio(size, _row_extent(row)), row["path"]))[:LOOKED_AT]
        found = [(distance(entry, other), other) for other in (entry_from(database, row) for row in near)]
        found.sort(key=lambda pair: (pair[0], pair[1].path))
        return tuple(found[:most]), int(total)


def distance(first: Entry, second: Entry) -> float:
    """How far two designs of the same graph are from each other: the mean difference of the angles (in quarter turns)
    and of the distances (in sizes of the design) between the axes of all pairs of joints, plus the logarithm to base 2
    of the ratio of their sizes. 0 for copies, however they are placed and turned; infinite where joints differ."""
    one, other = _axes(first), _axes(second)
    if [pair[0] for pair in one] != [pair[0] for pair in other]:
        return math.inf
    apart = [abs(a[1] - b[1]) + abs(a[2] - b[2]) for a, b in zip(one, other, strict=True)]
    return (sum(apart) / len(apart) if apart else 0.0) + _ratio(_extent(first), _extent(second))


def _axes(entry: Entry) -> list[tuple[tuple[str, str], float, float]]:
    """Of all pairs of joints that have axes: types, angle, distance; sorted."""
    size = _extent(entry) or 1.0
    out = []
    with_axes = [joint for joint in entry.joints if joint.axis is not None]
    for k, a in enumerate(with_axes):
        for b in with_axes[:k]:
            assert a.axis is not None and b.axis is not None
            kinds = (a.type, b.type) if a.type <= b.type else (b.type, a.type)
            turn, gap = _between(a, b)
            out.append((kinds, round(turn, 6), round(gap / size, 6)))
    return sorted(out)


def _between(a: CatalogJoint, b: CatalogJoint) -> tuple[float, float]:
    """Angle (quarter turns) between the axes of two joints, and the distance (m) of the lines that they are on; 0 where
    one has no place, as one that slides."""
    u, v = np.array(a.axis), np.array(b.axis)
    across = np.cross(u, v)
    sine = float(np.linalg.norm(across))
    turn = math.atan2(sine, abs(float(u @ v))) / (math.pi / 2.0)
    if a.point is None or b.point is None or "prismatic" in (a.type, b.type):
        return turn, 0.0
    apart = np.array(b.point) - np.array(a.point)
    if sine > SINGLE:
        return turn, abs(float(apart @ across)) / sine
    return turn, float(np.linalg.norm(np.cross(u, apart)))


def _extent(entry: Entry) -> float:
    """Diagonal of the box around it (m); of one without meshes around the points of its joints."""
    if entry.size is not None:
        return math.hypot(*entry.size)
    points = [joint.point for joint in entry.joints if joint.point is not None]
    return math.hypot(*np.ptp(np.array(points), axis=0)) if points else 0.0


def _row_extent(row: Any) -> float:
    return 0.0 if row["size_x"] is None else math.hypot(row["size_x"], row["size_y"], row["size_z"])


def _ratio(first: float, second: float) -> float:
    """Logarithm to base 2 of the ratio of two sizes; 0 where neither has one, else infinite."""
    if first <= 0.0 or second <= 0.0:
        return 0.0 if first == second else math.inf
    return abs(math.log2(first / second))


def source_state(entry: Entry, folder: str | Path) -> str:
    """What has become of the results file since: "", "changed" or "gone"; `folder` is that of the catalog."""
    path = Path(folder) / entry.path
    try:
        return "" if digest_of(path) == entry.digest else "changed"
    except OSError:
        return "gone"


def _conditions(wanted: Wanted) -> tuple[list[str], list[object]]:
    """Conditions of SQL that all have to hold, and their parameters in order."""
    of_type = "path {}IN (SELECT design FROM kinds WHERE type = ? AND joints {})"
    conditions: list[str] = []
    values: list[object] = []

    def ask(condition: str, *parameters: object) -> None:
        conditions.append(condition)
        values.extend(parameters)

    for kind, least, most in wanted.joints:
        if most is None:
            ask(of_type.format("", ">= ?"), kind, least)
        elif most > 0:
            ask(of_type.format("", "BETWEEN ? AND ?"), kind, least, most)
        else:
            ask(of_type.format("NOT ", "> 0"), kind)
    plain: Sequence[tuple[str, object]] = (
        ("(SELECT count(*) FROM joints WHERE design = designs.path) = ?", wanted.joint_count),
        ("effective = ?", wanted.mobility),
        ("instantaneous = ?", wanted.instantaneous),
        ("loops = ?", wanted.loops),
        ("mass >= ?", wanted.least_mass),
        ("mass <= ?", wanted.greatest_mass),
        ("max(size_x, size_y, size_z) <= ?", wanted.greatest_size),
    )
    for condition, value in plain:
        if value is not None:
            ask(condition, value)
    for text in wanted.text:
        ask("path IN (SELECT design FROM texts WHERE instr(folded, ?))", text.casefold())
    for requirement in wanted.meets:
        rows = "SELECT 1 FROM requirements WHERE design = designs.path AND ? IN (kind, name)"
        ask(f"EXISTS ({rows} AND met = 1)", requirement)
        ask(f"NOT EXISTS ({rows} AND met IS NOT 1)", requirement)
    if wanted.verified:
        ask("verdict = 'verified'")
    return conditions, values

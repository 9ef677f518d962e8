"""Finds designs by what they do."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from kinform.catalog.build import digest_of
from kinform.catalog.entry import Entry
from kinform.catalog.store import entry_from, open_catalog

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


def source_state(entry: Entry, folder: str | Path) -> str:
    """What has become of the results file since: "", "changed" or "gone"; `folder` is that of the catalog."""
    path = Path(folder) / entry.path
    try:
        return "" if digest_of(path) == entry.digest else "changed"
    except OSError:
        return "gone"


def _conditions(wanted: Wanted) -> tuple[list[str], list[object]]:
    """Conditions of SQL that all have to hold, and their parameters in order."""
    joints = "(SELECT count(*) FROM joints WHERE design = designs.path{})"
    conditions: list[str] = []
    values: list[object] = []

    def ask(condition: str, *parameters: object) -> None:
        conditions.append(condition)
        values.extend(parameters)

    for kind, least, most in wanted.joints:
        ask(f"{joints.format(' AND type = ?')} >= ?", kind, least)
        if most is not None:
            ask(f"{joints.format(' AND type = ?')} <= ?", kind, most)
    plain: Sequence[tuple[str, object]] = (
        (f"{joints.format('')} = ?", wanted.joint_count),
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
        named = "EXISTS (SELECT 1 FROM {} WHERE design = designs.path AND instr(fold({}), ?))"
        where = ("instr(fold(name), ?)", "instr(fold(path), ?)", named.format("parts", "name"),
                 named.format("joints", "intended"))  # fmt: skip
        ask(f"({' OR '.join(where)})", *[text.casefold()] * len(where))
    for requirement in wanted.meets:
        rows = "SELECT 1 FROM requirements WHERE design = designs.path AND ? IN (kind, name)"
        ask(f"EXISTS ({rows} AND met = 1)", requirement)
        ask(f"NOT EXISTS ({rows} AND met IS NOT 1)", requirement)
    if wanted.verified:
        ask("verdict = 'verified'")
    return conditions, values

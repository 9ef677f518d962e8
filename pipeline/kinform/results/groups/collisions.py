"""`/simulation/ranges`, one row a side of a joint, and `/simulation/collisions`. Files without them were not asked."""

from __future__ import annotations

from typing import Any

import h5py

from kinform.model.collisions import Collision, JointRange, RangeEnd
from kinform.model.simulation import Simulation
from kinform.results.table import flag, integer, pair, read_rows, real, text, texts, vector, write_records, write_rows

__all__ = ["read", "write"]

_RANGES = (
    text("joint"), text("side"), text("status"), real("value", "rad or m"), texts("parts"), vector("place", "m"),
    text("reason"), real("leaves", "rad or m"), flag("slides"),
)  # fmt: skip
_LEFT_OUT = (integer("joint"), pair("parts", text, ("part_a", "part_b")))
_COLLISIONS = (
    pair("parts", text, ("part_a", "part_b")), real("time", "s"), vector("place", "m"), real("depth", "m"),
)  # fmt: skip
_UNCOLLIDED = (text("part_a"), text("part_b"), text("reason"))


def write(group: h5py.Group, simulation: Simulation) -> None:
    """Write what was computed of ranges and collisions."""
    if simulation.ranges is not None:
        rows = [
            vars(end) | {"joint": item.joint, "side": side, "slides": item.slides}
            for item in simulation.ranges
            for side, end in (("lower", item.lower), ("upper", item.upper))
        ]
        write_rows(group, "ranges", _RANGES, rows)
        left_out = [{"joint": n, "parts": p} for n, item in enumerate(simulation.ranges) for p in item.left_out]
        write_rows(group, "ranges_left_out", _LEFT_OUT, left_out)
    if simulation.collisions is not None:
        write_records(group, "collisions", _COLLISIONS, simulation.collisions)
    if simulation.uncollided:
        untested = [dict(zip(("part_a", "part_b", "reason"), row, strict=True)) for row in simulation.uncollided]
        write_rows(group, "collisions_unknown", _UNCOLLIDED, untested)


def read(group: h5py.Group) -> dict[str, Any]:
    """The fields of Simulation that `write` wrote."""
    out: dict[str, Any] = {}
    if "ranges" in group:
        left_out: dict[int, list[Any]] = {}
        for row in read_rows(group, "ranges_left_out", _LEFT_OUT):
            left_out.setdefault(row["joint"], []).append(row["parts"])
        rows = read_rows(group, "ranges", _RANGES)
        found = []
        for n, (lower, upper) in enumerate(zip(rows[::2], rows[1::2], strict=True)):
            name, ends = lower["joint"], []
            for row in (lower, upper):
                ends.append(
                    RangeEnd(**{key: value for key, value in row.items() if key not in ("joint", "side", "slides")})
                )
            found.append(JointRange(name, ends[0], ends[1], tuple(left_out.get(n, ())), lower["slides"]))
        out["ranges"] = tuple(found)
    if "collisions" in group:
        out["collisions"] = tuple(Collision(**row) for row in read_rows(group, "collisions", _COLLISIONS))
    if "collisions_unknown" in group:
        out["uncollided"] = tuple(tuple(row.values()) for row in read_rows(group, "collisions_unknown", _UNCOLLIDED))
    return out

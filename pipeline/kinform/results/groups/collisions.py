"""`/simulation/ranges`, one row a side of a joint, and `/simulation/collisions`. Files without them were not asked."""

from __future__ import annotations

from collections.abc import Sequence

import h5py

from kinform.frozen import dataclass
from kinform.model.collisions import JointRange, RangeEnd
from kinform.model.names import JointName
from kinform.model.simulation import Simulation
from kinform.results.held import HeldGroup
from kinform.results.layout import Layout, Rows, Table


@dataclass(frozen=True)
class _Side:
    joint: JointName
    side: str
    end: RangeEnd
    slides: bool


@dataclass(frozen=True)
class _Sides:
    ranges: tuple[_Side, ...]


class _Ranges:
    """Two rows a joint, lower and upper; the pairs that were left out in a table of their own."""

    dataset, fields = "ranges", ("ranges",)
    sides = Layout(_Sides, Table("ranges"))
    left_out = Table("ranges_left_out", field="left_out", owner="joint")

    def write(self, group: h5py.Group, cls: type, records: Sequence[Simulation]) -> None:
        ranges = records[0].ranges
        if ranges is not None:
            ends = ((item, side, getattr(item, side)) for item in ranges for side in ("lower", "upper"))
            sides = tuple(_Side(item.joint, side, end, item.slides) for item, side, end in ends)
            self.sides.write(group, _Sides(sides))
            self.left_out.write(group, JointRange, ranges)

    def read(self, group: HeldGroup, cls: type, rows: Rows) -> None:
        sides = self.sides.read(group).ranges
        pairs = zip(sides[::2], sides[1::2], strict=True)
        ranges: Rows = [
            {"joint": lower.joint, "lower": lower.end, "upper": upper.end, "slides": lower.slides}
            for lower, upper in pairs
        ]
        self.left_out.read(group, JointRange, ranges)
        rows[0]["ranges"] = tuple(JointRange(**row) for row in ranges)


COLLISIONS = (_Ranges(), Table("collisions"), Table("collisions_unknown", field="uncollided", if_any=True))
"""What holds the fields of Simulation that say what was run into."""

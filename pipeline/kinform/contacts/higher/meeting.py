"""Where two surfaces come closest: points with normals and gaps."""

from __future__ import annotations

from dataclasses import replace

from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags


@dataclass(frozen=True, eq=False)
class Meeting:
    """Points (n, 3) between two surfaces, normals (n, 3) from the second towards the first, gaps (n,) m."""

    points: Array
    normals: Array
    gaps: Array
    line: bool
    spacing: float
    clearance: float | None = None
    """m: by how much a bore or groove is wider than the ball in it, as a radius."""
    along: Array | None = None
    """(3,) of a line that is along neither axis."""
    radius: float | None = None
    """m: by which the first surface bends across it."""

    bends: bool = False
    """Whether the surfaces bend into each other there: a ring on a shaft tilts by no more than its play, while the
    normals all round leave that free."""

    def chosen(self, keep: Flags) -> Meeting:
        """Some of the points."""
        return replace(self, points=self.points[keep], normals=self.normals[keep], gaps=self.gaps[keep])

"""Every number that decides something, in one value that travels with the assembly."""

from __future__ import annotations

import math

from kinform.frozen import dataclass
from kinform.model.quantities import Metres, Radians, Ratio


@dataclass(frozen=True)
class PartSize:
    """The lengths of a part of which tolerances are shares."""

    span: Metres
    """m, between the two of its points that are farthest apart."""
    wall: Metres
    """m: its mean thickness."""


@dataclass(frozen=True)
class Tolerances:
    """Tolerances of one assembly, SI and radians. None means: derived from the geometry."""

    contact: Metres | None = None
    """Gap or overlap up to which surfaces mate (m). None: shares of the two parts, see `contact_of` and `radial_of`."""
    weld: Metres | None = None
    """Vertices closer than this are one (m). Default per mesh: 1e-6 of its diagonal."""
    alignment: Radians = math.radians(0.2)
    """Axes of one pair closer than this mate; the excess over the clearance is a finding (rad)."""

    axis_angle: Radians | None = None
    """By so much a joint's axis may differ from the intended one (rad). None: the alignment."""
    axis_offset: Metres | None = None
    """By so much a joint's axis or centre may lie beside the intended one (m). None: `offset_share` of the bodies."""
    offset_share: Ratio = 5e-3
    """The same, as a share of the smaller body's diagonal."""

    smooth_edge: Radians = math.radians(32.0)
    """Dihedral below which an edge is smooth: a 12-gon is a cylinder, an 8-gon stays a prism (rad)."""
    fit: Ratio = 2e-5
    """Distance of vertices from their surface, relative to the span of the part, between its points farthest apart."""
    coplanar: Radians = 5e-4
    """Dihedral below which facets are one plane (rad)."""

    contact_share: Ratio = 0.035
    """Share of the smaller part's span that bounds the default contact tolerance. On 38 robots with groups 134 joints
    come out right with this and `contact_large`, 127 with 0.029 and 0.007, none wrong with either."""
    contact_large: Ratio = 0.0085
    """The same of the larger part's span."""
    contact_wall: Ratio = 0.2
    """The same of the thinner part's wall, but for round surfaces."""
    opposed: Ratio = -0.3
    """A hit counts when the dot product of the two outward facet normals is below this."""

    resolved: Ratio = 2e-4
    """Resolution of a mesh file, relative to the part's diagonal, beyond which the file has lost the shape."""

    held: Ratio = 2e-3
    """Singular values above this are constraints."""
    free: Ratio = 1e-4
    """Singular values below this are freedoms; between free and held the answer is ambiguous."""

    def contact_of(self, first: PartSize, second: PartSize) -> float:
        """Contact tolerance of a pair of parts of these sizes (m)."""
        if self.contact is not None:
            return self.contact
        return min(self.radial_of(first, second), self.contact_wall * min(first.wall, second.wall))

    def widest(self, size: PartSize) -> float:
        """Contact tolerance of a part of this size with any other, at most (m)."""
        if self.contact is not None:
            return self.contact
        return min(self.contact_share * size.span, self.contact_wall * size.wall)

    def radial_of(self, first: PartSize, second: PartSize) -> float:
        """Play of round surfaces of parts of these sizes (m): the wall behind a bore does not bound it."""
        if self.contact is not None:
            return self.contact
        small, large = sorted((first.span, second.span))
        return min(self.contact_share * small, self.contact_large * large)

    def angle_limit(self) -> float:
        """By so much a joint's axis may differ from the intended one (rad)."""
        return self.alignment if self.axis_angle is None else self.axis_angle

    def offset_limit(self, diagonal: float) -> float:
        """By so much a joint's axis may lie beside the intended one (m); `diagonal` (m) of the smaller body."""
        return self.offset_share * diagonal if self.axis_offset is None else self.axis_offset

    def weld_of(self, diagonal: float) -> float:
        """Welding distance of a mesh with this diagonal (m)."""
        return self.weld if self.weld is not None else 1e-6 * diagonal

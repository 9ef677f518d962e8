"""Every number that decides something, in one value that travels with the assembly."""

from __future__ import annotations

import math
from dataclasses import dataclass

from kinform.model.quantities import Metres, Radians, Ratio

DEGREE = math.pi / 180.0


@dataclass(frozen=True)
class Tolerances:
    """Tolerances of one assembly, SI and radians. None means: derived from the geometry."""

    contact: Metres | None = None
    """Gap or overlap up to which surfaces mate (m). Default a pair: min(0.5 mm, 3 % of the smaller part)."""
    weld: Metres | None = None
    """Vertices closer than this are one (m). Default per mesh: 1e-6 of its diagonal."""
    alignment: Radians = 0.2 * DEGREE
    """Axes of one pair closer than this mate; the excess over the clearance is a finding (rad)."""

    smooth_edge: Radians = 32.0 * DEGREE
    """Dihedral below which an edge is smooth: a 12-gon is a cylinder, an 8-gon stays a prism (rad)."""
    fit: Ratio = 2e-5
    """Distance of vertices from their surface, relative to the part's diagonal."""
    coplanar: Radians = 5e-4
    """Dihedral below which facets are one plane (rad)."""

    contact_cap: Metres = 5e-4
    """Upper bound of the default contact tolerance (m)."""
    contact_share: Ratio = 0.03
    """Share of the smaller part's diagonal that bounds the default contact tolerance."""
    opposed: Ratio = -0.3
    """A hit counts when the dot product of the two outward facet normals is below this."""

    resolved: Ratio = 2e-4
    """Resolution of a mesh file, relative to the part's diagonal, beyond which the file has lost the shape."""

    held: Ratio = 2e-3
    """Singular values above this are constraints."""
    free: Ratio = 1e-4
    """Singular values below this are freedoms; between free and held the answer is ambiguous."""

    def contact_of(self, diagonal_a: float, diagonal_b: float) -> float:
        """Contact tolerance of a pair of parts with these diagonals (m)."""
        if self.contact is not None:
            return self.contact
        return min(self.contact_cap, self.contact_share * min(diagonal_a, diagonal_b))

    def weld_of(self, diagonal: float) -> float:
        """Welding distance of a mesh with this diagonal (m)."""
        return self.weld if self.weld is not None else 1e-6 * diagonal

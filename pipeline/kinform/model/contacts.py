"""Where parts touch: patches between analytic surfaces, and overlaps between solids. World frame, SI."""

from __future__ import annotations

from typing import Annotated, Literal

from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.names import PartName
from kinform.model.quantities import Direction, Lead, Metres, PartPair, Place, Radians, SquareMetres, columns
from kinform.model.surfaces import SurfaceKind

PatchKind = Literal[SurfaceKind, "other", "point", "line"]
"""The kind of the analytic surfaces that gave the normals. torus, revolution, extrusion: of facets, so that the common
rotation or translation stays free; helicoid: of the profile, so that the common screw does. other: planes that touch
askew; freeform: normals of facets; point and line: higher pairs."""
Fit = Literal["clearance", "touch", "transition", "interference"]
"""Beyond chordal deviation and uncertainty."""
OverlapMethod = Literal["manifold", "facets"]
"""manifold: by the solid that both share. facets: by points on facets, where a mesh is open."""
SuggestionKind = Literal["holes", "pressed", "pocket", "spigot", "rim", "bolt circle"]
"""holes, pressed or pocket: one body. spigot: holes line up round a journal, which a flange has, and a joint in one of
its poses. rim or bolt circle: an axis of a contact of planes alone."""
Confidence = Literal["fair", "low"]
"""low: a nominal overlap may be a journal drawn too large, and rims lie beside true axes too."""


@dataclass(frozen=True, eq=False)
class Patch:
    """Contact between a surface of part a and a surface of part b (a < b by name).

    `normals` come from the analytic surface, unit, pointing out of a's material (into b).
    """

    parts: PartPair
    surfaces: Annotated[tuple[int, int], columns("surface_a", "surface_b")]
    """Index of the surface in each part's MeshSurfaces."""
    kind: PatchKind
    one_sided: bool
    """True: analytic on one side, facets of no known surface on the other."""
    points: Array
    """(n, 3) m, samples on the patch."""
    normals: Array
    """(n, 3)."""
    gaps: Array
    """(n,) m, signed: negative is overlap."""
    weights: Array
    """(n,) m², area that each sample stands for; their sum is `area`."""
    area: SquareMetres
    gap: Metres
    """m: area-weighted mean of `gaps`; for coaxial surfaces the difference of radii."""
    axis: Direction
    """(3,) plane normal out of a, or the common axis; zero for spheres."""
    point: Place
    """(3,) on the plane, on the axis, or the centre."""
    radii: Annotated[tuple[float, float], "m (cones: rad)", columns("radius_a", "radius_b")]
    """Radius on a and b (half-angle for cones); 0 for planes."""
    misalignment: Radians
    """rad between the two axes (0 for spheres)."""
    offset: Metres
    """m between the two axes at the patch, or between the centres."""
    uncertainty: Annotated[tuple[float, float], "rad, m", columns("axis_uncertainty", "point_uncertainty")]
    """Of the direction (rad) and of the position (m) of the common geometry, from both fits."""
    chord: Metres
    """m: sum of the chord errors of both surfaces."""
    fit: Fit
    pitch: Lead = 0.0
    """m a turn that two helicoids have in common, right-handed positive; 0 for other kinds."""
    tolerance: Metres = 0.0
    """m: gap or overlap up to which these two surfaces mate; 0: that of the pair."""
    mismatch: Annotated[tuple[float, float], "rad, m", columns("misalignment_uncertainty", "offset_uncertainty")] = (
        0.0,
        0.0,
    )
    """Standard uncertainties of `misalignment` and `offset`: those of both fits together."""
    sides: int = 0
    """Flats of the prism that this cylinder may be as well, or of the coarse cylinder that this plane may be one of;
    else 0."""
    narrow: bool = False
    """True: the overlap is narrower than the lenses that two outlines of facets make of one edge, so that it is not
    known whether these faces touch. Found beside other patches only."""
    flat: bool = False
    """True: a point or a line on a plane, that of one of the two surfaces."""
    bends: bool = False
    """True: a line along which the surfaces bend into each other, and which holds more than its normals say: a roller
    in its ring does not turn about the normal of their line, a ring on its shaft does not tilt, by more than its
    play. Or a ball in a bowl, several of which do."""
    unknown: bool = False
    """True: the parts come this near, and no kind of contact that is known says how they touch: a point where they are
    nearest. Found where nothing else is. It holds nothing for sure, and says that nothing is free for sure."""


@dataclass(frozen=True, eq=False)
class Interference:
    """Solids of two parts overlap beyond the chord errors of their surfaces."""

    parts: PartPair
    volume: Annotated[float, "m³"]
    """m³, by manifold3d; nan where a mesh is not manifold."""
    depth: Metres
    """m: greatest overlap measured."""
    place: Place
    """(3,) m: centroid of the overlap."""
    mated: bool
    """True: all of it lies at mating patches within the contact tolerance, and can be pressed (a press fit)."""
    method: OverlapMethod


@dataclass(frozen=True, eq=False)
class Suggestion:
    """What the geometry hints at and does not prove: that two parts are one body, or turn about an axis."""

    parts: PartPair
    kind: SuggestionKind
    evidence: str
    axis: Direction
    """(3,) of the holes, of the fit, out of the pocket, or of the joint."""
    point: Place
    """(3,) m."""

    @property
    def fastens(self) -> bool:
        """Whether it says that the parts are one body."""
        return self.kind in ("holes", "pressed", "pocket")

    @property
    def confidence(self) -> Confidence:
        """How far the kind of evidence can be trusted."""
        return "fair" if self.kind in ("holes", "pocket") else "low"


@dataclass(frozen=True, eq=False)
class Contacts:
    """All contacts of an assembly."""

    patches: tuple[Patch, ...]
    """Sorted by part names, then surface indices."""
    interferences: tuple[Interference, ...]
    """Of pairs that overlap for sure."""
    candidates: tuple[tuple[PartName, PartName], ...]
    """Pairs that the broad phase kept, sorted."""
    tolerance: dict[tuple[PartName, PartName], float]
    """Contact tolerance used for each candidate pair (m)."""
    suggestions: tuple[Suggestion, ...] = ()
    """Sorted by part names, then kind. Nothing follows from them unless `[fasteners] infer` is set."""
    possible_overlaps: tuple[Interference, ...] = ()
    """Of pairs that overlap no deeper than the coarse facets about it may stand off the surfaces that they stand for:
    it is not known whether these overlap. None of a pair that does for sure."""

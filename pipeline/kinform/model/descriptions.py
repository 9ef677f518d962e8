"""What a robot description says, as it stands in its file: what rules hold against geometry, and what is written back.

SI and radians. The frame F of a description is that of its root link or of its world; for a description that is placed
as a sub-assembly, names have its prefix and poses are in the world.
"""

from __future__ import annotations

from dataclasses import field
from typing import Annotated, Literal

from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.quantities import MATRIX, Direction, JointValue, Metres, Place, Ratio, columns

DescriptionFormat = Literal["urdf", "sdf", "mjcf", ""]
"""Of the text of a description; "" where there is none that can be written back."""
SIX = columns("*_xx", "*_yy", "*_zz", "*_xy", "*_xz", "*_yz")
"""The numbers of an inertia, in the order of URDF."""


@dataclass(frozen=True, eq=False)
class StatedMass:
    """The inertial of a link, in the numbers of the file."""

    value: Annotated[float, "kg"]
    """As stated, also where no body can have it."""
    inertia: Annotated[Array, "kg·m²", SIX] | None
    """(6,) in the axes of the inertial's frame; None where the file states none."""
    line: int


@dataclass(frozen=True, eq=False)
class Coverage:
    """The collision geometry of a link beside its visual geometry, by the convex hulls of its pieces."""

    uncovered: Metres
    """How far the visual reaches out of the collision geometry, at least."""
    uncovered_share: Ratio
    """Share of the visual's area that is outside by more than a share of the link's size."""
    beyond: Metres
    """How far the collision geometry reaches out of the hull of the visual, at least."""
    size: Metres
    """Of the visual: the diagonal of its box."""
    collision_size: Metres
    """Of the collision geometry."""


@dataclass(frozen=True, eq=False)
class DescribedLink:
    """A link as it is described."""

    name: str
    file: str
    line: int
    rotation: Annotated[Array, "1", MATRIX]
    """(3, 3) R_WL of the frame L of the link."""
    position: Place
    """(3,) p_WL."""
    parts: tuple[str, ...]
    """Its geometry, as parts; a stick body where there is none."""
    visuals: int
    """Pieces of visual geometry."""
    collisions: int
    """Pieces of collision geometry."""
    stated: StatedMass | None = None
    coverage: Coverage | None = None
    """None where it has not both kinds of geometry, or where both are the same."""


@dataclass(frozen=True, eq=False)
class DescribedJoint:
    """A joint as it is described."""

    name: str
    file: str
    line: int
    kind: str
    """As the format calls its type."""
    between: Annotated[tuple[str, str], columns("parent", "child")]
    axis: Direction | None
    """(3,) in the world, as stated."""
    point: Place | None
    """(3,) m in the world, as stated."""
    needs_limits: bool
    """Whether the format wants limits of this type of joint."""
    limits: Annotated[tuple[float, float], "rad or m", columns("lower", "upper")] | None
    """As stated, also where they are not ascending; None where nothing is stated."""
    effort: Annotated[float, "N·m or N"] | None
    """As stated, also zero."""
    speed: Annotated[float, "rad/s or m/s"] | None
    degrees: bool = False
    """Whether the file has the limits in degrees."""
    offset: Annotated[float, "rad or m"] = 0.0
    """Value of the joint where the one that it mimics is at zero."""

    @property
    def span(self) -> JointValue:
        """Between the limits; negative where they are exchanged."""
        return 0.0 if self.limits is None else self.limits[1] - self.limits[0]


@dataclass(frozen=True)
class LooseMesh:
    """A mesh file of a description that is not where it is said to be, or that nothing says."""

    path: str
    file: str
    line: int
    missing: bool
    """It is named, and not there; else it is there, and not named."""
    link: str = ""
    """That names it; "" where none does."""
    left_out: bool = False
    """It would be a part of that link, which stands without it; else it is of the geometry that is not read."""


@dataclass(frozen=True, eq=False)
class StartOverlap:
    """Collision geometry of two links that overlaps in the pose of the file, where no joint joins them."""

    links: Annotated[tuple[str, str], columns("link_a", "link_b")]
    """Sorted."""
    depth: Metres
    """Of their pieces that are deepest in each other: of convex ones how far they must move to part, of others no more
    than the overlap is thick."""
    volume: Annotated[float, "m³"]
    place: Place
    """(3,) m: in the overlap."""
    lines: Annotated[tuple[int, int], columns("line_a", "line_b")]
    """Of these pieces."""
    hulls: bool
    """Whether one of them counts as its convex hull: it is not closed, or very fine."""


@dataclass(frozen=True, eq=False)
class Description:
    """One robot description among the sources of a design."""

    file: str
    """Relative to the folder of the top manifest."""
    prefix: str
    """Of its names in the assembly: "" where it is the top."""
    format: DescriptionFormat
    text: str
    """All of it as XML, macros expanded and includes put in."""
    links: tuple[DescribedLink, ...] = field(default=())
    joints: tuple[DescribedJoint, ...] = field(default=())
    meshes: tuple[LooseMesh, ...] = field(default=())
    overlaps: tuple[StartOverlap, ...] = field(default=())
    """Looked for where the parts are the visual geometry."""

    @property
    def incomplete(self) -> frozenset[str]:
        """Links of whose parts some have no mesh: their geometry is not all of it."""
        return frozenset(mesh.link for mesh in self.meshes if mesh.left_out)

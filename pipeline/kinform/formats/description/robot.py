"""What a robot description says, whatever its format: links, geometry, joints, inertials. SI and radians.

The frame F is that of the description: of its root link, or of its world. A reader of a format makes a `Robot`, and
`tables` makes of it the tables of a manifest, so that all formats go the same way from there.
"""

from __future__ import annotations

import math
from pathlib import Path

from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.descriptions import DescriptionFormat

NO_BOUND = 1e9
"""rad, m, N·m, N from which on a limit says that there is none, and what is written where a format wants a limit and
there is none: files of Gazebo have 1e16, others numbers such as this. The circumference of the earth is 4e7 m."""


@dataclass(frozen=True)
class At:
    """File, as messages show it, and line."""

    file: str
    line: int


@dataclass(frozen=True)
class Solid:
    """A primitive: `type` and sizes as `[[part]] shape` has them (m)."""

    type: str
    sizes: tuple[float, ...]
    """box: three sides. cylinder and capsule: radius, length (of a capsule without its caps). sphere: radius.
    ellipsoid: three radii."""


@dataclass(frozen=True, eq=False)
class Shape:
    """One piece of geometry of a link, placed."""

    name: str | None
    """As the description calls it."""
    geometry: Path | Solid
    """The file of a mesh, or a primitive."""
    scale: tuple[float, float, float]
    """Of the mesh, along its axes."""
    X_FG: Array
    """(4, 4) pose of the geometry in F."""
    at: At
    metres: float = 1.0
    """In one unit of a mesh whose format has none."""
    colour: str | None = None
    """"#rrggbb" that the description states."""


@dataclass(frozen=True, eq=False)
class Inertial:
    """Stated mass (kg), centre of mass (3,) m in F, inertia (3, 3) kg·m² about it along the axes of F."""

    mass: float
    centre: Array
    inertia: Array
    at: At


@dataclass(frozen=True)
class Stated:
    """An inertial in the numbers of the file, whether a body can have them or not."""

    mass: float
    six: tuple[float, ...] | None
    """xx, yy, zz, xy, xz, yz in the axes of its own frame; None: not stated."""
    at: At


@dataclass(frozen=True)
class Limits:
    """Of a joint, in the numbers of the file turned into SI, whether they are ascending or not."""

    kind: str
    """Of the joint, as the format calls it."""
    needed: bool = False
    """Whether the format wants limits of this type of joint."""
    bounds: tuple[float, float] | None = None
    effort: float | None = None
    speed: float | None = None
    degrees: bool = False
    """Whether the file has the bounds in degrees."""


def bounded(lower: float, upper: float) -> tuple[float, float] | None:
    """The range of two limits, infinite on a side where a number stands for no limit; None where that is both."""
    ends = (-math.inf if lower <= -NO_BOUND else lower), (math.inf if upper >= NO_BOUND else upper)
    return None if all(map(math.isinf, ends)) else ends


@dataclass(frozen=True, eq=False)
class Link:
    """A rigid body. `X_FL` is the pose of its frame."""

    name: str
    X_FL: Array
    at: At
    visual: tuple[Shape, ...] = ()
    collision: tuple[Shape, ...] = ()
    inertial: Inertial | None = None
    stated: Stated | None = None

    def shapes(self, geometry: str) -> tuple[Shape, ...]:
        """The shapes of "visual" or "collision"."""
        return self.visual if geometry == "visual" else self.collision


@dataclass(frozen=True, eq=False)
class RobotJoint:
    """A joint of kinform's type between two links; axis (3,) and point (3,) m in F."""

    name: str
    type: str
    between: tuple[str, str]
    at: At
    axis: Array | None = None
    point: Array | None = None
    axis2: Array | None = None
    pitch: float | None = None
    """Metres a turn."""
    range: tuple[float, float] | None = None
    effort: float | None = None
    """Greatest, N·m or N."""
    speed: float | None = None
    """Greatest, rad/s or m/s."""
    damping: float | None = None
    """N·m·s/rad or N·s/m."""
    stiffness: float | None = None
    """N·m/rad or N/m."""
    rest: float = 0.0
    """Of the spring, rad or m."""
    closure: bool = False
    """It closes a loop: two points are one, whatever joint does that."""
    limits: Limits | None = None
    """As they are written; None where the format has none for such a joint."""


@dataclass(frozen=True)
class Ratio:
    """value(first) = ratio · value(second) + offset, SI."""

    joints: tuple[str, str]
    ratio: float
    at: At
    offset: float = 0.0
    """rad or m; kept for rules alone: the motion is that of ratios without offset."""


@dataclass(frozen=True, eq=False)
class Robot:
    """All of a description. Names are distinct, joints name links that there are."""

    name: str
    at: At
    links: tuple[Link, ...]
    joints: tuple[RobotJoint, ...]
    ratios: tuple[Ratio, ...] = ()
    root: str | None = None
    """The link that is at rest."""
    notes: tuple[str, ...] = ()
    """What the reader did on its own account, and what cannot be carried, in sentences."""
    files: tuple[Path, ...] = ()
    """Files that were read besides the description: includes, and meshes that primitives are fitted to."""
    unsettled: bool = False
    """Whether it hangs on more than what the files hold: which files fit a pattern, are missing, or are in packages."""
    format: DescriptionFormat = ""
    """What `text` is."""
    text: str = ""
    """All of it as XML, macros expanded and includes put in; "" where it cannot be written back."""

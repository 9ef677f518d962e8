"""Form: parts, meshes, groups and poses as they come out of the manifest, in SI.

Arrays are float64 and read-only. `X_WP` is the pose of the part frame P in the world W (4×4).
"""

from __future__ import annotations

from dataclasses import field, replace
from functools import cached_property
from typing import Annotated

import numpy as np

from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints
from kinform.model.checks import CheckSettings
from kinform.model.descriptions import Description
from kinform.model.function import Function, SimulationRequest
from kinform.model.kinematics import JointType
from kinform.model.names import PartName
from kinform.model.quantities import XYZ, Direction, Inertia, Metres, Place, columns
from kinform.model.tolerances import PartSize, Tolerances

_UNTURNED = np.eye(3).tolist()


@dataclass(frozen=True)
class Source:
    """Where something was declared: manifest path relative to the top manifest's folder, 1-based line."""

    file: str
    line: int | None = None


Declared = Annotated[Source, columns("source_file", "source_line")]


@dataclass(frozen=True)
class MeshHealth:
    """Facts about one mesh, measured before anything was repaired (counts; volume in m³, signed), but that facets which
    are there more than once count once, as far as `form/meshes/repeated` takes them so."""

    facets: int
    vertices: int
    watertight: bool
    """Every edge belongs to exactly two facets after welding."""
    consistent_winding: bool
    """Every shared edge is run through in both directions."""
    manifold_status: str
    """Status by manifold3d: "NoError", "NotManifold", …"""
    volume: Annotated[float, "m³"]
    """Signed volume (m³); negative: inside out. Meaningful when watertight."""
    degenerate_facets: int
    duplicate_facets: int
    """Copies of other facets in the file."""
    open_edges: int
    overused_edges: int
    shells: int
    weld: Metres
    """Welding distance that was used (m)."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """A welded triangle mesh in the part frame, shared by all parts with the same content.

    The part frame is the frame of the file, moved along to `origin`.
    """

    vertices: Annotated[Array, "m"]
    """(V, 3) m."""
    faces: Ints
    """(F, 3) indices into vertices; degenerate facets removed."""
    health: MeshHealth
    path: str
    """File relative to the top manifest's folder."""
    body: str | None
    """Body inside the file (OBJ `o`/`g`, ASCII solid), or None for the whole file."""
    digest: str
    """SHA-256 (hex) of the welded geometry: vertices, faces, and the resolution where it is coarser than that of single
    precision. Equal digests: the same shape, as well known."""
    origin: Place = field(default_factory=lambda: np.zeros(3))
    """(3,) m: of the part frame in the frame of the file. Nought unless the file has its mesh far from its origin."""
    resolution: Metres = 0.0
    """A step of the last place of the file's largest coordinate (m): nothing finer is known of this mesh."""
    colour: str | None = None
    """"#rrggbb" (sRGB) of most of its area, where the file has colours. It decides nothing."""

    @cached_property
    def box(self) -> tuple[Array, Array]:
        """Lowest and highest corner (3,) m of the bounding box in the part frame; zeros without vertices."""
        if not len(self.vertices):
            return np.zeros(3), np.zeros(3)
        columns = np.ascontiguousarray(self.vertices.T)
        return columns.min(axis=1), columns.max(axis=1)

    @cached_property
    def bare(self) -> Mesh:
        """The shape, without the file that it came from."""
        if not self.path and self.body is None and self.colour is None:
            return self
        return replace(self, path="", body=None, colour=None)

    @cached_property
    def _placed(self) -> dict[bytes, tuple[Array, Array]]:
        """Boxes that were asked for, by pose."""
        return {}

    def placed_box(self, X_WP: Array) -> tuple[Array, Array]:
        """Lowest and highest corner (3,) m of the bounding box in the world, the mesh placed there; zeros without
        vertices."""
        if self.bare is not self:
            return self.bare.placed_box(X_WP)
        known, key = self._placed, X_WP.tobytes()
        if key not in known:
            R_WP, p_WP = X_WP[:3, :3], X_WP[:3, 3]
            if R_WP.tolist() == _UNTURNED or not len(self.vertices):
                low, high = self.box  # to the last bit what placing all vertices would give
                known[key] = (low + p_WP, high + p_WP) if len(self.vertices) else (low, high)
            else:
                placed = np.ascontiguousarray((self.vertices @ R_WP.T + p_WP).T)
                known[key] = (placed.min(axis=1), placed.max(axis=1))
        return known[key]

    @cached_property
    def diagonal(self) -> float:
        """Length of the diagonal of the bounding box (m)."""
        low, high = self.box
        return float(np.linalg.norm(high - low))

    @cached_property
    def size(self) -> PartSize:
        """The lengths of which tolerances are shares.

        The wall is twice the volume over the area: of a plate its thickness, of a rod its radius, of a cube a third of
        its side; that of the box where the mesh is not closed, and without bound where it is flat.
        """
        if self.bare is not self:
            return self.bare.size
        low, high = self.box
        wall = float((high - low).min()) / 3.0
        if self.health.watertight and len(self.faces):
            corners = (self.vertices - 0.5 * (low + high))[self.faces]
            across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            area = 0.5 * float(np.linalg.norm(across, axis=1).sum())
            volume = abs(float(np.einsum("ij,ij->", corners[:, 0], across))) / 6.0
            wall = 2.0 * volume / area if area > 0.0 else 0.0
        return PartSize(_span(self.vertices), wall if wall > 0.0 else float("inf"))


def _span(points: Array) -> float:
    """m: how far apart two of the points (n, 3) are, at most: however they are turned.

    From the point that is farthest from the mean of all to the one farthest from it, and on as long as it grows: a
    pair of which neither has anything farther away.
    """
    if not len(points):
        return 0.0
    here, span = points[np.argmax(np.linalg.norm(points - points.mean(axis=0), axis=1))], 0.0
    while True:
        away = np.linalg.norm(points - here, axis=1)
        farthest = int(np.argmax(away))
        if away[farthest] <= span:
            return span
        here, span = points[farthest], float(away[farthest])


@dataclass(frozen=True, eq=False)
class MassOverride:
    """Mass properties that the user states instead of those of the geometry (part frame)."""

    mass: Annotated[float, "kg"]
    centre_of_mass: Place
    """(3,) m."""
    inertia: Inertia
    """(3, 3) kg·m² about the centre of mass, part axes."""


@dataclass(frozen=True, eq=False)
class Part:
    """One part, placed. `mesh` is None for a stick body."""

    name: PartName
    mesh: Mesh | None
    X_WP: Annotated[Array, "1 (rotation), m (last column)"]
    """(4, 4) pose of the part frame in the world."""
    solid: bool
    """False: surfaces only; contacts yes, mass no, need not be watertight."""
    material: str | None
    density: Annotated[float, "kg/m³"] | None
    """kg/m³; None when nothing states it."""
    override: MassOverride | None
    units: str
    """Length unit of this part's mesh file."""
    source: Declared
    scale: Annotated[Array, "1", XYZ] = field(default_factory=lambda: np.ones(3))
    """(3,) factors along the axes of the mesh file, by which the mesh was scaled, and mirrored where their product is
    negative."""
    colour: str | None = None
    """"#rrggbb" (sRGB) that a manifest or a description states, over that of its mesh. It decides nothing."""

    @property
    def step(self) -> float:
        """m: the step in which its coordinates go, as its file has them, or where it stands: the farther from the
        origin, the coarser are the numbers of its place."""
        there = float(np.spacing(np.abs(self.X_WP[:3, 3]).max()))
        return there if self.mesh is None else max(self.mesh.resolution, there)

    @property
    def own_colour(self) -> str | None:
        """The colour that its sources give it; None where they give none."""
        return self.colour or (None if self.mesh is None else self.mesh.colour)


@dataclass(frozen=True, eq=False)
class Group:
    """Parts fastened by means that the geometry does not show."""

    name: str
    parts: tuple[PartName, ...]
    source: Declared
    override: MassOverride | None = None
    """Stated for the whole group, in the world frame."""


@dataclass(frozen=True, eq=False)
class Assumption:
    """The user overrides what geometry says of two parts (or groups). World frame, SI."""

    between: Annotated[tuple[str, str], columns("between_a", "between_b")]
    type: JointType | None
    """Joint type, or None when `ignore`."""
    ignore: bool
    axis: Direction | None
    point: Place | None
    pitch: Metres | None
    """Metres a turn."""
    reason: str
    source: Declared


@dataclass(frozen=True)
class Subassembly:
    """A sub-assembly that was flattened: its prefix ("yaw_motor"), file, and its stated mobility."""

    name: str
    file: str
    mobility: int | None
    source: Declared


@dataclass(frozen=True, eq=False)
class Assembly:
    """Form and function of one design, flattened, in SI, in the world frame."""

    name: str
    units: str
    """Unit of the top manifest, used to show lengths to people."""
    parts: tuple[Part, ...]
    """Sorted by name."""
    groups: tuple[Group, ...]
    """Sorted by name."""
    assumptions: tuple[Assumption, ...]
    ground: str | None
    """Part or group; None: the heaviest body."""
    tolerances: Tolerances
    infer_fasteners: bool
    function: Function
    simulation: SimulationRequest | None
    subassemblies: tuple[Subassembly, ...]
    source: Declared
    files: tuple[str, ...]
    """Every file read (manifests, meshes, tables), relative to the top manifest's folder, sorted."""
    notes: tuple[str, ...] = field(default=())
    """What the reader did on its own account, in sentences."""
    check: CheckSettings = field(default=CheckSettings())
    """How the rules are applied."""
    descriptions: tuple[Description, ...] = field(default=())
    """What robot descriptions among the sources say word for word."""

    def __repr__(self) -> str:
        return f"Assembly {self.name}: {len(self.parts)} parts, lengths shown in {self.units}"

    @cached_property
    def lost(self) -> frozenset[PartName]:
        """Parts whose files have numbers too coarse for their shape, or whose places have."""
        share = self.tolerances.resolved
        return frozenset(
            part.name for part in self.parts if part.mesh is not None and part.step > share * part.mesh.diagonal
        )

    @cached_property
    def largest(self) -> float:
        """m: the greatest diagonal of a part's bounding box; nought where no part has a mesh."""
        meshes = list({id(m): m for part in self.parts if (m := part.mesh) is not None and len(m.vertices)}.values())
        if not meshes:
            return 0.0
        # all boxes at once: one by one they take ten times as long, of thousands of parts
        columns = np.ascontiguousarray(np.concatenate([mesh.vertices for mesh in meshes]).T)
        starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
        spans = np.maximum.reduceat(columns, starts, axis=1) - np.minimum.reduceat(columns, starts, axis=1)
        squares = np.einsum("ij,ij->j", spans, spans)
        return max(meshes[k].diagonal for k in np.flatnonzero(squares >= (1.0 - 1e-9) * squares.max()))

    @cached_property
    def weighed(self) -> frozenset[PartName]:
        """Parts of groups whose mass is stated as a whole."""
        return frozenset(part for group in self.groups if group.override is not None for part in group.parts)

    def part(self, name: str) -> Part:
        """The part of that name; KeyError otherwise."""
        return self.named_parts[name]

    def parts_of(self, name: str) -> tuple[PartName, ...]:
        """The parts that a part's or a group's name stands for; KeyError for unknown names."""
        group = self.named_groups.get(name)
        return (self.part(name).name,) if group is None else group.parts

    @cached_property
    def named_parts(self) -> dict[str, Part]:
        """The parts by their names."""
        return {str(part.name): part for part in self.parts}

    @cached_property
    def named_groups(self) -> dict[str, Group]:
        """The groups by their names."""
        return {str(group.name): group for group in self.groups}

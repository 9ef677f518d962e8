"""Stated masses beside the geometry that they are stated for: parts of manifests, links of descriptions."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from kinform.foundation.meshes.hulls import Hull, hull_of
from kinform.frozen import dataclass
from kinform.mass.principal import impossible
from kinform.mass.shapes import Solid, solid_of
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly, Group, Part, Source
from kinform.model.descriptions import DescribedLink


@dataclass(frozen=True, eq=False)
class Weighed:
    """A part or group whose mass is stated, with its geometry. World frame."""

    name: str
    mass: float
    centre: Array
    """(3,) m."""
    inertia: Array
    """(3, 3) kg·m² about the centre."""
    parts: tuple[Part, ...]
    source: Source
    """Where the mass is stated."""
    described: DescribedLink | None
    """The link, where a description states it."""

    @property
    def what(self) -> str:
        """ "link 'arm'" or "'arm'"."""
        return f"link '{self.name}'" if self.described is not None else f"'{self.name}'"

    @cached_property
    def points(self) -> Array:
        """(n, 3) m: all vertices."""
        placed = [
            part.mesh.vertices @ part.X_WP[:3, :3].T + part.X_WP[:3, 3]
            for part in self.parts
            if part.mesh is not None and len(part.mesh.vertices)
        ]
        return np.concatenate(placed) if placed else np.zeros((0, 3))

    @cached_property
    def hull(self) -> Hull | None:
        """Around all of the geometry."""
        return hull_of(self.points)

    @cached_property
    def solid(self) -> Solid | None:
        """What the closed meshes enclose."""
        return solid_of(self.parts)

    @cached_property
    def size(self) -> float:
        """m: the diagonal of the box around it."""
        return float(np.linalg.norm(np.ptp(self.points, axis=0))) if len(self.points) else 0.0

    @property
    def possible(self) -> bool:
        """Whether a rigid body can have this mass and inertia."""
        return not impossible(self.mass, self.inertia)


def weighed(assembly: Assembly) -> Iterator[Weighed]:
    """Everything with a stated mass and all of its meshes, sorted by name within parts and groups."""
    incomplete = {name for description in assembly.descriptions for name in description.incomplete}
    links = {link.name: link for description in assembly.descriptions for link in description.links}
    by_name = {part.name: part for part in assembly.parts}
    for part in assembly.parts:
        stated = part.override
        if stated is not None and part.mesh is not None:
            R, p = part.X_WP[:3, :3], part.X_WP[:3, 3]
            centre = R @ stated.centre_of_mass + p
            yield Weighed(part.name, stated.mass, centre, R @ stated.inertia @ R.T, (part,), part.source, None)
    for group in assembly.groups:
        if group.override is not None and group.name not in incomplete:
            inside = tuple(by_name[name] for name in group.parts)
            stated = group.override
            if any(part.mesh is not None for part in inside):
                yield Weighed(group.name, stated.mass, stated.centre_of_mass, stated.inertia, inside,
                              _place(group, links), links.get(group.name))  # fmt: skip


def _place(group: Group, links: dict[str, DescribedLink]) -> Source:
    link = links.get(group.name)
    if link is None or link.stated is None:
        return group.source
    return Source(link.file, link.stated.line)


def described_links(assembly: Assembly) -> Iterator[DescribedLink]:
    """The links of all descriptions."""
    return (link for description in assembly.descriptions for link in description.links)

"""The drawn side of a design: shapes, bodies with their colours, signs of joints, overlaps, movements, what findings
show."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from kinform.design import Design
from kinform.frozen import dataclass
from kinform.function.body_titles import body_titles
from kinform.model.arrays import Array
from kinform.model.assembly import Mesh
from kinform.model.kinematics import Body, Joint
from kinform.reports.page.focus import Focus, focus_of
from kinform.reports.page.meshes import Shape, shape_of
from kinform.reports.page.movements import Movement, movements_of
from kinform.reports.page.overlaps import overlap_shapes
from kinform.reports.page.proposed import ProposedJoint, proposed
from kinform.reports.page.subjects import wanted_names

GROUND_COLOUR = "#8b929c"
"""Of the body that is ground."""
BODY_COLOURS = (
    "#6b9ac4", "#d39a5b", "#79ab83", "#b08abf", "#c9807a", "#6fb0ae", "#bda956", "#8a92cf", "#c78ca9", "#94a86a",
)  # fmt: skip
"""Of the other bodies, one after the other and again from the first."""
LEAST_SIGN, MOST_SIGN = 0.045, 0.16
"""Shares of the assembly's size between which a sign stays. Chosen by eye."""


@dataclass(frozen=True, eq=False)
class Scene:
    """The drawn side of one design."""

    design: Design

    @cached_property
    def shapes(self) -> dict[str, Shape]:
        """Each distinct mesh once, by digest."""
        return {m.digest: shape_of(m, self.design.surfaces.get(m.digest)) for m in self._meshes}

    @cached_property
    def _meshes(self) -> list[Mesh]:
        found = {part.mesh.digest: part.mesh for part in self.design.assembly.parts if part.mesh is not None}
        return list(found.values())

    @cached_property
    def bodies(self) -> tuple[Body, ...]:
        """Bodies; each part by itself where joints are not known."""
        if self.design.kinematics is not None:
            return self.design.kinematics.bodies
        return tuple(Body(part.name, (part.name,), False) for part in self.design.assembly.parts)  # type: ignore[arg-type]

    @cached_property
    def colours(self) -> list[str]:
        """Of each body."""
        return _body_colours([body.ground for body in self.bodies])

    @cached_property
    def body_number(self) -> dict[str, int]:
        """The number of each body, by name."""
        return {body.name: k for k, body in enumerate(self.bodies)}

    @cached_property
    def titles(self) -> dict[str, str]:
        """What bodies are called beside their names: "body of base"."""
        return {} if self.design.kinematics is None else body_titles(self.design.assembly, self.design.kinematics)

    @cached_property
    def body_index(self) -> dict[str, int]:
        """The number of each part's body."""
        return {part: k for k, body in enumerate(self.bodies) for part in body.parts}

    @cached_property
    def overlaps(self) -> list[Shape | None]:
        """Solids of the interferences, in the world."""
        return overlap_shapes(self.design)

    @cached_property
    def box(self) -> tuple[Array, Array]:
        """Lowest and highest corner (3,) m of everything that is drawn."""
        places = [_corners(p.mesh) @ p.X_WP[:3, :3].T + p.X_WP[:3, 3] for p in self.design.assembly.parts if p.mesh]
        places += [p.X_WP[None, :3, 3] for p in self.design.assembly.parts if p.mesh is None]
        places += [joint.point[None] for joint in self.joints if joint.point is not None]
        run = self.design.simulation
        if not any(p.mesh for p in self.design.assembly.parts) and run is not None and run.p_WB.size:
            places.append(run.p_WB.reshape(-1, 3))
        found = np.concatenate(places) if places else np.zeros((1, 3))
        low, high = found.min(axis=0), found.max(axis=0)
        if float((high - low).max()) <= 0.0:
            # a scene that is a point gets a box of 0.1 m
            low, high = low - 0.05, high + 0.05
        return low, high

    @property
    def size(self) -> float:
        """Diagonal of the box (m)."""
        return float(np.linalg.norm(self.box[1] - self.box[0]))

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """Derived joints; none where they are not known."""
        return () if self.design.kinematics is None else self.design.kinematics.joints

    @cached_property
    def wanted(self) -> dict[str, list[str]]:
        """Names that the designer gave to derived joints."""
        return wanted_names(self.design)

    @cached_property
    def movements(self) -> list[Movement]:
        """The simulated run and the freedoms."""
        return movements_of(self.design, self.size)

    @cached_property
    def proposed(self) -> list[ProposedJoint]:
        """Joints that may be meant, where no function is stated."""
        return proposed(self.design, self.bodies)

    @cached_property
    def focuses(self) -> list[Focus]:
        """Of each finding, in the order of the report."""
        found = () if self.design.report is None else self.design.report.findings
        return [focus_of(self.design, self.movements, finding) for finding in found]

    def sign_of(self, joint: Joint) -> tuple[Array, float]:
        """Where the joint's sign stands, and how large it is: about as large as its contact."""
        found = () if self.design.contacts is None else self.design.contacts.patches
        points = [found[k].points for k in joint.patches if k < len(found)]
        extent, centre = 0.0, None
        if any(map(len, points)):
            every = np.concatenate(points)
            centre = 0.5 * (every.min(axis=0) + every.max(axis=0))
            extent = 0.5 * float(np.linalg.norm(every.max(axis=0) - every.min(axis=0)))
        point = joint.point
        if point is None:
            point = centre if centre is not None else 0.5 * (self.box[0] + self.box[1])
        elif centre is not None and joint.axis is not None and joint.type in ("revolute", "cylindrical", "screw"):
            point = point + joint.axis * float(joint.axis @ (centre - point))
        # A joint's sign over half the extent of its contact, so that it stands out of the part. Chosen by eye.
        return point, float(np.clip(1.25 * extent, LEAST_SIGN * self.size, MOST_SIGN * self.size))


def _corners(mesh: Mesh) -> Array:
    low, high = mesh.box
    return np.array([[(low, high)[b >> k & 1][k] for k in range(3)] for b in range(8)])


def _body_colours(ground: list[bool]) -> list[str]:
    """A colour for each body in order; grey where it is the ground."""
    colours, used = [], 0
    for held in ground:
        colours.append(GROUND_COLOUR if held else BODY_COLOURS[used % len(BODY_COLOURS)])
        used += not held
    return colours

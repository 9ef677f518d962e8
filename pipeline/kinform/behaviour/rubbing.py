"""What rubs in a joint, as friction needs it: the arms at which the forces across and along its axis are braked.

A journal of radius r that carries the force F brakes with the torque μ r F. A moment across the axis presses the ends
of the journal to opposite sides: with the forces F₁ and F₂ there the torque is μ r (|F₁| + |F₂|). A thrust ring of
mean radius r brakes an axial force F with μ r F. A thread of mean radius r and lead angle λ, whose flanks lean by α as
seen across the thread, has the normal force N = |F cos λ − (M / r) sin λ| / cos α from the axial force F and the torque
M that it passes on, friction included, and brakes along the thread with μ N: the formulas of Shigley's Mechanical
Engineering Design (chapter 8, power screws) follow, with cos α where he has the angle in the axial plane.
"""

from __future__ import annotations

import math
from dataclasses import field
from typing import Any

import numpy as np

from kinform.behaviour.joints import JointGeometry, JointKind
from kinform.frozen import dataclass
from kinform.model.arrays import Array


@dataclass(frozen=True, eq=False)
class Rubs:
    """The surfaces of a joint that rub (m, rad)."""

    radius: float = 0.0
    """Of the journal; of a screw the mean radius of its thread. 0: none."""
    thrust: float = 0.0
    """Mean radius of the ring that carries forces along the axis. 0: none."""
    flank: float = 0.0
    """Half the angle of the thread in the axial plane: 0 for a square thread, 14.5° for an Acme."""
    lower: float = 0.0
    """From the joint's point along its axis to one end of journal or guide."""
    upper: float = 0.0
    """To the other; where they are equal moments across the axis are carried without friction."""
    faces: tuple[Array, Array] | None = None
    """Unit normals of a guide between flat faces; None: it is round."""
    twist: float = 0.0
    """Arm at which faces carry a torque about the axis of a slide. 0: it is carried without friction."""
    offset: Array = field(default_factory=lambda: np.zeros(3))
    """(3,) from the joint's point to the point that `lower` and `upper` count from, and loads act about."""
    riding: bool = False
    """Whether the ends go along with the second body."""

    def levers(self, kind: JointKind, geometry: JointGeometry, freedom: int) -> dict[str, Any]:
        """The fields of `shafts.Friction` that say what loads brake. Raises ValueError with what is missing."""
        turns = kind.name == "revolute" or (kind.name == "cylindrical" and freedom == 0)
        ends = {"lower": self.lower, "upper": self.upper, "riding": self.riding, "offset": self.offset}
        if kind.name == "screw":
            return self._of_thread(geometry)
        if turns:
            if self.radius <= 0.0 and self.thrust <= 0.0:
                raise ValueError("the radius of its journal or of its thrust ring is not known")
            return {"radial": self.radius, "axial": self.thrust, **ends}
        if kind.name not in ("prismatic", "cylindrical"):
            raise ValueError(f"friction acts on joints that turn or slide about one axis, not on a {kind.name} joint")
        torsion = 1.0 / self.twist if self.twist > 0.0 else 0.0
        return {"radial": 1.0, "torsion": torsion, **ends, **self._of_faces()}

    def _of_thread(self, geometry: JointGeometry) -> dict[str, Any]:
        if self.radius <= 0.0 or not geometry.pitch:
            raise ValueError("the mean radius of its thread is not known")
        slope = geometry.pitch / (2.0 * math.pi * self.radius)  # tan λ, of its sign
        across = 1.0 / math.sqrt(1.0 + (math.tan(self.flank) / math.sqrt(1.0 + slope * slope)) ** 2)  # cos α
        return {"axial": self.radius / across, "torsion": -slope / across}

    def _of_faces(self) -> dict[str, Array]:
        """Directions dual to the normals: what a force across the slide presses on either pair of faces."""
        if self.faces is None:
            return {}
        first, second = self.faces
        shared = float(first @ second)
        return {
            "faces_u": (first - shared * second) / (1.0 - shared * shared),
            "faces_v": (second - shared * first) / (1.0 - shared * shared),
        }


def is_round(u: Array, v: Array) -> bool:
    """Whether these directions of `shafts.Friction` stand for no flat faces."""
    return not (np.any(u) or np.any(v))

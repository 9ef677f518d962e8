"""What the result of each stage depends on, said once.

Fingerprints, lineage, what a stage sees and why it is computed again all follow from these records.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from kinform.design import Design
from kinform.frozen import dataclass
from kinform.model.assembly import Assembly
from kinform.reuse import views

MOTION = (
    "simulation",
    "behaviour",
    "function",
    "requirements",
    "mass",
    "kinematics",
    "mechanism",
    "collisions",
    "surfaces",
    "contacts",
    "foundation",
)
"""Packages whose code decides what a simulation comes out as."""
RESULTS: dict[str, Callable[[Design], Any]] = {
    "surfaces": lambda design: design.surfaces,
    "contacts": lambda design: design.contacts,
    "bodies": lambda design: design.kinematics and design.kinematics.bodies,
    "joints": lambda design: design.kinematics,
    "mass": lambda design: design.mass,
    "the simulated motion": lambda design: design.simulation,
}
"""Results that later stages depend on, in the words in which a change of them is told."""


@dataclass(frozen=True)
class Stage:
    """What a stage makes, and of what."""

    name: str
    code: Mapping[str, tuple[str, ...]]
    """Kinds of results, each with the packages whose code decides it."""
    fills: tuple[str, ...] = ()
    """Fields of Design that it fills, the one that is never None last."""
    marks: tuple[str, ...] = ()
    """Fields of Fingerprints about smaller things than the whole result."""
    view: Callable[[Assembly], Assembly] = views.everything
    """What it sees of the assembly."""
    needs: tuple[str, ...] = ()
    """Earlier results that it is given, as `RESULTS` names them."""

    def results(self, design: Design) -> dict[str, Any]:
        """The earlier results that it depends on, by their names in words."""
        return {name: RESULTS[name](design) for name in self.needs}


CONTACTS = Stage(
    "contacts",
    code={"surfaces": ("surfaces", "foundation"), "contacts": ("contacts", "surfaces", "foundation")},
    fills=("surfaces", "contacts"),
    marks=("meshes", "pairs"),
    view=views.for_contacts,
    needs=("surfaces",),
)
JOINTS = Stage(
    "joints",
    code={"joints": ("kinematics", "mechanism", "foundation")},
    fills=("kinematics",),
    marks=("decisions",),
    view=views.for_joints,
    needs=("surfaces", "contacts"),
)
MASS = Stage(
    "mass",
    code={"mass": ("mass", "kinematics", "mechanism", "foundation")},
    fills=("mass",),
    view=views.for_mass,
    needs=("surfaces", "bodies"),
)
SIMULATION = Stage(
    "simulation",
    code={"simulation": MOTION},
    fills=("behaviour", "simulation"),
    view=views.for_motion,
    needs=("joints", "mass", "surfaces", "contacts"),
)
FINDINGS = Stage(
    "findings",
    code={"findings": ("consistency", "statics", "mass", *MOTION)},
    fills=("report",),
    needs=("surfaces", "contacts", "joints", "mass", "the simulated motion"),
)
STAGES = (CONTACTS, JOINTS, MASS, SIMULATION, FINDINGS)
"""Those after the import, in their order: what a stage made is dropped when one before it makes something new."""
CODE = {"assembly": ("form", "formats", "requirements", "foundation")} | {
    kind: packages for stage in STAGES for kind, packages in stage.code.items()
}
"""Packages whose code decides the results of each kind, the assembly that is read first."""

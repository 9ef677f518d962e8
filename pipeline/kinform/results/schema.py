"""What each dataset of a results file must look like: its shape, what its whole numbers count, what its names name.

Columns of tables and their kinds follow from the annotations of the records (`records`); here stands what annotations
cannot say. Every array of the file has its line (tested), and `conformity` checks a group against these tables before
anything is made of it: a digest proves that a file is as somebody wrote it, not that it makes sense.
"""

from __future__ import annotations

from typing import Literal

from kinform.frozen import dataclass
from kinform.model.collisions import RANGE_STATUSES
from kinform.model.coverage import STATEMENT_KINDS, STATEMENT_OUTCOMES
from kinform.model.findings import OUTCOMES, SEVERITIES
from kinform.model.kinematics import JOINT_TYPES, STATUSES
from kinform.model.surfaces import KINDS


@dataclass(frozen=True)
class Last:
    """As many as the last number of a dataset says."""

    dataset: str


Length = int | str | Last | None
"""A number; or the rows of a dataset; None: any."""


@dataclass(frozen=True)
class Form:
    """An array."""

    kind: Literal["f", "i", "u"]
    """As NumPy names it."""
    shape: tuple[Length, ...]
    or_none: bool = False
    """Whether there may be nothing along its first axis: then the others say nothing."""


TIME, BODIES, JOINTS = "simulation/time", "simulation/body_names", "simulation/joint_names"
COORDINATES, GEARS, FRICTIONS = Last("simulation/joint_offset"), "simulation/gear_names", "simulation/friction_joints"
_OF_DRIVES = Form("f", ("simulation/time", "simulation/drives"), or_none=True)
_OF_COORDINATES = Form("f", (TIME, COORDINATES), or_none=True)
# a wrench (τ; f) of each joint at each time
_WRENCHES = Form("f", (TIME, JOINTS, 6), or_none=True)
ARRAYS: dict[str, Form] = {
    "assembly/X_WP": Form("f", ("assembly/parts", 4, 4)),
    "constraints/data": Form("f", (None,)),
    "constraints/indices": Form("i", ("constraints/data",)),
    "constraints/indptr": Form("i", (None,)),
    "mobility/freedoms": Form("f", (None, "joints/bodies", 6)),
    TIME: Form("f", (None,)),
    "simulation/p_WB": Form("f", (TIME, BODIES, 3), or_none=True),
    "simulation/q_WB": Form("f", (TIME, BODIES, 4), or_none=True),
    "simulation/joint_offset": Form("i", (None,)),
    "simulation/joint_position": _OF_COORDINATES,
    "simulation/joint_velocity": _OF_COORDINATES,
    "simulation/joint_acceleration": _OF_COORDINATES,
    "simulation/joint_effort": _OF_COORDINATES,
    "simulation/balance_shafts": _OF_COORDINATES,
    "simulation/balance_bodies": Form("f", (TIME, BODIES), or_none=True),
    "simulation/F_A": _WRENCHES,
    "simulation/F_B": _WRENCHES,
    "simulation/undetermined": Form("u", (JOINTS, 6), or_none=True),
    "simulation/joint_signs": Form("i", (JOINTS,)),
    "simulation/gear_effort": Form("f", (TIME, GEARS, 2), or_none=True),
    "simulation/gear_force": Form("f", (TIME, GEARS), or_none=True),
    "simulation/friction_effort": Form("f", (TIME, FRICTIONS), or_none=True),
    "simulation/friction_limit": Form("f", (TIME, FRICTIONS), or_none=True),
    "simulation/friction_sticks": Form("u", (TIME, FRICTIONS), or_none=True),
    "simulation/energy": Form("f", (TIME, 3), or_none=True),
    "simulation/drive_effort": _OF_DRIVES,
    "simulation/drive_speed": _OF_DRIVES,
    "simulation/sensed": Form("f", (TIME, "simulation/readings"), or_none=True),
}
"""Arrays by name."""

RAGGED: dict[str, tuple[str, Form]] = {
    "assembly/vertices": ("assembly/meshes", Form("f", (None, 3))),
    "assembly/faces": ("assembly/meshes", Form("i", (None, 3))),
    "assembly/function/law_times": ("assembly/function/drives", Form("f", (None,))),
    "assembly/function/law_values": ("assembly/function/drives", Form("f", (None,))),
    "surfaces/labels": ("surfaces/meshes", Form("i", (None,))),
    "surfaces/faces": ("surfaces/surfaces", Form("i", (None,))),
    "joints/twists": ("joints/joints", Form("f", (None, 6))),
    "joints/singular_values": ("joints/joints", Form("f", (None,))),
    "joints/patches": ("joints/joints", Form("i", (None,))),
    "joints/at_rest": ("joints/joints", Form("f", (None, 6))),
    "joints/closed": ("joints/joints", Form("f", (None, 6))),
    "mobility/redundant_patches": ("mobility/redundancies", Form("i", (None,))),
    "mobility/redundant_wrenches": ("mobility/redundancies", Form("f", (None, 6))),
    "assembly/function/load_law_times": ("assembly/function/loads", Form("f", (None,))),
    "assembly/function/load_law_values": ("assembly/function/loads", Form("f", (None,))),
    "behaviour/law_times": ("behaviour/laws", Form("f", (None,))),
    "behaviour/law_levels": ("behaviour/laws", Form("f", (None,))),
}
"""Arrays of arrays: in which table their owners are, and their form all together."""

STEADY = ("constraints/indptr", "simulation/joint_offset")
"""Arrays of places that begin with 0 and never fall."""

AS_LONG = {
    "constraints/indptr": ("constraints/rows", "constraints/data"),
    "simulation/joint_offset": (JOINTS, None),
    "simulation/joint_types": (JOINTS, None),
    "simulation/derived_joints": (JOINTS, None),
    "simulation/monitors": (TIME, None),
}
"""Rows of another dataset, one more for places; and what the last place is the length of."""

ROWS: dict[str, tuple[str, bool]] = {
    "assembly/parts.mesh": ("assembly/meshes", True),
    "joints/patches": ("contacts/patches", False),
    "joints/blockers.patch": ("contacts/patches", False),
    "joints/at_stop.patch": ("contacts/patches", False),
    "mobility/redundant_patches": ("contacts/patches", False),
    "constraints/rows.patch": ("contacts/patches", False),
    "contacts/samples.patch": ("contacts/patches", False),
    "surfaces/surfaces.mesh": ("surfaces/meshes", False),
    "behaviour/components.system": ("behaviour/systems", False),
    "behaviour/systems.inside": ("behaviour/systems", True),
    "behaviour/nodes.system": ("behaviour/systems", False),
    "behaviour/ports.node": ("behaviour/nodes", False),
    "behaviour/exposed.system": ("behaviour/systems", False),
    "behaviour/motion.law": ("behaviour/laws", False),
    "behaviour/effort.law": ("behaviour/laws", False),
    "behaviour/servo.law": ("behaviour/laws", False),
    "behaviour/load.law": ("behaviour/laws", False),
    "behaviour/voltage_source.law": ("behaviour/laws", False),
    "behaviour/voltage_controller.law": ("behaviour/laws", False),
}
"""Whole numbers that are rows of a table: of which, and whether −1 says none."""

_PARTS, _BODIES, _JOINTS = "assembly/parts.name", "joints/bodies.name", "joints/joints.name"
NAMES: dict[str, tuple[str, ...]] = {
    "assembly/groups.parts": (_PARTS,),
    **{f"contacts/{table}.part_{side}": (_PARTS,)
       for table in ("pairs", "patches", "interferences", "possible_overlaps", "suggestions") for side in "ab"},
    "joints/bodies.parts": (_PARTS,),
    "joints/joints.body_a": (_BODIES,),
    "joints/joints.body_b": (_BODIES,),
    "joints/blockers.part_a": (_PARTS,),
    "joints/blockers.part_b": (_PARTS,),
    "joints/at_stop.part_a": (_PARTS,),
    "joints/at_stop.part_b": (_PARTS,),
    "joints/moves.joint": (_JOINTS,),
    "joints/membership.part": (_PARTS,),
    "joints/membership.body": (_BODIES,),
    "joints/asides.body_a": (_BODIES,),
    "joints/asides.body_b": (_BODIES,),
    "constraints/bodies": (_BODIES,),
    "mobility/idle_bodies": (_BODIES,),
    "mobility/named.driver": (_JOINTS,),
    "mobility/named.body": (_BODIES,),
    "mobility/drives.joint": (_JOINTS,),
    "mobility/redundancies.joints": (_JOINTS,),
    "mobility/certificates.joints": (_JOINTS,),
    "mass/parts.name": (_PARTS,),
    "mass/bodies.name": (_BODIES,),
}  # fmt: skip
"""Texts, and lists of texts, that name what a column of the file has; no text is none."""

ALONE = (_PARTS, _BODIES, _JOINTS, "surfaces/meshes.digest")
"""Names of which there is one each."""

WORDS: dict[str, tuple[str, ...]] = {
    "surfaces/surfaces.kind": KINDS,
    "joints/joints.type": JOINT_TYPES,
    "joints/joints.status": STATUSES,
    "joints/readings.type": JOINT_TYPES,
    "joints/asides.type": JOINT_TYPES,
    "joints/asides.status": STATUSES,
    "findings/findings.severity": SEVERITIES,
    "findings/rules.outcome": OUTCOMES,
    "findings/statements.kind": STATEMENT_KINDS,
    "findings/statements.outcome": STATEMENT_OUTCOMES,
    "simulation/ranges.status": RANGE_STATUSES,
    "simulation/ranges.side": ("lower", "upper"),
    "simulation/summary.status": ("done", "not requested", "partial", "refused", "stopped"),
}
"""Texts that are words of a list."""

_MASS = ("centre_of_mass_", "inertia_", "principal_", "mass_bound")
UNKNOWN: tuple[str, ...] = (
    *(f"{table}.{column}" for table in ("mass/parts", "mass/bodies", "behaviour/rigid_body") for column in _MASS),
    "contacts/interferences.volume",
    "contacts/possible_overlaps.volume",
    "joints/singular_values",
    "joints/couplings.uncertainty",
    "simulation/energy",
    "simulation/joint_acceleration",
    "simulation/joint_effort",
    "simulation/sensed",
    "simulation/drive",
    "simulation/gear_force",
    "simulation/monitors.balance",
    "simulation/balance_",
    "simulation/collisions.depth",
)
"""Beginnings of the columns that may hold what is no number: not known."""
ENDLESS: tuple[str, ...] = (
    "joints/membership.margin", "joints/meshings.reach_", "behaviour/gear.lower", "behaviour/gear.upper",
    "behaviour/end_stop.", "behaviour/servo.", "behaviour/voltage_controller.", "behaviour/dc_motor.current_limit",
    "assembly/function/joints.range_",
)  # fmt: skip
"""Beginnings of the columns that may be infinite: nothing bounds them."""
AS_STATED: tuple[str, ...] = tuple(f"assembly/described_joints.{c}" for c in ("lower", "upper", "effort", "speed"))
"""Beginnings of the columns that may hold any number: what a description says, where the largest one means no bound."""

SPELT: dict[str, str] = {
    **{f"findings/{table}.code": r"[A-Z]{2}[0-9]{3}" for table in ("findings", "rules", "ignored")},
    **{f"findings/{table}.rule": r"[a-z0-9]+(-[a-z0-9]+)*" for table in ("findings", "rules", "ignored")},
    **{f"assembly/{table}.colour": r"#[0-9a-fA-F]{6}" for table in ("meshes", "parts")},
}
"""Columns whose texts are words of kinform, also of versions that have others, or colours: renderers write them as they
are, or read them as numbers."""

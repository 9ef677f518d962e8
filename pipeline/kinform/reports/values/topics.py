"""What `kinform show --format json` prints: one object a topic, SI and radians, world axes.

The object of `joints` is a contract that scripts rely on; in all of them a value that is not known, not
finite, or not computed yet is null.
"""

from __future__ import annotations

import importlib
import json
from typing import Any

from kinform.design import Design
from kinform.errors import StageError
from kinform.foundation.escapes import json_text
from kinform.frozen import dataclass
from kinform.reports.values.plain import fields, plain


def summary(design: Design, topic: str | None = None) -> dict[str, Any]:
    """The values of one topic, or of all of them, as JSON has them: dicts, lists, text, numbers, None.

    Topics: assembly, contacts, joints, bodies, mobility, mass, behaviour, simulation, findings. Raises StageError when
    the stage of the topic has not run, and ValueError for another topic.
    """
    if topic is None:
        known = {name: summary(design, name) if TOPICS[name].computed(design) else None for name in TOPICS}
        return {"schema": "kinform/design/1", **known}
    if topic not in TOPICS:
        raise ValueError(f"unknown topic {topic!r}: expected one of {', '.join(TOPICS)}")
    require(design, topic)
    head = {"schema": f"kinform/{topic}/1", "assembly": design.assembly.name, "units": design.assembly.units}
    found: dict[str, Any] = plain(head | TOPICS[topic].values(design))
    return found


def summary_json(design: Design, topic: str | None = None) -> str:
    """`summary` as JSON text, ending in a newline."""
    return json_text(json.dumps(summary(design, topic), indent=1, allow_nan=False)) + "\n"


def joint_evidence(design: Design, name: str) -> dict[str, Any]:
    """All the evidence of one joint. Raises StageError when joints are not known, KeyError for another name."""
    from kinform.kinematics import insight
    from kinform.reports.values.kinematics import InDesignersSense, one_joint, ranged

    require(design, "joints")
    found, computed = insight(design, name), design.ranged
    assert computed is not None
    of_patch = ("parts", "surfaces", "kind", "one_sided", "area", "gap", "fit")
    evidence: dict[str, Any] = plain(
        {
            "schema": "kinform/joint/1",
            "assembly": design.assembly.name,
            "units": design.assembly.units,
            "joint": one_joint(computed.named_joints[found.joint.name], found.joint.name in ranged(design))
            | InDesignersSense(design).of_derived(found.joint.name),
            "patches": [
                fields(item, "index", "role", "share", "rows") | fields(item.patch, *of_patch) for item in found.patches
            ],
            **fields(found, "rows", "samples", "last_free", "first_held"),
            "thresholds": fields(found, "free", "held"),
            "alternatives": [
                fields(item, "without", "frees", "type", "freedoms", "status", "axis") for item in found.alternatives
            ],
            **fields(found, "tried"),
            "remark": found.remark or None,
        }
    )
    return evidence


def joint_json(design: Design, name: str) -> str:
    """`joint_evidence` as JSON text, ending in a newline."""
    return json_text(json.dumps(joint_evidence(design, name), indent=1, allow_nan=False)) + "\n"


@dataclass(frozen=True)
class Topic:
    """The command that computes it, the field of the design that holds it, and the module below `kinform.reports` and
    the function there that give its values."""

    command: str
    field: str
    module: str
    function: str

    def values(self, design: Design) -> dict[str, Any]:
        """What is known of it; the module is imported now, for few commands need more than one of them."""
        found: dict[str, Any] = getattr(importlib.import_module(f"kinform.reports.{self.module}"), self.function)(
            design
        )
        return found

    def computed(self, design: Design) -> bool:
        """Whether the command has run."""
        return design.has(self.field)


TOPICS = {
    "assembly": Topic("import", "assembly", "values.form", "assembly_values"),
    "contacts": Topic("contacts", "contacts", "values.form", "contact_values"),
    "joints": Topic("joints", "kinematics", "values.kinematics", "joint_values"),
    "bodies": Topic("joints", "kinematics", "values.kinematics", "body_values"),
    "mobility": Topic("joints", "kinematics", "values.kinematics", "mobility_values"),
    "mass": Topic("mass", "mass", "values.form", "mass_values"),
    "behaviour": Topic("simulate", "behaviour", "values.runs", "behaviour_values"),
    "simulation": Topic("simulate", "simulation", "values.runs", "simulation_values"),
    "findings": Topic("check", "report", "as_json", "of_design"),
}
"""In the order of the pipeline."""


def require(design: Design, topic: str) -> None:
    """Raise StageError where the stage of the topic has not run."""
    if not TOPICS[topic].computed(design):
        raise StageError(f"`kinform show {topic}`", TOPICS[topic].command)

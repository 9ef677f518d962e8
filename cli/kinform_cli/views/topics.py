"""The topics that can be shown, in the order of the pipeline, and which command computes each."""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType

from kinform.design import Design
from kinform_cli.views import assembly, behaviour, contacts, findings, joints, mass, mobility, simulation

__all__ = ["TOPICS", "Topic"]


@dataclass(frozen=True)
class Topic:
    """A view, the command whose results it shows, and the field of the design where they are."""

    view: ModuleType
    command: str
    field: str

    def known(self, design: Design) -> bool:
        """Whether the command has run."""
        return getattr(design, self.field) is not None


TOPICS = {
    "assembly": Topic(assembly, "import", "assembly"),
    "contacts": Topic(contacts, "contacts", "contacts"),
    "joints": Topic(joints, "joints", "kinematics"),
    "mobility": Topic(mobility, "joints", "kinematics"),
    "mass": Topic(mass, "mass", "mass"),
    "behaviour": Topic(behaviour, "simulate", "behaviour"),
    "simulation": Topic(simulation, "simulate", "simulation"),
    "findings": Topic(findings, "check", "report"),
}

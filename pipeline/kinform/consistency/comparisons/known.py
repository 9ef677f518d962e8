"""What is asked about each of many intended joints, and is the same for all."""

from __future__ import annotations

from functools import cached_property

from kinform.consistency.questions.captive_parts import CaptiveParts
from kinform.kinematics.joints.bodies.extents import Extents
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.kinematics import Body, Kinematics


def bodies_of(assembly: Assembly, kinematics: Kinematics, between: tuple[str, str]) -> tuple[str, str]:
    """Names of the bodies that contain two parts or groups."""
    first, second = (kinematics.body_of(assembly.parts_of(name)[0]).name for name in between)
    return first, second


class Known:
    """Of one assembly; worked out when first asked for."""

    def __init__(self, assembly: Assembly, contacts: Contacts | None, kinematics: Kinematics):
        self.assembly, self.contacts, self.kinematics = assembly, contacts, kinematics

    @cached_property
    def named(self) -> frozenset[str]:
        """Bodies that the function names."""
        pairs = (bodies_of(self.assembly, self.kinematics, one.between) for one in self.assembly.function.joints)
        return frozenset(name for pair in pairs for name in pair)

    @cached_property
    def extents(self) -> Extents:
        """Of the assembly."""
        return Extents(self.assembly)

    @cached_property
    def afloat(self) -> CaptiveParts | None:
        """Parts with play; None without contacts."""
        return CaptiveParts(self.assembly, self.contacts) if self.contacts is not None else None

    def smaller(self, bodies: tuple[Body, Body]) -> float:
        """Diagonal (m) of the smaller of the bodies that have one; of the assembly where none has."""
        sizes = [size for body in bodies if (size := self.extents.diagonal(body.parts)) > 0.0]
        return min(sizes) if sizes else self.extents.assembly

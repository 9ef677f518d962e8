"""What the queries take: an assembly, and as much of its contacts and kinematics as has been derived."""

from __future__ import annotations

from typing import Protocol

from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.kinematics import Kinematics


class DesignView(Protocol):
    """The fields of a design that queries read; None: not computed yet."""

    @property
    def assembly(self) -> Assembly: ...
    @property
    def contacts(self) -> Contacts | None: ...
    @property
    def kinematics(self) -> Kinematics | None: ...

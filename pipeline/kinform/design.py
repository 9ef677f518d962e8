"""Everything known of one design: what each stage has added so far."""

from __future__ import annotations

from dataclasses import field, replace
from typing import TYPE_CHECKING

from kinform.frozen import dataclass
from kinform.model.fingerprints import Fingerprints

if TYPE_CHECKING:
    from kinform.behaviour.from_design import Behaviour
    from kinform.model.assembly import Assembly
    from kinform.model.contacts import Contacts
    from kinform.model.findings import CheckReport
    from kinform.model.kinematics import Kinematics
    from kinform.model.mass import MassReport
    from kinform.model.simulation import Simulation
    from kinform.model.surfaces import MeshSurfaces


@dataclass(frozen=True, eq=False)
class Design:
    """The assembly and the results of the stages; None: not computed yet."""

    assembly: Assembly
    surfaces: dict[str, MeshSurfaces] = field(default_factory=dict)
    """By mesh digest; empty: not computed yet."""
    contacts: Contacts | None = None
    kinematics: Kinematics | None = None
    mass: MassReport | None = None
    behaviour: Behaviour | None = None
    """The port model, which is made with the simulation."""
    simulation: Simulation | None = None
    report: CheckReport | None = None
    fingerprints: Fingerprints = field(default_factory=Fingerprints)

    def has(self, field: str) -> bool:
        """Whether a stage has added this field."""
        return getattr(self, field) is not None

    @property
    def recorded(self) -> bool:
        """Whether this user's kinform computed all of it, or wrote the files that it was read from."""
        return self.fingerprints.recorded

    def of_origin(self, recorded: bool) -> Design:
        """The design, `recorded` or not."""
        return replace(self, fingerprints=replace(self.fingerprints, recorded=recorded))

    @property
    def contact_counts(self) -> tuple[int, int] | None:
        """How many patches and interferences there are; None before contacts are known."""
        contacts = self.contacts
        return None if contacts is None else (len(contacts.patches), len(contacts.interferences))

    @property
    def ranged(self) -> Kinematics | None:
        """The kinematics with the ranges of joints that the simulation found."""
        ranges = self.simulation.ranges if self.simulation is not None else None
        if self.kinematics is None or ranges is None:
            return self.kinematics
        of_joint = {item.joint: item for item in ranges}
        joints = tuple(
            replace(joint, range_lower=item.lower.value, range_upper=item.upper.value, range_status=item.status)
            if (item := of_joint.get(joint.name)) is not None
            else joint
            for joint in self.kinematics.joints
        )
        return replace(self.kinematics, joints=joints)

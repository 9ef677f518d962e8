"""What each component is called where the port model is data: in results files, in JSON, and on the screen."""

from __future__ import annotations

from kinform.behaviour.components import (
    Component,
    Damper,
    DcMotor,
    EffortDrive,
    EndStop,
    Gear,
    Ground,
    JointComponent,
    LoadComponent,
    MotionDrive,
    RigidBody,
    Servo,
    Spring,
    SpringDamper,
    System,
    VoltageController,
    VoltageSource,
)

__all__ = ["COMPONENTS", "kind_of"]

COMPONENTS: dict[str, type[Component]] = {
    "ground": Ground,
    "rigid_body": RigidBody,
    "joint": JointComponent,
    "motion": MotionDrive,
    "effort": EffortDrive,
    "spring": Spring,
    "damper": Damper,
    "end_stop": EndStop,
    "servo": Servo,
    "dc_motor": DcMotor,
    "voltage_source": VoltageSource,
    "voltage_controller": VoltageController,
    "spring_damper": SpringDamper,
    "gear": Gear,
    "load": LoadComponent,
    "system": System,
}

_NAMES = {cls: name for name, cls in COMPONENTS.items()}


def kind_of(component: Component) -> str:
    """The name of the component's kind. Raises ValueError for a kind that is none of kinform's."""
    try:
        return _NAMES[type(component)]
    except KeyError:
        raise ValueError(f'"{component.name}" is a {type(component).__name__}, which is no kind of component') from None

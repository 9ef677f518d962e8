"""Behaviour: the device as components with ports, joined at nodes. Data only; simulation solves it.

A port carries an across and a through variable whose product is power: for a frame the twist (the
derivative of ⟨p, R⟩) and the wrench (τ; f), for the shaft of a joint its rates and efforts. At a node
all across variables are equal and all through variables sum to zero. After section 3 of Sinha,
Paredis and Khosla, "Kinematics support for design and simulation of mechatronic systems" (2000).
"""

from __future__ import annotations

from kinform.behaviour.components import (
    Bushing,
    GasSpring,
    Gear,
    Ground,
    JointComponent,
    LoadComponent,
    RigidBody,
    SpringDamper,
    System,
)
from kinform.behaviour.counting import Count, count, counts
from kinform.behaviour.couplings import imposed_couplings
from kinform.behaviour.diagnosis import faults
from kinform.behaviour.drives_and_loads import one_freedom
from kinform.behaviour.from_design import Behaviour, build
from kinform.behaviour.model import Model
from kinform.behaviour.nested import flat, nest, placed
from kinform.behaviour.ports import Component, Node, Port
from kinform.behaviour.rubbing import Rubs
from kinform.behaviour.shafts import (
    Actor,
    Controller,
    Damper,
    DcMotor,
    EffortDrive,
    EndStop,
    Friction,
    MotionDrive,
    Servo,
    Spring,
    VoltageController,
    VoltageSource,
)
from kinform.behaviour.signals import Constant, Ramp, Signal, Sine, Table, signal, smooth

__all__ = [
    "CODE_VERSION",
    "Actor",
    "Behaviour",
    "Bushing",
    "Component",
    "Constant",
    "Controller",
    "Count",
    "Damper",
    "DcMotor",
    "EffortDrive",
    "EndStop",
    "Friction",
    "GasSpring",
    "Gear",
    "Ground",
    "JointComponent",
    "LoadComponent",
    "Model",
    "MotionDrive",
    "Node",
    "Port",
    "Ramp",
    "RigidBody",
    "Rubs",
    "Servo",
    "Signal",
    "Sine",
    "Spring",
    "SpringDamper",
    "System",
    "Table",
    "VoltageController",
    "VoltageSource",
    "build",
    "count",
    "counts",
    "faults",
    "flat",
    "imposed_couplings",
    "nest",
    "one_freedom",
    "placed",
    "signal",
    "smooth",
]

CODE_VERSION: int = 18
"""Bumped when results of this package change for the same input."""

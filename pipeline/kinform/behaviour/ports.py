"""Ports, components and nodes: what every part of the network has."""

from __future__ import annotations

from typing import ClassVar

from kinform.frozen import dataclass

FRAME = 6
"""Across: a twist (ω; v). Through: a wrench (τ; f)."""


@dataclass(frozen=True)
class Port:
    """A place where a component exchanges power: so many across and as many through variables."""

    name: str
    size: int


@dataclass(frozen=True)
class Component:
    """Something with ports. `name` is unique in its system; `subject` is what the user calls it."""

    PORTS: ClassVar[tuple[Port, ...]] = (Port("frame", FRAME),)
    """Ports of all components of the kind, where they are the same for all."""

    name: str
    subject: str

    @property
    def ports(self) -> tuple[Port, ...]:
        """Its ports in their fixed order."""
        return self.PORTS

    @property
    def equations(self) -> int:
        """How many equations its behaviour makes between its port variables: one for each across and through pair."""
        return sum(port.size for port in self.ports)


@dataclass(frozen=True)
class Node:
    """Ports joined: across variables equal, through variables summing to zero."""

    ports: tuple[tuple[str, str], ...]
    """(component, port) by name."""
    size: int

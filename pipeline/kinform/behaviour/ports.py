"""Ports, components and nodes: what every part of the network has."""

from __future__ import annotations

from dataclasses import dataclass

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

    name: str
    subject: str

    @property
    def ports(self) -> tuple[Port, ...]:
        """Its ports in their fixed order."""
        return (Port("frame", FRAME),)

    @property
    def equations(self) -> int:
        """How many equations its behaviour makes between its port variables."""
        return FRAME


@dataclass(frozen=True)
class Node:
    """Ports joined: across variables equal, through variables summing to zero."""

    ports: tuple[tuple[str, str], ...]
    """(component, port) by name."""
    size: int

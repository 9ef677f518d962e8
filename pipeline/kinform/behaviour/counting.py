"""Counts the unknowns and the equations of a system: a model with unequal numbers cannot be solved."""

from __future__ import annotations

from collections.abc import Iterator

from kinform.behaviour.components import System
from kinform.frozen import dataclass


@dataclass(frozen=True)
class Count:
    """Numbers at the level of rates and efforts."""

    unknowns: int
    """Across and through variables of all ports."""
    of_components: int
    """Equations that the components make."""
    of_nodes: int
    """Kirchhoff's laws: at a node of k ports, k − 1 equal across variables and one sum, times its size."""
    of_surroundings: int = 0
    """What is outside makes as many equations as the exposed ports have pairs of variables; with nothing there the
    through variables are zero."""

    @property
    def equations(self) -> int:
        """All equations."""
        return self.of_components + self.of_nodes + self.of_surroundings

    @property
    def balanced(self) -> bool:
        """As many equations as unknowns."""
        return self.unknowns == self.equations


def count(system: System) -> Count:
    """Unknowns and equations of the system, on its own level: a system inside counts as one component."""
    outside = sum(port.size for port in system.ports)
    return Count(
        unknowns=sum(2 * port.size for c in system.components for port in c.ports) + 2 * outside,
        of_components=sum(c.equations for c in system.components),
        of_nodes=sum(node.size * len(node.ports) for node in system.nodes) + outside,
        of_surroundings=outside,
    )


def counts(system: System) -> tuple[tuple[str, Count], ...]:
    """(path, count) of the system and of all systems inside, outer ones first; the system itself is ""."""

    def walk(inner: System, path: str) -> Iterator[tuple[str, Count]]:
        yield path, count(inner)
        for deeper in inner.systems:
            yield from walk(deeper, f"{path}/{deeper.subject}" if path else deeper.subject)

    return tuple(walk(system, ""))

"""Counts the unknowns and the equations of a system: a model with unequal numbers cannot be solved."""

from __future__ import annotations

from dataclasses import dataclass

from kinform.behaviour.components import System

__all__ = ["Count", "count"]


@dataclass(frozen=True)
class Count:
    """Numbers at the level of rates and efforts."""

    unknowns: int
    """Across and through variables of all ports."""
    of_components: int
    """Equations that the components make."""
    of_nodes: int
    """Kirchhoff's laws: at a node of k ports, k − 1 equal across variables and one sum, times its size."""

    @property
    def equations(self) -> int:
        """All equations."""
        return self.of_components + self.of_nodes

    @property
    def balanced(self) -> bool:
        """As many equations as unknowns."""
        return self.unknowns == self.equations


def count(system: System) -> Count:
    """Unknowns and equations of the system."""
    return Count(
        unknowns=sum(2 * port.size for c in system.components for port in c.ports),
        of_components=sum(c.equations for c in system.components),
        of_nodes=sum(node.size * len(node.ports) for node in system.nodes),
    )

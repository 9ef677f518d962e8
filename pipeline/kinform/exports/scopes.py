"""Which sub-assembly each component belongs to, so that an export can keep the hierarchy.

The port model says so by its systems in systems (`kinform.behaviour.homes`). Scopes are named as in the assembly
("arm/motor"); "" is the whole.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from kinform.behaviour import System
from kinform.exports.model import ExportModel

__all__ = ["Scope", "Scopes", "scope_of"]

Scope = str


@dataclass(frozen=True)
class Scopes:
    """Scopes that hold components, and those around them, outer ones first."""

    paths: tuple[Scope, ...]
    of: dict[str, Scope]
    """By name of component."""
    tops: dict[str, Scope]
    """By name of body: the outermost scope from which it is used."""

    def top_of(self, body: str) -> Scope:
        """The outermost scope from which a body is used."""
        return self.tops[body]

    def above(self, scope: Scope) -> Scope:
        """The scope around a scope."""
        return max((p for p in self.paths if p != scope and _within(scope, p)), key=len)

    def between(self, top: Scope, home: Scope) -> tuple[Scope, ...]:
        """The scopes below `top` down to `home`, outer ones first."""
        return tuple(p for p in self.paths if _within(home, p) and _within(p, top) and p != top)


def scope_of(model: ExportModel) -> Scopes:
    """The scopes of a model's components: the systems of the port model that sub-assemblies made."""
    system = model.system
    of = dict(_homes(model.nested, ""))
    tops = {}
    for body in system.bodies:
        users = [of[other.name] for other, _ in system.at(body.name, "frame")]
        tops[body.name] = min([of[body.name], *users], key=len)
    steps = [home.split("/") for home in of.values() if home]
    used = {""} | {"/".join(path[: k + 1]) for path in steps for k in range(len(path))}
    return Scopes(tuple(sorted(used, key=lambda path: (len(path.split("/")) if path else 0, path))), of, tops)


def _homes(system: System, path: Scope) -> Iterator[tuple[str, Scope]]:
    """(name of component, scope) of all components in a system and those inside."""
    for component in system.components:
        if isinstance(component, System):
            yield from _homes(component, f"{path}/{component.subject}" if path else component.subject)
        else:
            yield component.name, path


def _within(inner: Scope, outer: Scope) -> bool:
    return outer == "" or inner == outer or inner.startswith(f"{outer}/")

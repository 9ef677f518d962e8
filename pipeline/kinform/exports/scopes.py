"""Which sub-assembly each component belongs to, so that an export can keep the hierarchy.

A body belongs to the innermost sub-assembly that holds all of its parts, a joint to the innermost one that
holds both bodies, what acts on a joint to the joint's, a load to its body's. Scopes are named as in the
assembly ("arm/motor"); "" is the whole.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

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
    """The scopes of a model's components."""
    system = model.system
    known = [sub.name for sub in model.assembly.subassemblies]
    parts = {str(body.name): body.parts for body in model.kinematics.bodies}
    of: dict[str, Scope] = {}
    for body in system.bodies:
        of[body.name] = _common(parts[body.subject], known)
    for joint in system.joints:
        of[joint.name] = _shared([of[system.body_at(joint.name, port).name] for port in ("a", "b")], known)
        for actor in system.actors(joint.name):
            of[actor.name] = of[joint.name]
    for gear in system.gears:
        of[gear.name] = _shared([of[system.joint_at(gear.name, port).name] for port in ("a", "b")], known)
    for load in system.loads:
        of[load.name] = of[system.body_at(load.name, "frame").name]
    tops = {}
    for body in system.bodies:
        users = [of[other.name] for other, _ in system.at(body.name, "frame")]
        tops[body.name] = min([of[body.name], *users], key=len)
    used = {""} | {scope for home in of.values() for scope in known if _within(home, scope)}
    return Scopes(tuple(sorted(used, key=lambda path: (len(path.split("/")) if path else 0, path))), of, tops)


def _within(inner: Scope, outer: Scope) -> bool:
    return outer == "" or inner == outer or inner.startswith(f"{outer}/")


def _common(names: Iterable[str], known: Iterable[Scope]) -> Scope:
    """The innermost sub-assembly that holds all these parts."""
    held = [scope for scope in known if all(name.startswith(f"{scope}/") for name in names)]
    return max(held, key=len, default="")


def _shared(scopes: list[Scope], known: Iterable[Scope]) -> Scope:
    """The innermost sub-assembly around all these scopes."""
    held = [scope for scope in known if all(_within(inner, scope) for inner in scopes)]
    return max(held, key=len, default="")

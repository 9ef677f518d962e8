"""The structure of a VHDL-AMS system: entities of scopes, with what they declare, hold and pass on.

Names are chosen here, and equations are counted: as many as unknowns, in every entity of the library.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field
from string import ascii_lowercase
from typing import Any

from kinform.behaviour import System
from kinform.exports.equations import Equations
from kinform.exports.model import ExportModel
from kinform.exports.names import VHDL, identifiers
from kinform.exports.text import vector
from kinform.frozen import dataclass

COUNT = {
    "ground": 16, "rigid_body": 34, "massless_frame": 22, "fixed_joint": 36, "revolute_joint": 47,
    "prismatic_joint": 41, "screw_joint": 47, "cylindrical_joint": 49, "planar_joint": 57, "universal_joint": 52,
    "spherical_joint": 45, "closure": 60, "load": 21, "spring": 1, "damper": 1, "gear": 2, "servo": 6, "dc_motor": 2,
    "voltage_controller": 6,
    **{
        f"{kind}_{law}": 1
        for kind in ("motion", "effort", "target", "voltage")
        for law in ("constant", "ramp", "sine")
    },
}  # fmt: skip
"""Equations of each entity, as many as its unknowns: through quantities, and quantities that are not inputs."""

AXES = ("x", "y", "z", "rx", "ry", "rz")

_FRAME = ("", "_i", "_q", "_q_start", *(f"_{axis}" for axis in AXES))
_SHAFT = ("", "_effort", "_start", "_rate_start", "_given", "_held_effort", "_held_level", "_held_i")
_PLACES = tuple(f"{what}{k}" for what in ("n", "place", "turn") for k in (1, 2, 3))
_SUFFIXES = (
    *_FRAME,
    *(f"_end{suffix}" for suffix in _FRAME),
    *(f"_{coordinate}{suffix}" for coordinate in ("angle", "angle2", "distance", "u", "v") for suffix in _SHAFT),
    *(f"_closure{suffix}" for suffix in ("", "_s", *(f"_{place}" for place in _PLACES))),
    *(
        f"_{name}"
        for name in (
            "m c inertia n s n1 n2 n3 lead w_start given effort level offset slope amplitude speed phase stiffness "
            "rest damping ratio a_effort b_effort force torque turning kp ki kd bound resistance inductance coupling "
            "gear p"
        ).split()
    ),
    *(f"_{letter}_effort" for letter in ascii_lowercase[2:]),
    *(f"_ratio_{letter}" for letter in ascii_lowercase[2:]),
    *(
        f"_{source}{suffix}"
        for source in ("target", "supply")
        for suffix in "_i _level _offset _slope _amplitude _speed _phase _kp _ki _kd _bound".split()
    ),
    "_target",
)
"""What is appended to the name of a component, so that no two names meet."""


Scope = str


@dataclass(frozen=True)
class Scopes:
    """Scopes that hold components, and those around them, outer ones first.

    They are the systems that sub-assemblies made, named as in the assembly ("arm/motor"); "" is the whole.
    """

    paths: tuple[Scope, ...]
    of: dict[str, Scope]
    """By name of component."""
    top_of: dict[str, Scope]
    """By name of body: the outermost scope from which it is used."""

    def above(self, scope: Scope) -> Scope:
        """The scope around a scope."""
        return max((p for p in self.paths if p != scope and _within(scope, p)), key=len)

    def between(self, top: Scope, home: Scope) -> tuple[Scope, ...]:
        """The scopes below `top` down to `home`, outer ones first."""
        return tuple(p for p in self.paths if _within(home, p) and _within(p, top) and p != top)


def scopes_of(model: ExportModel) -> Scopes:
    """The scopes of a model's components."""
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


@dataclass
class Generic:
    """A generic with its default."""

    name: str
    type: str
    value: str


@dataclass
class Part:
    """An instance of an entity."""

    label: str
    entity: str
    text: str
    generics: dict[str, str] = field(default_factory=dict)
    ports: dict[str, str] = field(default_factory=dict)


@dataclass
class Structure:
    """The entity of a scope."""

    entity: str
    text: str
    generics: list[Generic] = field(default_factory=list)
    ports: list[str] = field(default_factory=list)
    declarations: list[str] = field(default_factory=list)
    parts: list[Part] = field(default_factory=list)
    statements: list[str] = field(default_factory=list)


class Writer:
    """Collects the entities of the scopes as components are added."""

    def __init__(self, equations: Equations):
        """An architecture without statements: names, scopes and nodes of all components are settled here."""
        self.equations = equations
        model = self.model = equations.model
        system = model.system
        self.names = identifiers(
            [component.name for component in system.components],
            VHDL,
            beside=("mechanics", "gravity", *COUNT),
            suffixes=_SUFFIXES,
        )
        self.scopes = scopes_of(model)
        paths = self.scopes.paths
        tables = (f"table_{name}{end}" for name in self.names.values() for end in ("", "_target", "_supply"))
        called = {path: f"/{path}" if path else model.name for path in paths}
        entities = identifiers(called.values(), VHDL, beside=("mechanics", "components", *COUNT, *tables))
        self.entity = {path: entities[called[path]] for path in paths}
        self.of: dict[Scope, Structure] = {
            path: Structure(self.entity[path], f"sub-assembly {path}" if path else f"the system {model.name}")
            for path in paths
        }
        self.starts: dict[str, str] = {}
        self.tables: list[dict[str, Any]] = []
        self.equations_made = 0
        self.potentials = 0
        self.efforts: dict[str, tuple[Scope, list[str]]] = {}
        self.passed: dict[str, Scope] = {}
        """The scope in which a quantity is declared that was passed up."""

    def node(self, name: str, home: Scope, top: Scope) -> None:
        """Declare a frame's terminals and orientation in `top`, and pass them down to `home`."""
        self.potentials += 6
        self.of[top].declarations += [
            f"terminal {name}_x, {name}_y, {name}_z : translational",
            f"terminal {name}_rx, {name}_ry, {name}_rz : rotational",
            f"quantity {name}_q : quaternion",
        ]
        for scope in self.scopes.between(top, home):
            self.of[scope].ports += [
                f"terminal {name}_x, {name}_y, {name}_z : translational",
                f"terminal {name}_rx, {name}_ry, {name}_rz : rotational",
                f"quantity {name}_q : out quaternion",
            ]
            self.child(scope).ports.update({f"{name}_{axis}": f"{name}_{axis}" for axis in (*AXES, "q")})

    def pass_up(self, name: str, home: Scope, top: Scope) -> None:
        """Make a real quantity that is declared in `home` known in `top`."""
        at = self.passed.get(name, home)
        scopes = self.scopes.between(top, at)
        if not scopes:
            return
        self.of[at].declarations.remove(f"quantity {name} : real")
        self.of[top].declarations.append(f"quantity {name} : real")
        self.passed[name] = top
        for scope in scopes:
            self.of[scope].ports.append(f"quantity {name} : out real")
            self.child(scope).ports[name] = name

    def pass_down(self, name: str, top: Scope, home: Scope) -> None:
        """Declare a real quantity in `top`, known down to `home`."""
        self.of[top].declarations.append(f"quantity {name} : real")
        for scope in self.scopes.between(top, home):
            self.of[scope].ports.append(f"quantity {name} : in real")
            self.child(scope).ports[name] = name

    def child(self, scope: Scope) -> Part:
        """The instance of a scope in the one above."""
        above = self.of[self.scopes.above(scope)]
        label = f"sub_{self.entity[scope]}"
        for part in above.parts:
            if part.label == label:
                return part
        above.parts.append(Part(label, self.entity[scope], f"sub-assembly {scope}"))
        return above.parts[-1]

    def generic(self, scope: Scope, name: str, kind: str, value: str, start: str | None = None) -> str:
        """A generic of a scope's entity; its name. `start`: what the bench gives it instead."""
        self.of[scope].generics.append(Generic(name, kind, value))
        if start is not None and start != value:
            self._give(scope, name, start)
        return name

    def generics(self, scope: Scope, label: str, values: Mapping[str, tuple[str, str]]) -> dict[str, str]:
        """Generics of a component by what they are there: (type, value), called as the component and that."""
        return {name: self.generic(scope, f"{label}_{name}", kind, value) for name, (kind, value) in values.items()}

    def gravity(self, scope: Scope) -> str:
        """The generic with the gravity of a scope."""
        if not any(row.name == "gravity" for row in self.of[scope].generics):
            self.generic(scope, "gravity", "vector3", "(" + vector(self.model.gravity, ", ") + ")")
        return "gravity"

    def _give(self, scope: Scope, name: str, start: str) -> None:
        """Give a generic its start: in the bench, or in the instance of the sub-assembly."""
        if scope == self.scopes.paths[0]:
            self.starts[name] = start
        else:
            self.child(scope).generics[name] = start

    def add(self, scope: Scope, part: Part) -> None:
        """Add an instance of a library entity."""
        self.of[scope].parts.append(part)
        self.equations_made += COUNT.get(part.entity, 1)

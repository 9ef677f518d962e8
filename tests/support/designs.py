"""Random designs, made from the annotations of the model, so that a new field is drawn without being told."""

from __future__ import annotations

import dataclasses
import functools
import struct
import types
import typing
from typing import Any

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from kinform.behaviour import Behaviour, Controller, Model, nest
from kinform.behaviour.signals import Constant, Ramp, Sine, Table
from kinform.design import Design
from kinform.model.assembly import Assembly, MassOverride, Mesh, MeshHealth, Part
from kinform.model.contacts import Contacts, Patch
from kinform.model.descriptions import DescribedLink, StatedMass
from kinform.model.findings import CheckReport
from kinform.model.fingerprints import Fingerprints
from kinform.model.function import Law
from kinform.model.kinematics import ConstraintMatrix, Joint, Kinematics, Meshing, Mobility, Redundancy, Release
from kinform.model.mass import MassProperties, MassReport
from kinform.model.simulation import Simulation
from kinform.model.springs import StatedSpring
from kinform.model.surfaces import MeshSurfaces, Surface

texts = st.text(max_size=6) | st.sampled_from(
    ["", "base", "yaw_motor/stator", "../a", "[m6]", "Ø 3 – né", "␀", "␀x", "nul\0nul", "\udcff", "'\"\\", "a\nb"]
)
reals = st.floats(allow_nan=True, allow_infinity=True)
integers = st.integers(-(2**62), 2**62)
counts = st.integers(0, 2**40)
json_values = st.recursive(
    st.none() | st.booleans() | integers | st.floats(allow_nan=False) | texts,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(texts, inner, max_size=3),
    max_leaves=6,
)


def array(*shape: int, dtype: Any = np.float64) -> st.SearchStrategy[Any]:
    """Arrays of this shape: any bits for floats, small numbers for integers."""
    elements = reals if dtype is np.float64 else st.integers(-5, 10**6)
    return hnp.arrays(dtype, shape, elements=elements)


def whole(*shape: int) -> st.SearchStrategy[Any]:
    """Arrays of integers."""
    return array(*shape, dtype=np.int64)


def lists(item: st.SearchStrategy[Any], size: int = 3) -> st.SearchStrategy[Any]:
    """Tuples of up to so many items."""
    return st.lists(item, max_size=size).map(tuple)


NAMED = {
    kind.__name__: kind
    for kind in (Assembly, Behaviour, CheckReport, Contacts, Kinematics, MassReport, MeshSurfaces, Simulation)
}
"""Types that modules name in annotations only."""


def of(cls: Any, **given: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    """Records of the class; fields that are not given are drawn by their annotation."""
    hints = typing.get_type_hints(cls, localns=NAMED)
    fields = [field.name for field in dataclasses.fields(cls)]
    return st.builds(cls, **{name: given[name] if name in given else by_type(hints[name]) for name in fields})


@functools.cache
def by_type(hint: Any) -> st.SearchStrategy[Any]:
    """Values of an annotated type; arrays are vectors of three."""
    if hasattr(hint, "__supertype__"):
        return by_type(hint.__supertype__)
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if origin in (types.UnionType, typing.Union):
        kinds = [kind for kind in arguments if kind is not type(None)]
        return st.none() | (counts if kinds == [int] else by_type(kinds[0]))
    if origin is tuple and arguments[-1] is Ellipsis:
        return lists(by_type(arguments[0]))
    if origin is tuple:
        return st.tuples(*map(by_type, arguments))
    if origin is typing.Literal:
        return st.sampled_from(arguments)
    if origin is dict:
        values = json_values if arguments[1] is Any else by_type(arguments[1]).filter(lambda value: value == value)
        return st.dictionaries(texts, values, max_size=3)
    if origin is np.ndarray:
        return hnp.arrays(np.bool_, 3) if typing.get_args(arguments[1]) == (np.bool_,) else array(3)
    if dataclasses.is_dataclass(hint):
        return SPECIAL[hint]() if hint in SPECIAL else of(hint)
    return {str: texts, float: reals, int: integers, bool: st.booleans()}[hint]


def stated_springs() -> st.SearchStrategy[StatedSpring]:
    """Springs and bushings as the designer states them."""
    return of(StatedSpring, axes=st.none() | array(3, 3))


def masses() -> st.SearchStrategy[MassOverride]:
    """Stated masses."""
    return of(MassOverride, inertia=array(3, 3))


def stated_masses() -> st.SearchStrategy[StatedMass]:
    """Inertials in the numbers of their file."""
    return of(StatedMass, inertia=st.none() | array(6))


def links() -> st.SearchStrategy[DescribedLink]:
    """Links of descriptions."""
    return of(DescribedLink, rotation=array(3, 3))


@st.composite
def parts(draw: Any) -> tuple[Part, ...]:
    """Parts of which some share a mesh and some have none."""
    meshes = [
        draw(of(Mesh, vertices=array(v, 3), faces=whole(f, 3), digest=st.just(f"digest {i}"), health=of(MeshHealth)))
        for i, (v, f) in enumerate(draw(st.lists(st.tuples(st.integers(0, 3), st.integers(0, 3)), max_size=2)))
    ]
    mesh = st.sampled_from([None, *meshes])
    override = st.none() | masses()
    names = draw(st.lists(texts, max_size=3, unique=True))
    return tuple(
        draw(of(Part, name=st.just(name), mesh=mesh, X_WP=array(4, 4), override=override)) for name in sorted(names)
    )


@st.composite
def laws(draw: Any) -> Law:
    """Laws; tables have as many values as times."""
    n = draw(st.integers(0, 3))
    numbers = st.lists(reals, min_size=n, max_size=n).map(tuple)
    return draw(of(Law, times=numbers, values=numbers))


@st.composite
def surfaces_of(draw: Any, digest: str) -> MeshSurfaces:
    """Surfaces of one mesh."""
    own = lists(of(Surface, faces=st.integers(0, 3).flatmap(whole)))
    return draw(of(MeshSurfaces, digest=st.just(digest), surfaces=own, labels=st.integers(0, 4).flatmap(whole)))


@st.composite
def patches(draw: Any) -> Patch:
    """Patches with any number of samples, none included."""
    n = draw(st.integers(0, 3))
    return draw(of(Patch, points=array(n, 3), normals=array(n, 3), gaps=array(n), weights=array(n)))


@st.composite
def contacts(draw: Any) -> Contacts:
    """Contacts; every candidate pair has its tolerance."""
    pairs = tuple(sorted(draw(st.sets(st.tuples(texts, texts), max_size=3))))
    tolerance = {pair: draw(reals) for pair in pairs}
    return draw(of(Contacts, candidates=st.just(pairs), tolerance=st.just(tolerance)))


@st.composite
def joints(draw: Any) -> Joint:
    """Joints with as many twists as freedoms."""
    n = draw(st.integers(0, 6))
    indices = lists(st.integers(0, 99))
    return draw(
        of(
            Joint,
            freedoms=st.just(n),
            twists=array(n, 6),
            at_rest=array(n, 6),
            closed=array(n, 6),
            singular_values=array(6),
            patches=indices,
        )
    )


@st.composite
def matrices(draw: Any) -> ConstraintMatrix:
    """Constraint matrices; the layout matters here, not the values."""
    rows, entries = draw(st.integers(0, 3)), draw(st.integers(0, 4))
    given = {"data": array(entries), "indices": whole(entries), "indptr": whole(rows + 1)}
    return draw(of(ConstraintMatrix, **given, patch=whole(rows), sample=whole(rows)))


@st.composite
def mobilities(draw: Any) -> Mobility:
    """Mobilities with a basis of any size."""
    return draw(of(Mobility, freedoms=array(draw(st.integers(0, 2)), draw(st.integers(0, 2)), 6)))


def meshings() -> st.SearchStrategy[Any]:
    """Teeth."""
    return of(Meshing, normals=array(2, 3))


def releases() -> st.SearchStrategy[Any]:
    """Ways out of contact."""
    return of(Release, twist=array(6))


@st.composite
def redundancies(draw: Any) -> Redundancy:
    """Redundancies with any number of wrenches."""
    return draw(of(Redundancy, wrenches=array(draw(st.integers(0, 3)), 6), patches=lists(st.integers(0, 99))))


def mass_properties() -> st.SearchStrategy[Any]:
    """Mass properties, known or not."""
    return of(MassProperties, inertia=array(3, 3), principal_axes=array(3, 3))


@st.composite
def simulations(draw: Any) -> Simulation:
    """Runs of any length, none included."""
    t, b, j, n = (draw(st.integers(0, 3)) for _ in range(4))
    named = {
        "body_names": st.lists(texts, min_size=b, max_size=b).map(tuple),
        "joint_names": st.lists(texts, min_size=j, max_size=j).map(tuple),
        "joint_types": st.lists(texts, min_size=j, max_size=j).map(tuple),
    }
    arrays = {"time": array(t), "p_WB": array(t, b, 3), "q_WB": array(t, b, 4), "joint_offset": whole(j + 1)}
    values = {name: array(t, n) for name in ("joint_position", "joint_velocity", "joint_effort")}
    monitors = {"energy": array(t, 3), "residual": array(t), "rank": whole(t), "balance": array(t)}
    return draw(of(Simulation, **named, **arrays, **values, **monitors))


def signals() -> st.SearchStrategy[Any]:
    """Laws of time."""
    tables = st.lists(st.tuples(reals, reals), min_size=1, max_size=3).map(
        lambda rows: Table(tuple(t for t, _ in rows), tuple(x for _, x in rows))
    )
    return st.builds(Constant, reals) | st.builds(Ramp, reals, reals) | st.builds(Sine, *[reals] * 4) | tables


@st.composite
def behaviours(draw: Any) -> Behaviour:
    """Port models with some of all kinds of components, under any names, in systems of any depth."""
    names = iter(draw(st.lists(texts, min_size=30, max_size=30, unique=True)))
    number = lambda: draw(reals)
    vector = lambda: draw(array(3))
    model, base, body, last = Model(), next(names), next(names), next(names)
    model.ground(base)
    model.body(body, draw(st.none() | reals), vector(), draw(array(3, 3)))
    model.body(last, number(), vector(), draw(array(3, 3)))
    axes = {"axis": draw(st.sampled_from([(0, 0, 1), (0, 1, 0)])), "axis2": (1, 0, 0)}
    joint, other = next(names), next(names)
    model.joint(joint, base, body, draw(st.sampled_from(["revolute", "prismatic"])), **axes, point=vector())
    model.joint(other, body, last, "screw", **axes, point=vector(), pitch=number())
    kinds = ["fixed", "cylindrical", "spherical", "planar", "universal"]
    model.joint(next(names), base, last, draw(st.sampled_from(kinds)), **axes, point=vector(), pitch=None)
    motor, gains = next(names), Controller(number(), number(), number(), number())
    model.motor(motor, joint, number(), number(), number(), number())
    extra = [
        lambda n: model.motion(n, other, draw(signals())), lambda n: model.effort(n, other, draw(signals())),
        lambda n: model.spring(n, other, number(), number()), lambda n: model.damper(n, other, number()),
        lambda n: model.stop(n, other, number(), number()), lambda n: model.gear(n, joint, other, number()),
        lambda n: model.gear(n, joint, other, number(), pitch_point=vector(), flanks=(vector(), vector())),
        lambda n: model.servo(n, other, draw(signals()), gains), lambda n: model.voltage(n, motor, draw(signals())),
        lambda n: model.controller(n, motor, joint, draw(signals()), gains),
        lambda n: model.spring_between(n, base, last, (vector(), vector()), number(), number(), number()),
        lambda n: model.load(n, body, vector(), vector(), vector(), turning=draw(st.booleans())),
        lambda n: model.load(n, body, vector(), vector(), vector(), signal=draw(signals())),
        lambda n: model.gas_spring(n, base, last, (vector(), vector()), *(number() for _ in range(5))),
        lambda n: model.bushing(n, base, last, vector(), *(vector() for _ in range(4)), axes=draw(array(3, 3))),
    ]  # fmt: skip
    for k in draw(st.lists(st.sampled_from(range(len(extra))), max_size=12)):
        extra[k](next(names))
    system = model.system()
    paths = st.sampled_from(["", "arm", "arm/motor", "leg", "leg/motor/core"])
    homes = {component.name: draw(paths) for component in system.components}
    reasons = lists(st.tuples(texts, texts))
    return Behaviour(system, nest(system, homes), draw(reasons), draw(reasons))


def reports() -> st.SearchStrategy[CheckReport]:
    """Reports of results that this user's kinform wrote: the file does not say where it comes from."""
    return of(CheckReport, origin=st.just("recorded"), strict=st.just(False))


SPECIAL: dict[Any, Any] = {
    CheckReport: reports, StatedMass: stated_masses, StatedSpring: stated_springs,
    DescribedLink: links,
    Law: laws, MassOverride: masses, Patch: patches, Contacts: contacts, Joint: joints, ConstraintMatrix: matrices,
    Behaviour: behaviours, Meshing: meshings, Mobility: mobilities, Redundancy: redundancies,
    Release: releases, MassProperties: mass_properties, Simulation: simulations,
}  # fmt: skip


@st.composite
def designs(draw: Any) -> Design:
    """Designs in which any stage may have run."""
    assembly = draw(of(Assembly, parts=parts()))
    digests = draw(st.lists(texts, max_size=2, unique=True))
    surfaces = {digest: draw(surfaces_of(digest)) for digest in digests}
    found = draw(st.none() | contacts())
    stages = draw(st.dictionaries(st.just("assembly"), st.text("0123456789abcdef", min_size=1)))
    pairs = {pair: draw(texts) for pair in (found.candidates if found else ())}
    meshes = {digest: draw(texts) for digest in digests}
    kinematics = st.none() | of(Kinematics)
    return draw(
        of(
            Design,
            assembly=st.just(assembly),
            surfaces=st.just(surfaces),
            contacts=st.just(found),
            kinematics=kinematics,
            fingerprints=st.just(Fingerprints(stages, meshes, pairs)),
        )
    )


def difference(one: Any, two: Any, where: str = "design") -> str | None:
    """Where two values differ, to the last bit and in their types; None where they do not."""
    if type(one) is not type(two):
        return f"{where}: {type(one).__name__} and {type(two).__name__}"
    if dataclasses.is_dataclass(one):
        names = [field.name for field in dataclasses.fields(one)]
        return _first(difference(getattr(one, name), getattr(two, name), f"{where}.{name}") for name in names)
    if isinstance(one, dict):
        if set(one) != set(two):
            return f"{where}: keys {sorted(one)} and {sorted(two)}"
        return _first(difference(one[key], two[key], f"{where}[{key!r}]") for key in one)
    if isinstance(one, (tuple, list)):
        if len(one) != len(two):
            return f"{where}: {len(one)} and {len(two)} items"
        return _first(difference(a, b, f"{where}[{i}]") for i, (a, b) in enumerate(zip(one, two, strict=True)))
    if isinstance(one, np.ndarray):
        same = one.shape == two.shape and one.dtype == two.dtype and one.tobytes() == two.tobytes()
        return None if same else f"{where}: {one!r} and {two!r}"
    if isinstance(one, float):
        return None if struct.pack("<d", one) == struct.pack("<d", two) else f"{where}: {one!r} and {two!r}"
    return None if one == two else f"{where}: {one!r} and {two!r}"


def _first(found: Any) -> str | None:
    return next((item for item in found if item is not None), None)


def arrays_in(value: Any) -> list[np.ndarray]:
    """Every array inside a value."""
    if isinstance(value, np.ndarray):
        return [value]
    if dataclasses.is_dataclass(value):
        return [a for field in dataclasses.fields(value) for a in arrays_in(getattr(value, field.name))]
    if isinstance(value, dict):
        return [a for item in value.values() for a in arrays_in(item)]
    return [a for item in value for a in arrays_in(item)] if isinstance(value, (tuple, list)) else []

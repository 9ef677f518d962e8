"""Small assemblies and contacts by hand, for tests of the kinematics stage."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinform.model.assembly import Assembly, Assumption, Group, Mesh, MeshHealth, Part, Source
from kinform.model.contacts import Contacts
from kinform.model.function import Function, IntendedJoint
from kinform.model.tolerances import Tolerances

HERE = Source("m.toml", 1)


def mesh(volume=1e-6):
    corners = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]], float)
    health = MeshHealth(4, 4, True, True, "NoError", volume, 0, 0, 0, 0, 1, 1e-7)
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    return Mesh(corners, faces, health, "p.stl", None, f"{volume}")


def part(name, *, volume=1e-6, density=1000.0, stick=False):
    form = None if stick else mesh(volume)
    return Part(name, form, np.eye(4), True, None, None if stick else density, None, "m", HERE)


def assembly(*parts, groups=(), assume=(), ground=None, joints=(), mobility=None):
    return Assembly(
        name="test",
        units="m",
        parts=tuple(sorted(parts, key=lambda p: p.name)),
        groups=tuple(Group(name, tuple(members), HERE) for name, members in groups),
        assumptions=tuple(assume),
        ground=ground,
        tolerances=Tolerances(),
        infer_fasteners=False,
        function=Function(mobility=mobility, joints=tuple(joints)),
        simulation=None,
        subassemblies=(),
        source=HERE,
        files=(),
    )


def contacts(*patches):
    ordered = tuple(sorted(patches, key=lambda p: p.parts))
    pairs = tuple(sorted({p.parts for p in ordered}))
    return Contacts(ordered, (), pairs, dict.fromkeys(pairs, 5e-4))


def between(patch, a, b):
    """The patch between other parts; the normal points out of the first by name."""
    if a < b:
        return replace(patch, parts=(a, b))
    return replace(patch, parts=(b, a), normals=-patch.normals)


def intended(name, a, b, kind="revolute", axis=(0, 0, 1), point=(0, 0, 0)):
    axis = None if axis is None else np.asarray(axis, float)
    return IntendedJoint(name, (a, b), kind, axis, None, np.asarray(point, float), None, None, "m.toml", 9)


def assume(a, b, kind, *, axis=None, point=None, ignore=False):
    vector = lambda x: None if x is None else np.asarray(x, float)
    return Assumption((a, b), kind, ignore, vector(axis), vector(point), None, "because", HERE)

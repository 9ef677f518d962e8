"""Meshes that are recovered together: each has the surfaces that it has alone, to the last bit."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest
from support.diagonal import first
from support.meshes import mesh_of, of_manifold
from support.solids import block, centred_rod

from kinform.model.tolerances import Tolerances
from kinform.surfaces import packs, recover, recover_all
from kinform.surfaces.recovery import PACK


def meshes():
    """Of several sizes and noises, one of them empty of facets."""
    from manifold3d import Manifold

    plate = block(0.06, 0.04, 0.01) - centred_rod(0.008, 0.02, 32).translate((0.01, 0, 0))
    slotted = (block(0.05, 0.03, 0.02) - centred_rod(0.006, 0.05, 24)) - block(0.002, 0.05, 0.05)
    cone = Manifold.cylinder(0.02, 0.01, 0.004, 40) + Manifold.sphere(0.006, 48).translate((0, 0, 0.02))
    ring = Manifold.revolve(Manifold.sphere(0.003, 32).slice(0.0).translate((0.012, 0)), 48)
    made = [of_manifold(solid) for solid in (plate, cone, ring, slotted, centred_rod(0.004, 0.03, 12))]
    made += [scattered(plate), of_manifold(ring, scale=1e-3), of_manifold(slotted, scale=250.0)]
    return made


def scattered(solid):
    mesh = solid.to_mesh64()
    points = np.asarray(mesh.vert_properties)[:, :3]
    return mesh_of(points + np.random.default_rng(3).normal(scale=1e-5, size=points.shape), mesh.tri_verts)


def parts_of(found):
    """Everything in it, as bytes."""
    yield found.digest.encode()
    yield found.labels.tobytes()
    yield np.float64(found.noise).tobytes()
    for surface in found.surfaces:
        for field in fields(surface):
            value = getattr(surface, field.name)
            yield value.encode() if isinstance(value, str) else np.asarray(value).tobytes()


@pytest.fixture(scope="module")
def alone():
    return [(mesh, list(parts_of(recover(mesh, Tolerances())))) for mesh in meshes()]


@pytest.mark.parametrize("seed", first(2, range(6)))
def test_neither_company_nor_order_changes_a_bit(alone, seed):
    draw = np.random.default_rng(seed)
    some = draw.permutation(len(alone))[: draw.integers(2, len(alone) + 1)]
    together = recover_all([alone[k][0] for k in some], Tolerances())
    for k, found in zip(some, together, strict=True):
        assert list(parts_of(found)) == alone[k][1]


def test_there_are_surfaces_of_every_kind(alone):
    kinds = {surface.kind for mesh, _ in alone for surface in recover(mesh, Tolerances()).surfaces}
    assert kinds >= {"plane", "cylinder", "cone", "sphere", "torus"}


def test_packs_hold_every_mesh_once_the_largest_first():
    facets = [50, PACK // 2, PACK // 10, 2 * PACK, 7, PACK - 1, 1_000]
    for jobs in (1, 2, 5):
        held = packs(facets, jobs)
        assert sorted(k for pack in held for k in pack) == list(range(len(facets)))
        assert held[0] == [3]
        assert all(len(pack) == 1 or sum(facets[k] for k in pack) <= PACK for pack in held)
    assert len(packs([1000] * 10, 1)) == 1
    assert len(packs([1000] * 100, 2)) == 2
    assert len(packs([100] * 10, 2)) == 1

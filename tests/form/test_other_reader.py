"""Our readers and trimesh's agree on every mesh of the fixtures."""

from __future__ import annotations

import pytest
import trimesh
from support.places import FIXTURES

from kinform.form.files import read_raw
from kinform.form.meshes.health import build_mesh

MESHES = sorted(p for p in FIXTURES.rglob("*") if p.suffix in (".stl", ".obj") and "broken" not in p.parts)


@pytest.mark.parametrize("path", MESHES, ids=lambda p: f"{p.parent.name}/{p.name}")
def test_facets_and_volume_agree(path):
    ours = build_mesh(read_raw(path), 1.0, None, path=path.name, body=None, solid=True)
    theirs = trimesh.load(path, process=True, force="mesh")
    assert ours.health.facets == len(theirs.faces)
    assert ours.health.watertight == theirs.is_watertight
    if theirs.is_watertight:
        assert ours.health.volume == pytest.approx(theirs.volume, rel=1e-5)

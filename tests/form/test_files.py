"""Our readers and trimesh's agree on every mesh of the fixtures."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from support.places import FIXTURES
from tests.support.scenes import BOX, PLATE, threemf

from kinform import form
from kinform.errors import InputError
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


IN_A_MANIFEST = 'schema = 1\n[assembly]\nname = "x"\nunits = "{0}"\n[[part]]\nname = "a"\nmesh = "{1}"\n{2}\n'


@pytest.mark.parametrize("units", ["mm", "m", "in"])
@pytest.mark.parametrize(
    ("file", "metres"), [("box.glb", 1.0), ("box.dae", 1.0), ("box.3mf", 0.0254), ("box.stl", None)]
)
def test_a_mesh_whose_format_has_a_unit_is_in_that_unit_in_any_manifest(tmp_path, units, file, metres):
    if file.endswith(".3mf"):
        threemf(tmp_path / file, PLATE, '<item objectid="1"/>', unit="inch")
    else:
        BOX.export(tmp_path / file)
    in_one = {"mm": 1e-3, "m": 1.0, "in": 0.0254}
    path = tmp_path / "m.toml"
    for stated, factor in (("", metres or in_one[units]), ('units = "mm"', 1e-3)):
        path.write_text(IN_A_MANIFEST.format(units, file, stated))
        part = form.load(path).part("a")
        assert np.allclose(np.sort(np.ptp(part.mesh.vertices, axis=0)), factor * np.array([1.0, 2.0, 3.0]), rtol=1e-6)


@pytest.mark.parametrize("suffix", ["stl", "STL", "obj", "ply", "off", "dae", "glb", "3mf"])
def test_a_pointer_of_git_lfs_in_the_place_of_a_mesh_is_told(tmp_path, suffix):
    (tmp_path / f"box.{suffix}").write_text("version https://git-lfs.github.com/spec/v1\noid sha256:1\nsize 9\n")
    path = tmp_path / "m.toml"
    path.write_text(IN_A_MANIFEST.format("mm", f"box.{suffix}", ""))
    with pytest.raises(InputError) as caught:
        form.load(path)
    (problem,) = caught.value.problems
    assert problem.line == 7 and "git lfs pull" in problem.remedy

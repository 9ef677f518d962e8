"""Where only meshes changed the manifest is not parsed again, and the assembly is what parsing gives."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from support.places import FIXTURES

from kinform import stages
from kinform.form.reload import reload_meshes
from kinform.model.assembly import Assembly
from kinform.reuse.digest import digest


def read(manifest: Path) -> tuple[Assembly, dict[str, str]]:
    design = stages.import_(manifest)
    return design.assembly, design.fingerprints.files


@pytest.fixture
def manifest(tmp_path: Path) -> Path:
    shutil.copytree(FIXTURES / "mechanisms/four_bar", tmp_path / "m")
    return tmp_path / "m/four_bar.toml"


def test_a_mesh_that_changed_is_read_and_the_others_are_kept(manifest: Path) -> None:
    earlier, files = read(manifest)
    shutil.copy(manifest.parent / "pin_c.stl", manifest.parent / "pin_a.stl")
    found = reload_meshes(manifest, earlier, files)
    fresh, contents = read(manifest)
    assert found is not None
    assert digest(found[0]) == digest(fresh)
    assert found[1] == contents
    assert found[0].part("pin_b").mesh is earlier.part("pin_b").mesh
    assert digest(found[0]) != digest(earlier)


@pytest.mark.parametrize("change", ["manifest", "broken", "gone", "outside", "other files"])
def test_what_is_not_plain_is_left_to_the_reader(manifest: Path, tmp_path: Path, change: str) -> None:
    earlier, files = read(manifest)
    mesh = manifest.parent / "pin_a.stl"
    if change == "manifest":
        manifest.write_text(manifest.read_text() + "\n")
    elif change == "broken":
        mesh.write_bytes(b"solid nothing")
    elif change == "gone":
        mesh.unlink()
    elif change == "outside":
        mesh.rename(tmp_path / "pin.stl")
        mesh.symlink_to(tmp_path / "pin.stl")
        assert reload_meshes(manifest, earlier, files, allow_outside=True) is not None
    else:
        files = {name: content for name, content in files.items() if name != "pin_a.stl"}
    assert reload_meshes(manifest, earlier, files) is None

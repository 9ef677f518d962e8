"""What lies beside a description is looked through as far as a package goes, and no further."""

from __future__ import annotations

from pathlib import Path

import pytest

from kinform import form
from kinform.errors import InputError
from kinform.formats.description import mesh_files
from kinform.formats.description.mesh_files import ENTRIES_MOST
from kinform.foundation.boundary import Boundary


def test_files_of_a_package_are_found_whatever_their_depth(tmp_path: Path) -> None:
    below = tmp_path / "a" / "b" / "c"
    below.mkdir(parents=True)
    for path in (tmp_path / "z.urdf", below / "y.XACRO", below / "x.txt"):
        path.write_text("x")
    (tmp_path / "dir.urdf").mkdir()
    (tmp_path / "a" / "again").symlink_to(tmp_path)
    assert mesh_files.files_below(tmp_path, (".urdf", ".xacro")) == [below / "y.XACRO", tmp_path / "z.urdf"]


def test_links_that_lead_nowhere_are_no_files(tmp_path: Path) -> None:
    (tmp_path / "a.urdf").write_text("x")
    for name, target in (("loop.urdf", "loop.urdf"), ("gone.urdf", "nowhere"), ("b.urdf", "a.urdf")):
        (tmp_path / name).symlink_to(target)
    assert mesh_files.files_below(tmp_path, (".urdf",)) == [tmp_path / "a.urdf", tmp_path / "b.urdf"]


def test_a_home_folder_is_not_searched_to_its_end(tmp_path: Path, monkeypatch) -> None:
    """The near folders are seen; what lies behind too many entries is left alone."""
    (tmp_path / "near").mkdir()
    (tmp_path / "near" / "n.urdf").write_text("x")
    far = tmp_path / "near" / "many"
    far.mkdir()
    for number in range(60):
        (far / f"{number}.urdf").write_text("x")
    monkeypatch.setattr(mesh_files, "ENTRIES_MOST", 50)
    assert mesh_files.files_below(tmp_path, (".urdf",)) == [tmp_path / "near" / "n.urdf"]
    assert ENTRIES_MOST >= 1453  # entries of the largest public package tried


@pytest.mark.parametrize("variable", ["ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"])
@pytest.mark.parametrize("repository", [True, False])
def test_a_link_of_the_repository_in_a_search_path_opens_nothing_outside(
    tmp_path: Path, variable: str, repository: bool
):
    """A link in a folder of the user's own does, as in workspaces."""
    outside, checkout = tmp_path / "outside", tmp_path / "checkout"
    outside.mkdir()
    (outside / "a.stl").write_text("x")
    (outside / "package.xml").write_text("<name>arm</name>")
    named = checkout / "install"
    packages = named / "share" if variable == "AMENT_PREFIX_PATH" else named
    packages.mkdir(parents=True)
    (packages / "arm").symlink_to(outside)
    if repository:
        (checkout / ".git").mkdir()
    (checkout / "robot").mkdir()
    files = mesh_files.MeshFiles(checkout / "robot" / "r.urdf", {}, {variable: str(named)})
    assert (files.find("package://arm/a.stl").path is None) is repository


def test_a_package_whose_file_lies_outside_is_none(tmp_path: Path) -> None:
    (tmp_path / "package.xml").write_text("<package><name>outside</name></package>")
    top = tmp_path / "top"
    for name in ("own", "linked"):
        (top / name).mkdir(parents=True)
    (top / ".git").mkdir()
    (top / "own" / "package.xml").write_text("<package><name>inside</name></package>")
    (top / "linked" / "package.xml").symlink_to(tmp_path / "package.xml")
    boundary = Boundary(top / "own" / "a.urdf")
    assert mesh_files.packages_below(top, 1, boundary) == {"inside": top / "own"}


@pytest.mark.parametrize("folder", ["../", "package://gone/", "http://a/"])
def test_what_one_cause_keeps_from_being_found_is_one_problem(tmp_path: Path, folder: str) -> None:
    shapes = "".join(f'<visual><geometry><mesh filename="{folder}{k}.stl"/></geometry></visual>' for k in range(5))
    (tmp_path / "a.urdf").write_text(f'<robot name="a"><link name="l">{shapes}</link></robot>')
    with pytest.raises(InputError) as caught:
        form.load(tmp_path / "a.urdf")
    (problem,) = caught.value.problems
    assert "0.stl" in problem.message and "4" in problem.message and problem.line == 1

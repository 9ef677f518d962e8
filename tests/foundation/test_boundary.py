"""Where a design may read and write: links, packages, repositories, and links that are put there meanwhile."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from kinform.foundation import boundary
from kinform.foundation.boundary import Boundary, OutsideError, design_folder, leads_out, way_out


@pytest.fixture
def outside(tmp_path: Path) -> Path:
    """A folder `out` with a secret, beside the folder `home/design`; its path."""
    (tmp_path / "home" / "design").mkdir(parents=True)
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "secret").write_text("secret")
    return tmp_path / "out"


@pytest.fixture
def own(outside: Path) -> Path:
    """The design's folder, with a file in it."""
    folder = outside.parent / "home" / "design"
    (folder / "a.stl").write_text("a")
    return folder


@pytest.mark.parametrize("mark,folder", [(None, "home/design"), ("package.xml", "home"), (".git", "home")])
def test_the_folder_is_that_of_the_package_or_the_repository_or_its_own(own: Path, mark: str | None, folder: str):
    top = own.parent.parent
    if mark is not None:
        (top / "home" / mark).write_text("")
    assert design_folder(own / "m.toml") == os.path.realpath(top / folder)
    assert Boundary(own / "m.toml").allows(own.parent / "x.stl") is (mark is not None)


WAYS = {
    "up": "../../out/secret",
    "absolute": "{out}/secret",
    "a link": "link",
    "a link to a link": "again",
    "a folder that is a link": "folder/secret",
    "up behind a link": "folder/../out/secret",
    "what is not there": "../../out/nothing",
    "a folder that is not there": "../../nowhere/x",
    "the folder above": "..",
}


@pytest.mark.parametrize("way", WAYS)
def test_nothing_outside_is_read_whether_it_is_there_or_not(own: Path, outside: Path, way: str):
    (own / "link").symlink_to(outside / "secret")
    (own / "again").symlink_to("link")
    (own / "folder").symlink_to(outside)
    here, path = Boundary(own / "m.toml"), own / WAYS[way].format(out=outside)
    assert not here.allows(path) and not here.is_file(path) and not here.is_folder(path)
    with pytest.raises(OutsideError):
        here.open(path)
    everywhere = Boundary(own / "m.toml", allow_outside=True)
    assert everywhere.is_file(path) is path.is_file()


def test_a_folder_outside_that_a_path_passes_is_not_asked_for(own: Path, outside: Path):
    here = Boundary(own / "m.toml")
    answers = {here.is_file(own / f"../../{name}/../home/design/a.stl") for name in ("out", "nowhere")}
    assert answers == {True}


@pytest.mark.parametrize("name", [".git", ".GIT"])
def test_what_git_keeps_is_outside(own: Path, name: str):
    (own / name).mkdir()
    (own / name / "config").write_text("token")
    (own / "link").symlink_to(f"{name}/config")
    here = Boundary(own / "m.toml")
    assert not here.allows(own / name / "config") and not here.allows(own / "link")


def test_folders_that_the_user_names_and_the_input_itself_may_be_read(own: Path, outside: Path):
    (outside / "m.toml").write_text("")
    (own / "m.toml").symlink_to(outside / "m.toml")
    here = Boundary(own / "m.toml", packages=[outside])
    assert here.read(outside / "secret") == b"secret"
    assert Boundary(own / "m.toml").read(own / "m.toml") == b""
    assert not Boundary(own / "m.toml").allows(outside / "secret")
    assert leads_out(own / "m.toml") and not leads_out(own / "a.stl")


@pytest.mark.parametrize("what", ["the file", "its folder"])
def test_a_link_that_is_put_there_after_the_check_is_not_followed(own: Path, outside: Path, what: str, monkeypatch):
    (own / "sub").mkdir()
    (own / "sub" / "secret").write_text("mine")
    here, opened = Boundary(own / "m.toml"), boundary._open_below

    def meanwhile(root: str, real: str) -> int:
        place = own / "sub" / "secret" if what == "the file" else own / "sub"
        place.rename(own / "old")
        place.symlink_to(outside / "secret" if what == "the file" else outside)
        return opened(root, real)

    monkeypatch.setattr(boundary, "_open_below", meanwhile)
    with pytest.raises(OSError, match=r"symbolic links|Not a directory"):
        here.read(own / "sub" / "secret")


def test_a_pipe_and_a_folder_are_no_files(own: Path):
    os.mkfifo(own / "pipe")
    here = Boundary(own / "m.toml")
    for name in ("pipe", "."):
        with pytest.raises(OSError, match=r"not a file|directory"):
            here.open(own / name)


@pytest.mark.parametrize("repository", [False, True])
def test_outputs_do_not_leave_by_links(own: Path, outside: Path, repository: bool):
    (own / "link.h5").symlink_to("a.stl")
    (own / "out").symlink_to(outside)
    (own / "real").mkdir()
    (own / "near").symlink_to("real")
    if repository:
        (own / ".git").mkdir()
        (outside / ".git").mkdir()
    assert way_out(own / "link.h5") == str(own / "link.h5")
    assert way_out(own / "out" / "r.h5", [own]) == str(own / "out")
    assert (way_out(own / "out" / "r.h5") is not None) is repository
    assert way_out(own / "out", [own], folder=True) == str(own / "out")
    assert way_out(own / "near" / "r.h5", [own]) is None
    assert way_out(own / "near" / ".." / "r.h5", [own]) is None
    assert way_out(own / "new" / "r.h5", [own]) is None


def test_outputs_of_a_folder_stay_in_it(own: Path):
    (own / "made").mkdir()
    (own / "made" / "meshes").symlink_to("..")
    assert way_out(own / "made" / "meshes" / "x.stl", (), own / "made") == str(own / "made" / "meshes")
    assert way_out(own / "made" / "x.stl", (), own / "made") is None


def test_whether_a_link_to_outside_leads_to_a_file_is_not_asked(tmp_path: Path):
    (tmp_path / ".git").mkdir()
    (tmp_path / "there").touch()
    for target in ("there", "nowhere"):
        folder = tmp_path / f"to_{target}"
        folder.mkdir()
        (folder / "package.xml").symlink_to(tmp_path / target)
        assert design_folder(folder / "m.toml") == str(folder)

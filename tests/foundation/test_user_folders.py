"""Folders and files that only this user can have written."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from kinform.foundation import user_folders
from kinform.foundation.user_folders import cache_folder, is_foreign, private_folder

pytestmark = pytest.mark.skipif(os.name != "posix", reason="users and rights are those of POSIX")


@pytest.fixture
def top(tmp_path: Path) -> Path:
    """A folder of this user with one file."""
    with private_folder(tmp_path / "cache" / "kinform", "inner", make=True) as folder:
        assert folder is not None and folder.write("file", b"content")
    return tmp_path / "cache" / "kinform"


def read(top: Path) -> bytes | None:
    with private_folder(top, "inner") as folder:
        return None if folder is None else folder.read("file")


def test_what_was_written_is_read(top: Path):
    assert read(top) == b"content"
    assert [oct(path.stat().st_mode & 0o777) for path in (top, top / "inner")] == ["0o700", "0o700"]
    assert [path.name for path in (top / "inner").iterdir()] == ["file"]


@pytest.mark.parametrize("step", ["", "inner"])
@pytest.mark.parametrize("rights", [0o755, 0o770, 0o701])
def test_a_folder_that_others_may_enter_does_not_count(top: Path, step: str, rights: int):
    (top / step).chmod(rights)
    assert read(top) is None
    with private_folder(top, "inner", make=True) as folder:
        assert folder is None
    assert (top / step).stat().st_mode & 0o777 == rights


@pytest.mark.parametrize("step", ["", "inner"])
def test_a_link_to_a_folder_does_not_count(top: Path, step: str):
    place = top / step
    moved = place.rename(place.with_name("moved"))
    place.symlink_to(moved)
    assert read(top) is None


def test_the_folder_of_another_user_does_not_count(top: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(os, "geteuid", lambda: os.getuid() + 1)
    assert read(top) is None


@pytest.mark.parametrize("spoil", [
    lambda path: path.write_bytes(path.read_bytes()[:-1]),
    lambda path: path.write_bytes(b"x" + path.read_bytes()[1:]),
    lambda path: path.write_bytes(b""),
    lambda path: path.chmod(0o666),
    lambda path: path.symlink_to(path.rename(path.with_name("moved"))),
    lambda path: (path.unlink(), os.mkfifo(path)),
    lambda path: (path.unlink(), path.mkdir()),
    lambda path: path.unlink(),
], ids="cut changed empty writable link pipe folder gone".split())  # fmt: skip
def test_a_file_that_is_not_as_it_was_written_is_none(top: Path, spoil):
    spoil(top / "inner" / "file")
    assert read(top) is None


def test_what_cannot_be_made_or_written_is_no_error(tmp_path: Path):
    (tmp_path / "file").touch()
    with private_folder(tmp_path / "file" / "kinform", make=True) as folder:
        assert folder is None
    with private_folder(tmp_path / "kinform", make=True) as folder:
        assert folder is not None and not folder.write("no/such/place", b"")


def test_an_error_in_the_body_is_passed_on(top: Path):
    with pytest.raises(OSError, match="own"), private_folder(top, "inner"):
        raise OSError("own")


def test_the_cache_is_where_the_user_says_if_that_is_absolute(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    assert cache_folder() == tmp_path / "cache" / "kinform"
    monkeypatch.setenv("HOME", str(tmp_path))
    for relative in ("", ".cache", "../cache"):
        monkeypatch.setenv("XDG_CACHE_HOME", relative)
        assert cache_folder() == tmp_path / ".cache" / "kinform"
    monkeypatch.setenv("HOME", "home")
    assert (found := cache_folder()) is None or not found.is_relative_to(Path.cwd())


@pytest.mark.parametrize("mark", [None, ".git", "package.xml"])
def test_folders_in_a_design_are_foreign(mark: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    design = tmp_path / "design"
    (design / "below").mkdir(parents=True)
    if mark is None:
        monkeypatch.chdir(design)
    else:
        (design / mark).touch()
        monkeypatch.chdir(design / "below")
    monkeypatch.setenv("XDG_CACHE_HOME", str(design / "cache"))
    assert cache_folder() is None and is_foreign(design / "below")
    (tmp_path / "link").symlink_to(design / "below")
    assert is_foreign(tmp_path / "link")
    assert not is_foreign(tmp_path / "other")


def test_a_home_under_version_control_is_the_users(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / ".git").mkdir()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(user_folders, "stated_home", lambda: str(tmp_path))
    assert not is_foreign(tmp_path / ".cache")


def test_a_link_of_a_repository_that_leads_out_of_it_is_foreign(tmp_path: Path):
    (tmp_path / "checkout" / ".git").mkdir(parents=True)
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "checkout" / ".cache").symlink_to(tmp_path / "elsewhere")
    assert is_foreign(tmp_path / "checkout" / ".cache") and not is_foreign(tmp_path / "elsewhere")

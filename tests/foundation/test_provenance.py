"""Files are known again where this user's kinform wrote them; whatever is wrong with the folder, nothing fails."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys

import pytest

from kinform.foundation import provenance
from kinform.foundation.provenance import fault, is_recorded, is_signed, record, signed

MINE, OTHER = ("a" + hashlib.sha256(name).hexdigest()[1:] for name in (b"mine", b"other"))


@pytest.fixture(autouse=True)
def state(tmp_path, monkeypatch):
    """The user's state folder."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    (tmp_path / "work").mkdir()
    monkeypatch.chdir(tmp_path / "work")
    return tmp_path / "state" / "kinform"


def test_only_what_was_recorded_is_known_in_a_folder_that_is_closed_to_others(state, tmp_path):
    record(MINE)
    assert is_recorded(MINE, tmp_path / "a.h5") and not is_recorded(OTHER, tmp_path / "a.h5")
    assert (state.stat().st_mode & 0o777, (state / "a").stat().st_mode & 0o777) == (0o700, 0o600)
    record(MINE)
    assert (state / "a").stat().st_size == 65
    assert fault(tmp_path / "a.h5") == ""


def test_no_text_that_is_no_digest_is_recorded(state, tmp_path):
    for text in ("", "a", "../" + MINE, MINE.upper(), MINE + "\n"):
        record(text)
        assert not is_recorded(text, tmp_path / "a.h5")
    assert not list(state.iterdir())


def test_a_state_folder_that_is_not_absolute_is_that_of_the_home(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", "state")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    record(MINE)
    assert (tmp_path / "home" / ".local" / "state" / "kinform" / "a").is_file() and not (tmp_path / "state").exists()


def _open_to_others(state):
    state.chmod(0o755)


def _a_file(state):
    state.rename(state.with_name("elsewhere"))
    state.write_text("")


def _a_link(state):
    state.rename(state.with_name("elsewhere"))
    state.symlink_to(state.with_name("elsewhere"))


def _digests_behind_a_link(state):
    (state / "a").rename(state.with_name("elsewhere"))
    (state / "a").symlink_to(state.with_name("elsewhere"))


def _a_folder_for_digests(state):
    (state / "a").unlink()
    (state / "a").mkdir()


def _a_pipe_for_digests(state):
    (state / "a").unlink()
    os.mkfifo(state / "a")


@pytest.mark.parametrize(
    "spoil",
    [_open_to_others, _a_file, _a_link, _digests_behind_a_link, _a_folder_for_digests, _a_pipe_for_digests],
)
def test_a_folder_that_others_may_have_written_is_not_believed_and_nothing_fails(spoil, state, tmp_path):
    record(MINE)
    spoil(state)
    assert not is_recorded(MINE, tmp_path / "a.h5")
    record(OTHER)
    assert not is_recorded(OTHER, tmp_path / "a.h5")
    assert isinstance(fault(tmp_path / "a.h5"), str)


def test_a_folder_of_another_user_is_not_believed(tmp_path, monkeypatch):
    record(MINE)
    monkeypatch.setattr(os, "geteuid", lambda: os.getuid() + 1)
    assert not is_recorded(MINE, tmp_path / "a.h5")
    assert fault(tmp_path / "a.h5")


@pytest.mark.parametrize("mark", [".git", "package.xml"])
def test_a_folder_in_a_repository_or_a_package_is_not_believed(mark, tmp_path):
    record(MINE)
    code = signed("x", tmp_path / "elsewhere" / "a")
    (tmp_path / mark).write_text("")
    for file in (tmp_path / "a.h5", tmp_path.parent / "a.h5"):
        assert not is_recorded(MINE, file) and fault(file) and not signed("x", file)
        assert not is_signed("x", code, file)


def test_a_folder_in_the_repository_around_that_of_the_file_is_not_believed(tmp_path, monkeypatch):
    inner = tmp_path / "module"
    (inner / ".git").mkdir(parents=True)
    record(MINE)
    assert is_recorded(MINE, inner / "a.h5")
    (tmp_path / ".git").mkdir()
    monkeypatch.chdir(inner)
    assert not is_recorded(MINE, inner / "a.h5")


def test_a_folder_in_the_working_folder_is_not_believed(tmp_path, monkeypatch):
    record(MINE)
    monkeypatch.chdir(tmp_path)
    assert not is_recorded(MINE, tmp_path.parent / "a.h5")


def test_half_a_line_of_a_killed_process_harms_no_other(state, tmp_path):
    record(MINE)
    with (state / "a").open("ab") as stream:
        stream.write(b"a123\0\xff")
    record(OTHER)
    assert is_recorded(MINE, tmp_path / "a.h5") and is_recorded(OTHER, tmp_path / "a.h5")


def test_what_is_used_stays_and_the_rest_is_forgotten(state, tmp_path, monkeypatch):
    monkeypatch.setattr(provenance, "FULL", 10 * 65)
    digests = ["a" + hashlib.sha256(bytes([k])).hexdigest()[1:] for k in range(60)]
    for digest in digests:
        record(digest)
        assert is_recorded(digests[0], tmp_path / "a.h5")
    assert not is_recorded(digests[1], tmp_path / "a.h5") and is_recorded(digests[-1], tmp_path / "a.h5")
    assert sum(file.stat().st_size for file in state.iterdir()) <= 2 * 10 * 65


def test_processes_that_write_at_once_lose_nothing(tmp_path):
    code = (
        "import hashlib, sys\nfrom kinform.foundation.provenance import record\n"
        "for k in range(200):\n    record(hashlib.sha256(f'{sys.argv[1]} {k}'.encode()).hexdigest())\n"
    )
    running = [subprocess.Popen([sys.executable, "-c", code, str(n)]) for n in range(3)]
    assert [one.wait() for one in running] == [0, 0, 0]
    digests = [hashlib.sha256(f"{n} {k}".encode()).hexdigest() for n in range(3) for k in range(200)]
    assert all(is_recorded(digest, tmp_path / "a.h5") for digest in digests)


def test_a_text_is_signed_with_a_key_that_is_made_again_where_it_is_damaged(state, tmp_path):
    code = signed("text", tmp_path / "a")
    assert is_signed("text", code, tmp_path / "a") and not is_signed("texts", code, tmp_path / "a")
    assert not any(is_signed("text", other, tmp_path / "a") for other in ("", None, 3, "ü", code[:-1]))
    (state / "key").write_bytes(b"short")
    assert not is_signed("text", code, tmp_path / "a")
    assert is_signed("text", signed("text", tmp_path / "a"), tmp_path / "a")


def test_nothing_is_made_where_a_link_of_a_repository_leads(tmp_path, monkeypatch):
    (tmp_path / "checkout" / ".git").mkdir(parents=True)
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "checkout" / "state").symlink_to(tmp_path / "elsewhere")
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "checkout" / "state"))
    provenance.record("0" * 64)
    assert list((tmp_path / "elsewhere").iterdir()) == []
    assert provenance.fault(tmp_path / "a.h5")

"""Writing is whole or not at all, and never over a file that is not ours."""

from __future__ import annotations

import contextlib
import errno
import os
import signal
import stat
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from kinform import results
from kinform.design import Design
from kinform.errors import ResultsError
from kinform.model.assembly import Assembly, Source
from kinform.model.function import Function
from kinform.model.tolerances import Tolerances
from kinform.results import replacement


def _design(name: str) -> Design:
    return Design(
        Assembly(
            name=name, units="mm", parts=(), groups=(), assumptions=(), ground=None, tolerances=Tolerances(),
            infer_fasteners=False, function=Function(), simulation=None, subassemblies=(),
            source=Source("m.toml"), files=(),
        )
    )  # fmt: skip


def _only(folder: Path) -> list[str]:
    return sorted(os.listdir(folder))


def test_another_design_replaces_the_file_and_leaves_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    for name in ("one", "two"):
        results.write(_design(name), path)
        assert results.read(path).assembly.name == name
    assert _only(tmp_path) == ["r.h5"]


def test_identical_bytes_keep_the_file_and_touch_its_time(tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    results.write(_design("one"), path)
    os.utime(path, (1e9, 1e9))
    before = path.stat().st_ino
    results.write(_design("one"), path)
    assert path.stat().st_ino == before
    assert path.stat().st_mtime > 1.6e9


@pytest.mark.parametrize("step", ["fsync", "replace"])
@pytest.mark.parametrize("failure", [KeyboardInterrupt(), OSError(errno.ENOSPC, "No space left on device")])
def test_what_stops_a_write_leaves_the_old_file_and_no_other(
    step: str, failure: BaseException, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "r.h5"
    results.write(_design("old"), path)
    before = path.read_bytes()

    def stop(*_: object) -> None:
        raise failure

    monkeypatch.setattr(replacement.os, step, stop)
    expected = KeyboardInterrupt if isinstance(failure, KeyboardInterrupt) else ResultsError
    with pytest.raises(expected) as caught:
        results.write(_design("new"), path)
    assert path.read_bytes() == before
    assert _only(tmp_path) == ["r.h5"]
    if expected is ResultsError:
        problem = caught.value.problem
        assert problem.file == str(path)
        assert os.strerror(errno.ENOSPC) in problem.message
        assert problem.remedy


def test_a_first_write_that_is_stopped_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(replacement.os, "replace", stop)
    with pytest.raises(KeyboardInterrupt):
        results.write(_design("new"), tmp_path / "r.h5")
    assert _only(tmp_path) == []


def test_the_permissions_of_an_old_file_stay(tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    results.write(_design("one"), path)
    path.chmod(0o640)
    results.write(_design("two"), path)
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


def test_a_new_file_has_the_permissions_that_the_umask_leaves(tmp_path: Path) -> None:
    (tmp_path / "other").touch()
    results.write(_design("one"), tmp_path / "r.h5")
    assert (tmp_path / "r.h5").stat().st_mode == (tmp_path / "other").stat().st_mode


@pytest.mark.parametrize("there", [False, True])
def test_a_file_is_not_written_through_a_link(there: bool, tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    if there:
        results.write(_design("one"), tmp_path / "real" / "r.h5")
    before = [path.read_bytes() for path in (tmp_path / "real").iterdir()]
    (tmp_path / "link.h5").symlink_to(tmp_path / "real" / "r.h5")
    with pytest.raises(ResultsError):
        results.write(_design("two"), tmp_path / "link.h5")
    assert (tmp_path / "link.h5").is_symlink()
    assert [path.read_bytes() for path in (tmp_path / "real").iterdir()] == before


def test_a_file_is_written_in_a_folder_that_the_user_linked(tmp_path: Path) -> None:
    (tmp_path / "scratch").mkdir()
    (tmp_path / "link").symlink_to("scratch")
    results.write(_design("one"), tmp_path / "link" / "r.h5")
    assert results.read(tmp_path / "scratch" / "r.h5").assembly.name == "one"


@pytest.mark.parametrize(
    "name", [pytest.param("", id="a folder"), pytest.param("absent/r.h5", id="below no folder"), "pipe"]
)
def test_what_is_no_place_for_a_file_is_refused(name: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(ResultsError) as caught:
        results.write(_design("one"), tmp_path / name)
    assert caught.value.problem.remedy
    assert _only(tmp_path) == ["pipe"]
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)


@pytest.mark.parametrize("content", [b"my thesis\n", b"\x89HDF\r\n\x1a\n and then nothing"])
def test_a_file_that_is_not_ours_is_never_overwritten(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "notes.txt"
    path.write_bytes(content)
    with pytest.raises(ResultsError) as caught:
        results.write(_design("one"), path)
    assert caught.value.problem.file == str(path) and caught.value.problem.remedy
    assert path.read_bytes() == content


def test_an_empty_file_may_be_filled(tmp_path: Path) -> None:
    (tmp_path / "r.h5").touch()
    results.write(_design("one"), tmp_path / "r.h5")
    assert results.read(tmp_path / "r.h5").assembly.name == "one"


@contextlib.contextmanager
def _ordinary_user() -> Iterator[None]:
    """Without the rights of root, who may write everywhere."""
    if os.geteuid() != 0:
        yield
        return
    os.seteuid(65534)
    try:
        yield
    finally:
        os.seteuid(0)


@pytest.mark.parametrize("name", ["r.h5", "another.h5"])
def test_a_read_only_folder_is_refused_and_its_file_stays(name: str) -> None:
    with tempfile.TemporaryDirectory() as above:
        os.chmod(above, 0o755)
        folder = Path(above) / "closed"
        folder.mkdir()
        results.write(_design("old"), folder / "r.h5")
        before = (folder / "r.h5").read_bytes()
        (folder / "r.h5").chmod(0o666)
        folder.chmod(0o555)
        with _ordinary_user(), pytest.raises(ResultsError):
            results.write(_design("new"), folder / name)
        folder.chmod(0o755)
        assert (folder / "r.h5").read_bytes() == before
        assert _only(folder) == ["r.h5"]


def test_a_read_only_file_is_refused() -> None:
    with tempfile.TemporaryDirectory() as above:
        os.chmod(above, 0o777)
        path = Path(above) / "r.h5"
        results.write(_design("old"), path)
        path.chmod(0o444)
        with _ordinary_user(), pytest.raises(ResultsError):
            results.write(_design("new"), path)
        assert results.read(path).assembly.name == "old"


def test_reading_while_the_file_is_replaced_gives_the_old_design_or_the_new(tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    results.write(_design("one"), path)
    with path.open("rb") as opened:
        results.write(_design("two"), path)
        (tmp_path / "seen.h5").write_bytes(opened.read())
    assert results.read(tmp_path / "seen.h5").assembly.name == "one"
    assert results.read(path).assembly.name == "two"


def test_writing_what_was_read_changes_no_byte(tmp_path: Path) -> None:
    results.write(_design("one"), tmp_path / "r.h5")
    before = (tmp_path / "r.h5").read_bytes()
    results.write(results.read(tmp_path / "r.h5"), tmp_path / "r.h5")
    assert (tmp_path / "r.h5").read_bytes() == before


def test_what_a_killed_writer_left_is_removed_by_the_next_one(tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    code = (
        "import os, signal, sys\n"
        "from kinform.results import replacement\n"
        "replacement.os.replace = lambda *_: os.kill(os.getpid(), signal.SIGKILL)\n"
        "replacement.replace_file(sys.argv[1], b'half')\n"
    )
    killed = subprocess.run([sys.executable, "-c", code, str(path)], check=False)
    assert killed.returncode == -signal.SIGKILL
    assert [name.startswith(".kinform-") for name in _only(tmp_path)] == [True]
    results.write(_design("one"), path)
    assert _only(tmp_path) == ["r.h5"]


def test_what_a_living_writer_is_writing_stays(tmp_path: Path) -> None:
    mine, handle = replacement._draft(tmp_path)
    try:
        results.write(_design("one"), tmp_path / "r.h5")
        assert mine.exists()
    finally:
        os.close(handle)
    results.write(_design("two"), tmp_path / "r.h5")
    assert _only(tmp_path) == ["r.h5"]


def test_many_writers_at_once_leave_one_whole_file(tmp_path: Path) -> None:
    code = (
        "import sys\n"
        "from kinform.results import replacement\n"
        "for n in range(40):\n"
        "    replacement.replace_file(sys.argv[1], (sys.argv[2] * 100000 + str(n)).encode())\n"
    )
    path = tmp_path / "r.h5"
    writers = [subprocess.Popen([sys.executable, "-c", code, str(path), letter]) for letter in "abc"]
    assert [writer.wait(timeout=60) for writer in writers] == [0, 0, 0]
    text = path.read_text()
    assert text[:100000] == text[0] * 100000
    assert text[100000:] == "39"
    assert _only(tmp_path) == ["r.h5"]


@pytest.mark.parametrize("limit", [1, 5000, 20000])
def test_a_disk_that_is_full_loses_nothing_that_was_there(limit: int, tmp_path: Path) -> None:
    """The operating system refuses every byte of a file beyond the limit, as a full disk does."""
    path = tmp_path / "r.h5"
    results.write(_design("old"), path)
    before = path.read_bytes()
    code = (
        "import resource, sys\n"
        "from kinform import ResultsError, results\n"
        "design = results.read(sys.argv[1])\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]),) * 2)\n"
        "import dataclasses\n"
        "new = dataclasses.replace(design, assembly=dataclasses.replace(design.assembly, name='new' * 20000))\n"
        "try:\n    results.write(new, sys.argv[1])\n"
        "except ResultsError:\n    print('refused')\n"
    )
    # without bytecode: Python would keep what the limit leaves of it, and stumble over that for ever
    command = [sys.executable, "-B", "-c", code, str(path), str(limit)]
    ran = subprocess.run(command, capture_output=True, text=True, check=True)
    assert ran.stdout == "refused\n"
    assert path.read_bytes() == before
    assert _only(tmp_path) == ["r.h5"]

"""Ctrl-C, crashes and kills while the command works, also where native code is at work and Python hears nothing."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from support.command_line import at_work, environment, listening
from support.places import FIXTURES

from kinform import results

PAIR = FIXTURES / "pairs" / "revolute_collars"
NAME = "revolute_collars.toml"

HELD = """
import os, signal, sys
from pathlib import Path
import kinform.consistency, kinform.results, kinform.stages
from kinform_cli.main import entry

def held(*given, **named):
    Path("worker").write_text(str(os.getpid()))
    Path("begun").touch()
    {deed}

place, name = sys.argv.pop(1).rsplit(".", 1)
import importlib
setattr(importlib.import_module(place), name, held)
entry()
"""
DEAF = "sum(range(10**15))"
"""One call of C code that asks for no signals and lets no other thread run, for days."""

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="a process watches the work on Linux only")


@pytest.fixture
def folder(tmp_path: Path, derive_design) -> Path:
    """The hinge with its results."""
    shutil.copytree(PAIR, tmp_path, dirs_exist_ok=True)
    results.write(derive_design(PAIR / NAME), tmp_path / "r.h5")
    return tmp_path


def begun(folder: Path, place: str, *words: str, deed: str = DEAF) -> subprocess.Popen[str]:
    """The command, at work in the function that was replaced."""
    command = [sys.executable, "-c", HELD.format(deed=deed), place, *words]
    return at_work(command, folder, (folder / "begun").exists)


def _interrupted_once(errors: str) -> None:
    assert errors.startswith("kinform: error: interrupted") and errors.count("\n") == 1


def alive(process: int) -> bool:
    """Whether it runs; one that ended and was not asked for is none."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


WORK = {
    "kinform.stages.import_": ("run", NAME, "-o", "r.h5", "--jobs", "1", "--no-ranges"),
    "kinform.stages.contacts": ("contacts", "r.h5", "-o", "r.h5"),
    "kinform.stages.joints": ("joints", "r.h5", "-o", "r.h5"),
    "kinform.stages.mass": ("mass", "r.h5", "-o", "r.h5"),
    "kinform.stages.simulate": ("simulate", "r.h5", "-o", "r.h5"),
    "kinform.stages.check": ("check", "r.h5", "-o", "r.h5"),
    "kinform.results.read_at_need": ("show", "r.h5"),
}


QUICK = ("kinform.stages.contacts",)


@pytest.mark.parametrize(
    "place", [*QUICK, *(pytest.param(place, marks=pytest.mark.sweep) for place in WORK if place not in QUICK)]
)
def test_ctrl_c_is_heard_while_native_code_hears_nothing(place: str, folder: Path) -> None:
    before = (folder / "r.h5").read_bytes()
    running = begun(folder, place, *WORK[place])
    running.send_signal(signal.SIGINT)
    out, errors = running.communicate(timeout=60)
    assert running.returncode == 2
    assert out == ""
    _interrupted_once(errors)
    assert not alive(int((folder / "worker").read_text()))
    assert (folder / "r.h5").read_bytes() == before
    assert not list(folder.glob("*.tmp"))


DROPPED = """raise_ = signal.raise_signal
    try:
        raise_(signal.SIGINT)
    except KeyboardInterrupt:
        pass
    from kinform.errors import InputError, Problem
    raise InputError([Problem("the name has a null character")])"""


def test_ctrl_c_that_a_library_drops_is_told_and_not_what_comes_of_it(folder: Path) -> None:
    """Patterns of pydantic are no match where they are interrupted."""
    running = begun(folder, "kinform.stages.import_", *WORK["kinform.stages.import_"], deed=DROPPED)
    out, errors = running.communicate(timeout=60)
    assert (running.returncode, out) == (2, "")
    _interrupted_once(errors)


def test_ctrl_c_before_the_command_listens_is_told_in_one_line() -> None:
    early = "import kinform_cli.supervision as s, signal\ns.divide = lambda: signal.raise_signal(signal.SIGINT)\n"
    code = early + "from kinform_cli.main import entry\nentry()"
    done = subprocess.run([sys.executable, "-c", code, "schema"], env=environment(), capture_output=True, text=True,
                          preexec_fn=listening)  # fmt: skip
    assert (done.returncode, done.stdout, done.stderr) == (2, "", "kinform: error: interrupted\n")


@pytest.mark.slow
def test_ctrl_c_of_a_terminal_reaches_all_processes_and_is_told_once(folder: Path) -> None:
    sleeping = HELD.format(deed="import time; time.sleep(600)")
    command = [sys.executable, "-c", sleeping, "kinform.stages.check", "check", "r.h5"]
    running = at_work(command, folder, (folder / "begun").exists, start_new_session=True)
    os.killpg(running.pid, signal.SIGINT)
    _, errors = running.communicate(timeout=60)
    assert running.returncode == 2
    _interrupted_once(errors)


def test_workers_in_native_code_end_with_the_command(folder: Path) -> None:
    """Two processes share the contacts; both are deaf."""
    deed = (
        "from kinform.foundation.processes import map_in_processes; "
        "list(map_in_processes(lambda n: (Path(f'worker{n}').write_text(str(os.getpid())), sum(range(10**15))), "
        "[1, 2], 2))"
    )
    running = begun(folder, "kinform.stages.contacts", "contacts", "r.h5", "-o", "r.h5", deed=deed)
    places = [folder / "worker1", folder / "worker2"]
    while not all(place.exists() and place.read_text() for place in places):
        assert running.poll() is None
        time.sleep(0.01)
    running.send_signal(signal.SIGINT)
    _, errors = running.communicate(timeout=60)
    assert running.returncode == 2
    assert "interrupted" in errors
    for place in places:
        process, end = int(place.read_text()), time.monotonic() + 60
        while alive(process):
            assert time.monotonic() < end
            time.sleep(0.05)


SIGNALS = {
    "os.kill(os.getpid(), signal.SIGSEGV)": ["SIGSEGV"],
    "os.abort()": ["SIGABRT"],
    "os.kill(os.getpid(), 9)": [],
}


@pytest.mark.parametrize(
    "deed",
    [
        "os.kill(os.getpid(), signal.SIGSEGV)",
        pytest.param("os.abort()", marks=pytest.mark.sweep),
        pytest.param("os.kill(os.getpid(), 9)", marks=pytest.mark.slow),
    ],
)
def test_a_crash_of_native_code_is_told_and_never_a_verdict(deed: str, folder: Path) -> None:
    before = (folder / "r.h5").read_bytes()
    running = begun(folder, "kinform.stages.check", "check", "r.h5", "-o", "r.h5", deed=deed)
    out, errors = running.communicate(timeout=60)
    assert running.returncode == 2
    assert out == ""
    assert errors.startswith("kinform: error: ")
    assert [name for name in ("SIGSEGV", "SIGABRT") if name in errors] == SIGNALS[deed]
    assert (folder / "r.h5").read_bytes() == before


NATIVE = {
    "kinform.collisions.pair.prepared_pair._hits": ("simulate", "r.h5", "-o", "new.h5", "--ranges"),
    "kinform.collisions.pair.distance_bounds.fcl_distance": ("simulate", "r.h5", "-o", "new.h5", "--ranges"),
    "kinform.contacts.find.pair_contacts": ("contacts", "r.h5", "-o", "new.h5", "--jobs", "1"),
    "kinform.reports.page.overlaps._common": ("report", "r.h5", "-o", "r.html"),
}
"""Native code, or what calls it at once, in the stages that work in one process."""


@pytest.fixture(scope="module")
def overlapping(tmp_path_factory, derive_design) -> Path:
    """A mechanism that moves, and two parts of which overlap, with its results."""
    folder = tmp_path_factory.mktemp("overlapping")
    results.write(derive_design(FIXTURES / "broken" / OVERLAPPING / f"{OVERLAPPING}.toml"), folder / "r.h5")
    return folder


OVERLAPPING = "seeker_gimbal_overlaps"


@pytest.mark.parametrize(
    "place", [pytest.param(p, marks=[] if p.endswith("pair_contacts") else pytest.mark.sweep) for p in NATIVE]
)
def test_a_crash_of_native_code_names_the_parts_it_was_at_work_on(place: str, overlapping: Path) -> None:
    (overlapping / "begun").unlink(missing_ok=True)
    running = begun(overlapping, place, *NATIVE[place], deed="os.kill(os.getpid(), signal.SIGSEGV)")
    _, errors = running.communicate(timeout=60)
    assert running.returncode == 2
    parts = {part.name for part in results.read(overlapping / "r.h5").assembly.parts}
    assert "SIGSEGV" in errors and len(parts & set(re.findall(r"[\w/]+", errors))) == 2, errors


@pytest.mark.slow
@pytest.mark.parametrize("place", ["kinform.collisions.pair.prepared_pair._hits"])
def test_ctrl_c_is_heard_within_a_call_of_the_collisions(place: str, overlapping: Path) -> None:
    (overlapping / "begun").unlink(missing_ok=True)
    running = begun(overlapping, place, *NATIVE[place])
    running.send_signal(signal.SIGINT)
    out, errors = running.communicate(timeout=60)
    assert (running.returncode, out) == (2, "")
    assert "interrupted" in errors


@pytest.mark.parametrize("signal_", [signal.SIGKILL, pytest.param(signal.SIGTERM, marks=pytest.mark.sweep)])
def test_who_kills_the_command_kills_its_work(signal_: signal.Signals, folder: Path) -> None:
    running = begun(folder, "kinform.stages.check", "check", "r.h5")
    running.send_signal(signal_)
    running.wait(timeout=60)
    assert running.returncode == -signal_
    worker, end = int((folder / "worker").read_text()), time.monotonic() + 60
    while alive(worker):
        assert time.monotonic() < end
        time.sleep(0.05)
    running.communicate()


STARTED = """
    import subprocess, time
    words = "import subprocess; subprocess.Popen(['sleep', '600'], start_new_session=True); print(flush=True); input()"
    child = subprocess.Popen([sys.executable, '-c', words], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                             start_new_session=True)
    child.stdout.readline()
    children = Path(f'/proc/{child.pid}/task/{child.pid}/children').read_text()
    Path('children').write_text(f'{child.pid} {children}')
    {end}
"""
"""The work starts a process, which starts one of its own; both in sessions of their own."""


@pytest.mark.parametrize(("how", "code"), [("SIGTERM", -15), ("SIGHUP", -1), ("SIGINT", 2), ("SIGSEGV", 2)])
def test_nothing_that_the_work_started_is_left(how: str, code: int, folder: Path) -> None:
    number = signal.Signals[how]
    end = "os.kill(os.getpid(), signal.SIGSEGV)" if how == "SIGSEGV" else "time.sleep(600)"
    running = begun(folder, "kinform.stages.check", "check", "r.h5", deed=STARTED.replace("{end}", end))
    while not (folder / "children").exists() or not (folder / "children").read_text():
        time.sleep(0.01)
    if how != "SIGSEGV":
        running.send_signal(number)
    running.communicate(timeout=60)
    assert running.returncode == code
    children = [int(word) for word in (folder / "children").read_text().split()]
    assert len(children) == 2 and not any(map(alive, children))


def test_a_command_in_the_background_of_a_shell_goes_on(folder: Path) -> None:
    """There Ctrl-C is ignored, and is meant for others."""
    deed = "import time\n    while not Path('go').exists(): time.sleep(0.01)\n    raise OSError('went on')"
    running = subprocess.Popen(
        [sys.executable, "-c", HELD.format(deed=deed), "kinform.stages.check", "check", "r.h5"],
        cwd=folder, env=environment(), stderr=subprocess.PIPE, text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN),
    )  # fmt: skip
    while not (folder / "begun").exists():
        assert running.poll() is None
        time.sleep(0.01)
    running.send_signal(signal.SIGINT)
    (folder / "go").touch()
    _, errors = running.communicate(timeout=60)
    assert "went on" in errors


IMPORTED_NATIVE = """
import os, signal, sys, time
from importlib.machinery import ExtensionFileLoader, ModuleSpec
from kinform_cli import interrupts

class Loader(ExtensionFileLoader):
    def create_module(self, spec):
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(0.05)
        print("imported", flush=True)
        return type(sys)("native")
    def exec_module(self, module):
        pass

class Finder:
    def find_spec(self, name, path=None, target=None):
        return ModuleSpec(name, Loader(name, "native.so")) if name == "native" else None

sys.meta_path.insert(0, Finder())
interrupts.listen()
try:
    import native
    time.sleep(5)
except KeyboardInterrupt:
    print("heard", flush=True)
interrupts._interrupted(2, None)
try:
    interrupts.raise_unheard()
except KeyboardInterrupt:
    print("once")
"""


def test_ctrl_c_waits_for_a_native_module_that_is_imported():
    """C++ that calls Python there passes no exception on: it ends the process."""
    done = subprocess.run(
        [sys.executable, "-c", IMPORTED_NATIVE],
        env=environment(),
        capture_output=True,
        text=True,
        preexec_fn=listening,
        timeout=60,
    )
    assert (done.returncode, done.stdout.split(), done.stderr) == (0, ["imported", "heard", "once"], "")

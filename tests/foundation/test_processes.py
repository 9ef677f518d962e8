"""What a process that native code ends becomes: an error with the name of what it was at work on."""

from __future__ import annotations

import faulthandler
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from kinform.foundation import processes
from kinform.foundation.processes import Crash, apart, in_own_process, map_in_processes


@pytest.fixture(autouse=True)
def _forks(monkeypatch):
    """As in a process in which no native threads have run, whatever other tests did."""
    monkeypatch.setattr(processes, "_threaded", False)


SEGMENTATION_FAULT = "signal 11 (SIGSEGV)"


def ended(number: int) -> int:
    if number == 5:
        faulthandler.disable()
        os.kill(os.getpid(), signal.SIGSEGV)
    return number * number


def test_the_result_of_another_process_comes_back():
    assert in_own_process(lambda: list(range(100_000))) == list(range(100_000))


def test_what_it_raises_is_raised_here():
    with pytest.raises(ZeroDivisionError):
        in_own_process(lambda: 1 / 0)


def test_a_process_that_ends_without_an_answer_is_told_with_its_cause():
    with pytest.raises(Crash) as caught:
        in_own_process(lambda: ended(5))
    assert caught.value.cause == SEGMENTATION_FAULT
    with pytest.raises(Crash) as caught:
        in_own_process(lambda: os._exit(3))
    assert caught.value.cause == "exit code 3"


def test_a_crash_among_several_is_told_with_the_name_of_the_thing():
    with pytest.raises(Crash) as caught:
        list(map_in_processes(ended, range(9), jobs=2, name=lambda k: f"part {k}"))
    assert (caught.value.subject, caught.value.cause) == ("part 5", SEGMENTATION_FAULT)


def test_a_crash_of_the_only_thing_is_told_too():
    with pytest.raises(Crash) as caught:
        list(map_in_processes(ended, [5], jobs=2, name=lambda k: f"part {k}"))
    assert (caught.value.subject, caught.value.cause) == ("part 5", SEGMENTATION_FAULT)


def test_what_was_done_before_a_crash_comes_in_order():
    come = []
    with pytest.raises(Crash):
        come.extend(map_in_processes(ended, [1, 2, 3, 4, 5, 6], jobs=2, name=str))
    done = map_in_processes(ended, [1, 2, 3, 4], jobs=2)
    assert list(done) == [1, 4, 9, 16]


def test_little_work_gets_one_process_and_a_crash_in_it_is_told_alike():
    workers = set(map_in_processes(lambda _: os.getpid(), range(6), jobs=2, little=True))
    assert len(workers) == 1
    assert os.getpid() not in workers
    come = []
    with pytest.raises(Crash) as caught:
        come.extend(map_in_processes(ended, [1, 2, 5, 6], jobs=2, name=lambda k: f"part {k}", little=True))
    assert (caught.value.subject, caught.value.cause) == ("part 5", SEGMENTATION_FAULT)
    assert list(map_in_processes(ended, [1, 2, 3], jobs=2, little=True)) == [1, 4, 9]


def no_fork():
    raise AssertionError("forked where native threads may have run")


def test_where_native_threads_ran_nothing_is_forked(monkeypatch):
    processes.threads_ran()
    monkeypatch.setattr(os, "fork", no_fork)
    here = os.getpid()
    assert apart(divmod, 17, 5) == (3, 2)
    assert apart(os.getpid) != here
    assert set(map_in_processes(lambda _: os.getpid(), range(6), jobs=2)) == {here}
    with pytest.raises(ZeroDivisionError):
        apart(divmod, 1, 0)
    with pytest.raises(Crash) as caught:
        apart(os.abort)
    assert caught.value.cause == "signal 6 (SIGABRT)"
    with pytest.raises(Crash) as caught:
        apart(os._exit, 3)
    assert caught.value.cause == "exit code 3"


def test_what_native_code_prints_is_no_answer():
    processes.threads_ran()
    assert apart(os.system, "echo said; exit 0") == 0


PROGRAM = """
import os, sys
import numpy as np
from pathlib import Path
from kinform import stages
from kinform.foundation import processes
from kinform.form.meshes.health import build_mesh
from kinform.form.meshes.raw import RawMesh
from support.solids import ball, box, save

folder = Path(sys.argv[1])
save(box(-20, 20, -20, 20, -10, 0), folder / "plate.stl")
save(ball(9, 64).translate((0, 0, 5)), folder / "ball.stl")
parts = "".join(f'[[part]]\\nname = "{name}"\\nmesh = "{name}.stl"\\n' for name in ("plate", "ball"))
(folder / "a.toml").write_text('schema = 1\\n[assembly]\\nname = "a"\\nunits = "mm"\\n' + parts)
design = stages.contacts(stages.import_(folder / "a.toml"))
assert design.contacts.interferences and processes._threaded
os.fork = None
corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
cube = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
                 [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])
both = np.concatenate([corners, corners + [1.0, 1.0, 0.0]])
raw = RawMesh(both, np.concatenate([cube, cube + 8]))
print(build_mesh(raw, 1.0, None, path="m", body=None, solid=True).health.manifold_status)
print("main", __name__)
"""
"""Two cubes that share an edge, read by a program that has cut solids; what it prints it prints once."""


def test_a_program_that_has_cut_solids_reads_meshes_with_shared_edges(tmp_path):
    found = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(tmp_path)],
        capture_output=True, text=True, timeout=120, env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )  # fmt: skip
    assert found.stdout.split("\n")[:2] == ["NoError", "main __main__"], found.stderr


def test_the_heaviest_are_begun_first_and_results_come_in_order(tmp_path):
    log = tmp_path / "begun"

    def noted(number: int) -> int:
        with log.open("a") as file:
            file.write(f"{number}\n")
        time.sleep(0.05)
        return number

    assert list(map_in_processes(noted, [1, 2, 3, 4, 5], jobs=2, weights=[1, 2, 5, 4, 3])) == [1, 2, 3, 4, 5]
    begun = [int(line) for line in log.read_text().split()]
    assert set(begun[:2]) == {3, 4}
    assert begun[-1] in (1, 2)


def test_something_else_is_done_only_while_several_processes_are_at_work():
    done: list[int] = []
    meanwhile = lambda: done.append(os.getpid())
    for jobs, items, little in ((1, [1, 2], False), (2, [1], False), (2, [1, 2], True)):
        assert list(map_in_processes(abs, items, jobs, little=little, meanwhile=meanwhile)) == items
    assert done == []
    assert list(map_in_processes(abs, [1, 2], 2, meanwhile=meanwhile)) == [1, 2]
    assert done == [os.getpid()]


@pytest.mark.skipif(sys.platform != "linux", reason="children end with their parent on Linux only")
@pytest.mark.parametrize("many", [True, False])
def test_workers_end_with_the_process_that_waits_for_them(many: bool, tmp_path: Path) -> None:
    code = (
        "import os, sys, time\n"
        "from pathlib import Path\n"
        "from kinform.foundation.processes import in_own_process, map_in_processes\n"
        "def held(k):\n"
        "    Path(str(os.getpid())).touch()\n"
        "    time.sleep(600)\n"
        f"list(map_in_processes(held, [1, 2], 2)) if {many} else in_own_process(lambda: held(1))\n"
    )
    waiting = subprocess.Popen([sys.executable, "-c", code], cwd=tmp_path)
    while len(workers := [int(path.name) for path in tmp_path.iterdir()]) < 1 + many:
        assert waiting.poll() is None
        time.sleep(0.01)
    waiting.kill()
    waiting.wait()
    end = time.monotonic() + 60
    while any(Path(f"/proc/{worker}/stat").exists() for worker in workers):
        assert time.monotonic() < end
        time.sleep(0.01)

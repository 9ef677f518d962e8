"""Tasks in forks: whatever becomes of one is an answer."""

from __future__ import annotations

import sys

import pytest

from kinform.batch import desk
from kinform.batch.desks import Desk
from kinform.batch.task import DIED, INPUT, INTERNAL, MEMORY, TIME, Limits, Task

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits and deaths of forks")


def asked(function: str, limits: Limits | None = None, **arguments):
    return desk.attend(Task("t", function, arguments, limits or Limits()))


def test_a_result_is_answered():
    answer = asked("json:loads", s="[1, 2]")
    assert (answer.key, answer.result, answer.failure) == ("t", [1, 2], None)


def test_a_large_result_is_answered_whole():
    assert asked("numpy:zeros", shape=3_000_000).result.nbytes == 24_000_000


def test_a_crash_is_told_with_its_signal():
    failure = asked("faulthandler:_sigabrt").failure
    assert failure.kind == DIED and "SIGABRT" in failure.problems[0].message


def test_a_task_ends_at_its_time_with_all_that_it_began():
    answer = asked("subprocess:run", Limits(seconds=0.3), args=["sleep", "60"])
    assert answer.failure.kind == TIME and 0.3 <= answer.seconds < 30.0


def test_a_task_ends_at_its_memory():
    psutil = pytest.importorskip("psutil")
    limit = psutil.Process().memory_info().rss + 200_000_000  # of the fork alone: this process may have a browser
    failure = asked("subprocess:run", Limits(memory=limit), args=[sys.executable, "-c", _GREEDY]).failure
    assert failure.kind == MEMORY


_GREEDY = "import time; b = bytearray(10**9); b[::4096] = b'x' * len(b[::4096]); time.sleep(60)"


def test_input_that_cannot_be_used_is_told_with_every_problem(tmp_path):
    (tmp_path / "a.toml").write_text("schema = 1\n[assembly]\n")
    answer = asked("kinform.batch.work:imported", source=str(tmp_path / "a.toml"))
    assert answer.failure.kind == INPUT and len(answer.failure.problems) >= 2


def test_what_is_not_foreseen_is_an_internal_error_with_its_place():
    failure = asked("json:loads", s="[").failure
    assert failure.kind == INTERNAL and "JSONDecodeError" in failure.problems[0].message


def test_another_kinform_refuses():
    answer = desk.do(Task("t", "json:loads", {"s": "1"}, code="other"))
    assert answer.failure is not None and answer.result is None


def test_a_desk_goes_on_after_a_crash_and_its_own_death_is_an_answer():
    one = Desk()
    try:
        assert one.ask(Task("a", "faulthandler:_sigabrt")).failure.kind == DIED
        large = "x" * 10_000_000
        assert one.ask(Task("b", "json:dumps", {"obj": large})).result == f'"{large}"'
        one._process.kill()
        assert one.ask(Task("c", "json:loads", {"s": "1"})).failure.kind == DIED
        assert not one.alive
    finally:
        one.close()

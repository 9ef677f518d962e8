"""What a process that native code ends becomes: an error with the name of what it was at work on."""

from __future__ import annotations

import faulthandler
import os
import signal
import time

import pytest

from kinform.errors import KinformError
from kinform.foundation.processes import Crash, in_own_process, map_in_processes


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
    with pytest.raises(Crash, match="SIGSEGV"):
        in_own_process(lambda: ended(5))
    with pytest.raises(Crash, match="exit code 3"):
        in_own_process(lambda: os._exit(3))


def test_a_crash_among_several_is_told_with_the_name_of_the_thing():
    with pytest.raises(KinformError, match=r"part 5: .*SIGSEGV"):
        list(map_in_processes(ended, range(9), jobs=2, name=lambda k: f"part {k}"))


def test_a_crash_of_the_only_thing_is_told_too():
    with pytest.raises(KinformError, match=r"part 5: .*SIGSEGV"):
        list(map_in_processes(ended, [5], jobs=2, name=lambda k: f"part {k}"))


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
    with pytest.raises(KinformError, match=r"part 5: .*SIGSEGV"):
        come.extend(map_in_processes(ended, [1, 2, 5, 6], jobs=2, name=lambda k: f"part {k}", little=True))
    assert list(map_in_processes(ended, [1, 2, 3], jobs=2, little=True)) == [1, 4, 9]


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

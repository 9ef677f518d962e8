"""A confined process has nothing but questions to its parent."""

from __future__ import annotations

import os
import socket
import subprocess

import pytest

from kinform.foundation.confined import Confined, confined
from kinform.foundation.processes import Crash

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")


def alone(action, answer=lambda question: b"", prepare=lambda: None):
    """The text of what an action gives in a confined process."""
    return confined(lambda ask: str(action(ask)).encode(), answer, prepare, seconds=2, memory=100 << 20).decode()


def test_it_asks_and_answers():
    assert alone(lambda ask: ask(b"x" * 100_000).decode(), lambda question: question[:3] + b"!") == "xxx!"


HARM = {
    "reads a file": lambda: os.open(os.devnull, os.O_RDONLY),
    "lists a folder": lambda: os.listdir("/"),
    "removes a file": lambda: os.remove("nothing"),
    "opens a socket": lambda: socket.socket(),
    "starts a program": lambda: subprocess.run(["true"], check=False),
    "runs a shell": lambda: os.system("true"),
    "forks": lambda: os.fork(),
    "ends another process": lambda: os.kill(os.getppid(), 0),
    "imports a module": lambda: __import__("this"),
    "runs code": lambda: eval("1"),
}


@pytest.mark.parametrize("what", HARM)
def test_it_is_ended_at(what):
    with pytest.raises(Confined):
        alone(lambda ask: HARM[what]())


def test_it_has_no_environment_and_no_open_files(monkeypatch, tmp_path):
    monkeypatch.setenv("SECRET", "told")
    with open(tmp_path / "kept", "w") as kept:
        assert "told" not in alone(lambda ask: dict(os.environ))

        def write(ask):
            try:
                return os.write(kept.fileno(), b"x")
            except OSError:
                return "closed"

        assert alone(write) == "closed"


def test_its_memory_is_bounded():
    with pytest.raises(MemoryError):
        raise MemoryError if alone(_fills) == "full" else AssertionError


def _fills(ask):
    try:
        return len(b"x" * (200 << 20))
    except MemoryError:
        return "full"


def test_without_an_answer_it_is_a_crash():
    with pytest.raises(Crash):
        alone(lambda ask: os._exit(3))


def test_what_the_parent_raises_is_raised():
    def refuse(question):
        raise KeyError("no")

    with pytest.raises(KeyError):
        alone(lambda ask: ask(b"?"), refuse)

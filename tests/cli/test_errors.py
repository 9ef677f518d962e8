"""From exceptions to messages and exit codes, for every kind of end that a command can come to."""

from __future__ import annotations

import errno
from collections.abc import Callable

import pytest

from kinform.errors import InputError, Problem, ResultsError, StageError
from kinform_cli import console
from kinform_cli.main import main


@pytest.fixture
def failing(monkeypatch: pytest.MonkeyPatch) -> Callable[[BaseException], int]:
    """Run a command inside which this is raised; returns the exit code."""
    from kinform import consistency

    def run(error: BaseException, *options: str) -> int:
        def fail(code: str) -> str:
            raise error

        monkeypatch.setattr(consistency, "explain", fail)
        return main(["explain", "KF101", *options])

    return run


def test_every_problem_of_the_input_is_printed_with_place_and_remedy(
    failing: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    problems = [
        Problem("no such mesh [m6]", "arm.toml", 12, "check the name"),
        Problem("unit is missing", "arm.toml", 3),
        Problem("cannot be used"),
    ]
    assert failing(InputError(problems)) == 2
    assert capsys.readouterr().err.splitlines() == [
        "arm.toml:12: error: no such mesh [m6]",
        "  remedy: check the name",
        "arm.toml:3: error: unit is missing",
        "kinform: error: cannot be used",
        "kinform: error: 3 errors; nothing was written",
    ]


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (ResultsError(Problem("not HDF5", "a.h5", remedy="name another")), "a.h5: error: not HDF5"),
        (StageError("mass", "joints"), "kinform joints"),
        (PermissionError(errno.EACCES, "Permission denied", "a.h5"), "a.h5: error: Permission denied\n  remedy:"),
        (OSError(errno.ENOSPC, "No space left on device"), "No space left on device\n  remedy: "),
        (MemoryError(), "memory"),
        (KeyboardInterrupt(), "interrupted"),
        (ZeroDivisionError("float division"), "internal error: ZeroDivisionError: float division"),
        (RecursionError("too deep"), "internal error: RecursionError"),
        (SystemError("odd"), "internal error"),
        (EOFError(), "error:"),
    ],
    ids=lambda value: type(value).__name__ if isinstance(value, BaseException) else "",
)
def test_no_end_but_a_verdict_is_1_and_none_shows_a_traceback(
    error: BaseException, said: str, failing: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    assert failing(error) == 2
    text, errors = capsys.readouterr()
    assert text == ""
    assert said in errors
    assert "Traceback" not in errors


def test_debug_shows_where_it_happened(
    failing: Callable[..., int], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert failing(ZeroDivisionError("division"), "--debug") == 2
    assert "Traceback" in capsys.readouterr().err
    monkeypatch.setenv("KINFORM_DEBUG", "1")
    assert failing(ZeroDivisionError("division")) == 2
    assert "Traceback" in capsys.readouterr().err
    monkeypatch.delenv("KINFORM_DEBUG")
    assert failing(ZeroDivisionError("division")) == 2
    assert "Traceback" not in capsys.readouterr().err


def test_a_module_that_cannot_be_imported_is_a_crash_not_a_finding(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "kinform.results", None)
    monkeypatch.delattr("kinform.results", raising=False)
    assert main(["show", "a.h5"]) == 2
    assert "ModuleNotFoundError" in capsys.readouterr().err


def test_long_messages_are_not_wrapped_off_a_terminal(
    failing: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    message = "word " * 60 + "end"
    failing(InputError([Problem(message, "f.toml", 1)]))
    assert capsys.readouterr().err == f"f.toml:1: error: {message}\n"


def test_quiet_silences_summaries_and_warnings_but_not_errors(
    failing: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    failing(InputError([Problem("wrong")]), "--quiet")
    console.say("a summary")
    console.warn("a warning")
    assert capsys.readouterr().err == "kinform: error: wrong\n"
    console.settings.quiet = False
    console.say("part [m6]")
    console.warn("part [red]x[/red]")
    assert capsys.readouterr().err == "part [m6]\nwarning: part [red]x[/red]\n"


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["show", "joints", "F.h5"], "remedy: the file comes first, as in: kinform show F.h5 assembly"),
        (["show", "F.h5", "simulaton"], "TOPIC is one of assembly, contacts, "),
        (["show", "F.h5", "simulaton"], "remedy: did you mean simulation?"),
        (["show", "F.h5", "joints", "--format", "jsn"], "remedy: did you mean json?"),
    ],
)
def test_a_value_that_is_no_choice_is_told_with_those_there_are(
    arguments: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    assert told in capsys.readouterr().err

"""From exceptions to messages and exit codes.

0: written, or verified. 1: findings. 2: not written, or not verified. An exception is always 2: a
crash must never read as a verdict.
"""

from __future__ import annotations

import errno
import re
import traceback
from typing import TYPE_CHECKING

from kinform.foundation.escapes import one_line
from kinform_cli import console, interrupts

if TYPE_CHECKING:
    from kinform.errors import Problem


OK = 0
"""Exit code: written, or verified."""
FINDINGS = 1
"""Exit code: there are findings."""
NOT_VERIFIED = 2
"""Exit code: not written, or not verified; typer has the same for wrong arguments."""

_NO_CHOICE = re.compile(
    r"Invalid value for (?P<where>.+?): (?:Value error, )?'(?P<given>.*)' is not one of (?P<choices>'.*')"
)
"""What typer says of a value that is none of those that there are."""
_OF_SYSTEM = {
    errno.EACCES: "see who may read and write there, or name another place",
    errno.EPERM: "see who may read and write there, or name another place",
    errno.EROFS: "name a place that can be written",
    errno.ENOSPC: "make room for it",
    errno.EDQUOT: "make room for it",
    errno.ENAMETOOLONG: "name a shorter path",
    errno.ELOOP: "see where its links lead",
    errno.EMFILE: "allow more open files, or use fewer --jobs",
}
"""What to do about an error of the system."""


def refuse(message: str, *, file: object = None, remedy: str | None = None) -> Exception:
    """The exception to raise when the command line asks for what cannot be done."""
    from kinform.errors import InputError, Problem

    return InputError([Problem(message, file=None if file is None else str(file), remedy=remedy)])


def report(error: BaseException) -> int:
    """Print what went wrong on stderr; returns the exit code, which is never 0 or 1."""
    from kinform.errors import InputError, KinformError, ResultsError

    if console.settings.debug and not _is_usage(error):
        console.tell(_traceback(error))
    if interrupts.asked():
        error = KeyboardInterrupt()
    if isinstance(error, InputError):
        for problem in error.problems:
            _print_problem(problem)
        if len(error.problems) > 1:
            _print("kinform", f"{len(error.problems)} errors; nothing was written")
    elif isinstance(error, ResultsError):
        _print_problem(error.problem)
    elif isinstance(error, KinformError):
        _print("kinform", str(error))
    elif isinstance(error, KeyboardInterrupt) or type(error).__name__ == "Abort":
        _print("kinform", "interrupted; an output file that existed is as it was")
    elif _is_usage(error):
        _print_usage(error)
    elif isinstance(error, OSError):
        _print_os_error(error)
    elif isinstance(error, MemoryError):
        _print("kinform", "out of memory", "use fewer --jobs, coarser meshes, or a larger machine")
    else:
        _print(
            "kinform",
            f"internal error: {type(error).__name__}: {error}",
            None if console.settings.debug else "run it again with --debug for the traceback, and report it",
        )
    return NOT_VERIFIED


def from_typer(code: object) -> int:
    """The exit code for what typer returned: commands return theirs, Ctrl-C is its own affair."""
    # What typer makes of Ctrl-C.
    if code == 130:
        return report(KeyboardInterrupt())
    return code if isinstance(code, int) else OK


def of_output(code: int) -> int:
    """The exit code after all that was to be printed: what did not all reach its reader is no pass. A reader that left
    (`| head`) is told nothing, and findings stay findings; a disk that is full is told, and what it holds is half of an
    answer."""
    if console.settings.cut is None:
        return code
    if not isinstance(console.settings.cut, BrokenPipeError):
        _print(
            "kinform", f"not all of the output could be written: {console.settings.cut.strerror}", "make room for it"
        )
        return NOT_VERIFIED
    return FINDINGS if code == FINDINGS else NOT_VERIFIED


def _traceback(error: BaseException) -> str:
    return "".join(traceback.format_exception(error)).rstrip()


def _is_usage(error: BaseException) -> bool:
    """Whether typer raised it; its class moved between modules from one release to the next."""
    return hasattr(error, "format_message") and hasattr(error, "exit_code")


def _print_usage(error: BaseException) -> None:
    context = getattr(error, "ctx", None)
    command = context.command_path if context is not None else "kinform"
    message = error.format_message().rstrip(".")  # type: ignore[attr-defined]
    said = _NO_CHOICE.fullmatch(message)
    if said is None:
        _print(command, message, f"see `{command} --help`")
        return
    from difflib import get_close_matches
    from pathlib import Path

    where, given = said["where"].replace("'", ""), said["given"]
    choices = [choice.strip("' ") for choice in said["choices"].split(",")]
    likely = get_close_matches(given.lower(), choices, n=1)
    remedy = f"see `{command} --help`"
    if likely:
        remedy = f"did you mean {likely[0]}? {remedy}"
    elif Path(given).suffix and not where.startswith("--"):
        remedy = f"the file comes first, as in: {command} {given} {choices[0]}; {remedy}"
    _print(command, f"{where} is one of {', '.join(choices)}, not {given!r}", remedy)


def _print_os_error(error: OSError) -> None:
    place = str(error.filename) if error.filename is not None else "kinform"
    _print(place, error.strerror or str(error), _OF_SYSTEM.get(error.errno or 0))


def _print_problem(problem: Problem) -> None:
    place = problem.file if problem.file is not None else "kinform"
    _print(place + problem.within, problem.message, problem.remedy)


def _print(place: str, message: str, remedy: str | None = None) -> None:
    """`place: error: message`, as compilers write it, so that editors find the place."""
    from rich.text import Text

    text = Text.assemble((one_line(place), "bold"), ": ", ("error:", "bold red"), f" {one_line(message)}")
    if remedy:
        text.append(f"\n  remedy: {one_line(remedy)}")
    console.tell(text)

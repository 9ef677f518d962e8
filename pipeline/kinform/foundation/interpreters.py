"""New interpreters, and other programs, that take no code from the working folder.

Python looks for modules in the working folder first where it runs a module or a text (`-m`, `-c`), and where an entry
of its path is empty or relative. Programs are looked for there where an entry of PATH is, and on Windows always.
The working folder may be a stranger's repository: nothing of it is run.
"""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterator

from kinform.foundation import user_folders

_SAFE_PATH = "PYTHONSAFEPATH"
_OURS = "kinform"
"""What the variable is set to here (any text has the same effect), to tell it from what the user set."""

_HOME = "KINFORM_HOME"
"""The user's variable HOME, where `safe_children` set another."""

_PLACES = ("PYTHONPYCACHEPREFIX", "PYTHONUSERBASE", "DASK_CONFIG", "DASK_ROOT_CONFIG")
"""Variables that name folders or files which hold code or say which code runs."""


def command(*arguments: str) -> list[str]:
    """The words that start this interpreter again."""
    return [sys.executable, "-P", *arguments]


def search_path() -> list[str]:
    """Where this process finds modules, without entries that are relative to the working folder."""
    return [one for one in sys.path if os.path.isabs(one) or (one and not os.path.exists(one))]  # and names of hooks


def environment(**extra: str) -> dict[str, str]:
    """The environment of an interpreter that finds modules where this one does."""
    kept = {name: value for name, value in of_user().items() if name not in _PLACES or os.path.isabs(value)}
    return kept | {"PYTHONPATH": os.pathsep.join(search_path())} | extra


def of_user() -> dict[str, str]:
    """The environment for programs of the user: without what `safe_children` added."""
    out = {name: value for name, value in os.environ.items() if (name, value) != (_SAFE_PATH, _OURS)}
    if _HOME in out:
        out["HOME"] = out.pop(_HOME)
    return out


@contextlib.contextmanager
def safe_children() -> Iterator[None]:
    """Interpreters that libraries start meanwhile, and those that these start, do not look in the working folder.

    Where HOME is a folder of strangers, it is the home that the system states: Dask reads there which code to run.
    """
    before = {name: os.environ.get(name) for name in (_SAFE_PATH, "PYTHONPATH", "HOME", _HOME, *_PLACES)}
    if "HOME" in os.environ and _HOME not in os.environ and user_folders.foreign_home():
        os.environ[_HOME] = os.environ["HOME"]
        os.environ["HOME"] = user_folders.stated_home() or os.devnull
    os.environ.setdefault(_SAFE_PATH, _OURS)
    os.environ["PYTHONPATH"] = os.pathsep.join(search_path())
    for name in _PLACES:
        if not os.path.isabs(os.environ.get(name, "")):
            os.environ.pop(name, None)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def program(name: str) -> str | None:
    """Where a program is that an absolute entry of PATH finds; None where none does."""
    ends = os.environ.get("PATHEXT", ".EXE").split(os.pathsep) if sys.platform == "win32" else [""]
    for folder in filter(os.path.isabs, os.get_exec_path()):
        for end in ends:
            found = os.path.join(folder, name + end)
            if os.path.isfile(found) and os.access(found, os.X_OK):
                return found
    return None

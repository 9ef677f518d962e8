"""Calls git in a repository that somebody else may have filled.

Only plumbing that reads is called: no filter, hook, textconv or external diff is part of it. The repository is named,
not searched for by git, so that no folder that merely looks like one is used. Configuration of the system and the user,
and variables for git, are not read; what the configuration of the repository could start is switched off; nothing is
fetched, nothing is written.
"""

from __future__ import annotations

import os
import subprocess
from collections.abc import Sequence
from pathlib import Path

from kinform.foundation.boundary import repository_of

SECONDS = 120.0
"""s that one call may take: a million files are listed in some 10 s. Chosen, not measured."""

_SETTINGS = ("core.fsmonitor=false", "core.untrackedCache=false", "core.hooksPath=/dev/null", "core.quotePath=false",
             "core.excludesFile=", "core.attributesFile=", "core.alternateRefsCommand=", "core.sshCommand=false",
             "credential.helper=", "protocol.allow=never", "safe.bareRepository=explicit")  # fmt: skip
_VARIABLES = {
    "GIT_CONFIG_NOSYSTEM": "1", "GIT_CONFIG_SYSTEM": os.devnull, "GIT_CONFIG_GLOBAL": os.devnull,
    "GIT_ATTR_NOSYSTEM": "1", "GIT_OPTIONAL_LOCKS": "0", "GIT_LITERAL_PATHSPECS": "1", "GIT_NO_LAZY_FETCH": "1",
    "GIT_NO_REPLACE_OBJECTS": "1", "GIT_ALLOW_PROTOCOL": "none", "GIT_TERMINAL_PROMPT": "0", "GIT_ASKPASS": "",
    "LC_ALL": "C",
}  # fmt: skip


class GitError(Exception):
    """Git is not installed, or cannot do what it was asked: `reason` says which."""

    def __init__(self, reason: str):
        self.reason = reason
        super().__init__(reason)


def root_of(folder: str | os.PathLike[str]) -> Path | None:
    """The top folder of the innermost repository that a folder is in, without links; None where it is in none."""
    root = repository_of(folder)
    return None if root is None else Path(root)


def git(root: Path, *arguments: str) -> bytes:
    """What git prints in the repository whose top folder is `root`. Raises GitError where it fails."""
    program = _program()
    if program is None:
        raise GitError("git is not installed")
    settings = [word for setting in _SETTINGS for word in ("-c", setting)]
    place = ["-C", str(root), f"--git-dir={root / '.git'}", f"--work-tree={root}"]
    outer = {name: value for name, value in os.environ.items() if not name.upper().startswith("GIT_")}
    try:
        done = subprocess.run(
            [program, "--no-pager", *place, *settings, *arguments], stdin=subprocess.DEVNULL, capture_output=True,
            check=False, timeout=SECONDS, env=outer | _VARIABLES,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        raise GitError(f"git was not done after {SECONDS:g} s") from None
    except OSError as error:
        raise GitError(f"git cannot be started: {error.strerror}") from None
    if done.returncode != 0:
        raise GitError("git cannot read this repository")
    return done.stdout


def names(output: bytes) -> list[str]:
    """The names in a list that ends each with a zero byte (`-z`), as the file system has them."""
    return [os.fsdecode(name) for name in output.split(b"\0") if name]


def _program(folders: Sequence[str] | None = None) -> str | None:
    """Git, from the folders of PATH that are absolute: one of the working folder is never started."""
    name = "git.exe" if os.name == "nt" else "git"
    there = (os.path.join(folder, name) for folder in folders or os.get_exec_path() if os.path.isabs(folder))
    return next((path for path in there if os.path.isfile(path) and os.access(path, os.X_OK)), None)

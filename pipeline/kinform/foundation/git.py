"""git, asked about a repository that a stranger may have made.

A repository can name programs that git runs: hooks, monitors of files, filters, converters, transports. None of those
that the repository itself names is run; those that the user's own configuration names are. Repositories that lie
within another as plain folders (bare ones) are not entered, and nothing is fetched.
"""

from __future__ import annotations

import os
import re
import subprocess

from kinform.foundation import interpreters, user_folders

_SET = {
    "core.fsmonitor": "false", "core.hooksPath": os.devnull, "core.untrackedCache": "false",
    "core.sshCommand": "false", "core.gitProxy": "", "core.pager": "cat", "credential.helper": "",
    "safe.bareRepository": "explicit", "protocol.allow": "never",
}  # fmt: skip
"""Configuration for every question, which comes before that of the repository."""

_FILTER = re.compile(r"(filter\..*\.)(clean|smudge|process)", re.I | re.S)
"""Keys whose values are programs that git runs to compare files."""
_DIFFS = ("diff", "diff-files", "diff-index", "diff-tree", "log", "show")
"""Commands that show changes by other programs, unless told not to."""

_FROM_REPOSITORY = ("local", "worktree")
"""Scopes of configuration that lie within the repository, with what they include."""


class NoGit(Exception):
    """git is not installed, or PATH finds it in the working folder only."""


def ask(folder: str | os.PathLike[str], *arguments: str) -> bytes | None:
    """What git prints about the repository that a folder is in; None where it fails. Raises NoGit."""
    listed = _run(folder, {}, "config", "--list", "--includes", "--show-scope", "--name-only", "-z")
    words = (listed or b"").decode("utf-8", "surrogateescape").split("\0")
    foreign = (*_FROM_REPOSITORY, *(("global",) if user_folders.foreign_home() else ()))
    named = {key for scope, key in zip(words[::2], words[1::2], strict=False) if scope in foreign}
    off: dict[str, str] = {}
    for key in sorted(named):
        if (found := _FILTER.fullmatch(key)) is not None:  # a filter that is required and missing is an error
            off |= {key: "", f"{found[1]}required": "false"}
    first = [arguments[0], "--no-ext-diff", "--no-textconv"] if arguments[0] in _DIFFS else [arguments[0]]
    return _run(folder, off, *first, *arguments[1:])


def _run(folder: str | os.PathLike[str], settings: dict[str, str], *arguments: str) -> bytes | None:
    program = interpreters.program("git")
    if program is None:
        raise NoGit
    environment = interpreters.of_user()
    for name in ("GIT_EXTERNAL_DIFF", "GIT_SSH", "GIT_SSH_COMMAND", "GIT_PROXY_COMMAND"):
        environment.pop(name, None)
    # by variables: a key may contain "=", which ends it on the command line
    first = int(environment.get("GIT_CONFIG_COUNT") or 0)
    for number, (key, value) in enumerate((_SET | settings).items(), start=first):
        environment |= {f"GIT_CONFIG_KEY_{number}": key, f"GIT_CONFIG_VALUE_{number}": value}
    environment |= {
        "GIT_CONFIG_COUNT": str(first + len(_SET | settings)), "GIT_ALLOW_PROTOCOL": "none", "GIT_NO_LAZY_FETCH": "1",
        "GIT_OPTIONAL_LOCKS": "0", "GIT_TERMINAL_PROMPT": "0",
    }  # fmt: skip
    try:
        done = subprocess.run(
            [program, "--no-pager", "-C", os.fspath(folder), *arguments], stdin=subprocess.DEVNULL, capture_output=True,
            env=environment, check=False,
        )  # fmt: skip
    except OSError:
        raise NoGit from None
    return done.stdout if done.returncode == 0 else None

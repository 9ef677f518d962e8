"""Which designs a commit touches: those of whose files one differs from that commit, sub-assemblies followed.

Nothing is parsed as a design, which may be faulty now: every text in a manifest or a description that could name a
changed file counts, by its last part, with what is computed in it (`$(find pkg)`, `${name}.stl`) as a wildcard. So a
design may be run for nothing, and is never left out because a reference was not understood. What a link points to
counts as that, and a submodule whose commit differs as all that is in it. Files that git ignores, or that lie outside
of the repository, have no revision: they do not count.
"""

from __future__ import annotations

import fnmatch
import html
import json
import os
import re
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from kinform.batch.discovery import DESCRIPTIONS, Found
from kinform.errors import InputError, Problem
from kinform.foundation import git
from kinform.foundation.regular_files import not_a_file

_FOLLOWED = (".toml", ".gltf", ".obj", ".dae", ".yaml", ".yml", ".csv", *DESCRIPTIONS)
"""Suffixes of files that name others, or may."""
_QUOTED = re.compile(r"\"([^\"\n]+)\"|'([^'\n]+)'|>([^<>\n]+)<|^(?:mtllib|map_\w+)\s+(\S+)", re.M)
_COMPUTED = re.compile(r"\$\{[^}]*\}|\$\([^)]*\)")


def changed_since(found: Sequence[Found], revision: str) -> tuple[Found, ...]:
    """Those of the designs that differ from how they were at the revision of git, in whatever they are made of.

    Raises InputError where there is no repository, or no such revision.
    """
    by_root: dict[str, set[str]] = {}
    for one in found:
        by_root.setdefault(_root(one.source), set())
    for root in by_root:
        by_root[root] = _changed(root, revision)
    return tuple(one for one in found if _reaches(one.source, by_root[_root(one.source)], _root(one.source)))


def _reaches(source: Path, changed: set[str], root: str) -> bool:
    """Whether a design is, or names in any depth, a changed file."""
    if not changed or _place(os.path.abspath(source)) in changed:
        return bool(changed)
    bases: dict[str, list[str]] = {}
    for path in changed:
        bases.setdefault(os.path.basename(path), []).append(path)
    seen: set[str] = set()
    waiting = [os.path.realpath(source)]
    while waiting:
        path = waiting.pop()
        if path in seen:
            continue
        seen.add(path)
        if path in changed:
            return True
        for pattern, wild in _names(path):
            hit = fnmatch.filter(bases, pattern) if wild else [pattern] if pattern in bases else []
            if hit:
                return True
            known = _files(root)
            names = fnmatch.filter(known, pattern) if wild else [pattern]
            files = [file for name in names for file in known.get(name, ())]
            if not changed.isdisjoint(files):  # by a link, which has a name of its own
                return True
            if os.path.splitext(pattern)[1].lower() in _FOLLOWED:
                waiting += files
    return False


@cache
def _names(path: str) -> tuple[tuple[str, bool], ...]:
    """The last parts of all texts in a file that could name files, and whether each is a pattern."""
    if os.path.splitext(path)[1].lower() not in _FOLLOWED or not_a_file(path) is not None:
        return ()
    try:
        text = Path(path).read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ()
    out = set()
    for piece in _texts(path, text):
        name = _COMPUTED.sub("*", piece.strip()).replace("\\", "/").rpartition("/")[2]
        if "." in name or "*" in name:
            out.add((name, "*" in name))
    return tuple(sorted(out))


def _texts(path: str, text: str) -> Iterator[str]:
    """Everything in quotes, between tags, or after the words of an OBJ that name files; without escapes."""
    kind = os.path.splitext(path)[1].lower()
    if kind == ".gltf":
        try:
            whole = json.loads(text.removeprefix("\ufeff"))
        except ValueError:
            return
        for item in [*whole.get("buffers", ()), *whole.get("images", ())]:
            if isinstance(item.get("uri"), str) and not item["uri"].startswith("data:"):
                yield unquote(item["uri"])
        return
    if kind == ".toml":
        with suppress(ValueError, RecursionError):  # of a faulty manifest, what stands in quotes
            yield from _strings(tomllib.loads(text.removeprefix("\ufeff")))
    for match in _QUOTED.finditer(text):
        yield html.unescape(next(filter(None, match.groups())))


def _strings(value: Any) -> Iterator[str]:
    """All texts in a table, in any depth."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict | list):
        for inner in value.values() if isinstance(value, dict) else value:
            yield from _strings(inner)


@cache
def _files(root: str) -> dict[str, list[str]]:
    """All files of the repository that are tracked or could be, by name."""
    out: dict[str, list[str]] = {}
    own = _git(root, "ls-files", "-z", "--cached", "--others", "--exclude-standard").split("\0")
    inner = _git(root, "ls-files", "-z", "--cached", "--recurse-submodules").split("\0")
    for path in dict.fromkeys([*own, *inner]):
        if path:
            out.setdefault(os.path.basename(path), []).append(os.path.realpath(os.path.join(root, path)))
    return out


def _changed(root: str, revision: str) -> set[str]:
    """Absolute paths of what differs from the revision, or is not tracked; also what is gone."""
    commit = _git(root, "rev-parse", "--verify", "--quiet", "--end-of-options", f"{revision}^{{commit}}").strip()
    if not commit:
        remedy = "correct its name; or fetch it, where the clone is shallow: git fetch --unshallow"
        raise InputError([Problem(f"there is no revision {revision}", root, None, remedy)])
    differing = _git(root, "diff", "-z", "--name-only", "--no-renames", "--no-ext-diff", commit, "--").split("\0")
    fresh = _git(root, "ls-files", "-z", "--others", "--exclude-standard").split("\0")
    paths = [os.path.join(root, name) for name in _present(differing, fresh)]
    inner = [_files(path) for path in paths if os.path.isdir(path) and not os.path.islink(path)]  # submodules
    below = (file for files in inner for named in files.values() for file in named)
    return {*(_place(path) if os.path.islink(path) else os.path.realpath(path) for path in paths), *below}


def _place(path: str) -> str:
    """Where a file is, or the link itself where it is one: the folder without links."""
    return os.path.join(os.path.realpath(os.path.dirname(path)), os.path.basename(path))


def _present(*lists: Iterable[str]) -> Iterator[str]:
    return (name for names in lists for name in names if name)


@cache
def _root(source: Path) -> str:
    """The top of the repository that a file is in."""
    folder = os.path.dirname(os.path.abspath(source))
    top = _git(folder, "rev-parse", "--show-toplevel").strip()
    if not top:
        problem = Problem("is in no repository of git", str(source), None, "leave --changed-since out")
        raise InputError([problem])
    return os.path.realpath(top)


def _git(folder: str, *arguments: str) -> str:
    """What git prints; "" where it fails. Raises InputError where there is no git."""
    try:
        printed = git.ask(folder, *arguments)
    except git.NoGit:
        problem = Problem("--changed-since asks git, which is not installed", None, None, "install git")
        raise InputError([problem]) from None
    return (printed or b"").decode("utf-8", "surrogateescape")

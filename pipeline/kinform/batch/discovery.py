"""Which files below some paths are designs: manifests and robot descriptions, by their name and what they begin with.

Files that `.gitignore` leaves out are not looked at, with the rules of git: each folder's own, the nearer one decides,
up to the root of the repository. A file that is named itself is taken as it is. Descriptions that only others
include (xacro without a name, MJCF without `<mujoco>`) are no designs by themselves.
"""

from __future__ import annotations

import fnmatch
import os
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from kinform.errors import InputError, Problem
from kinform.form.constants import MANIFEST_BYTES
from kinform.form.sources import states_units
from kinform.formats.registry import HEAD_BYTES
from kinform.foundation.regular_files import not_a_file
from kinform.frozen import dataclass

DESCRIPTIONS = (".urdf", ".xacro", ".sdf", ".world", ".mjcf", ".xml")
"""Suffixes of files that are looked into, beside manifests."""

_ROOTS = {
    ".urdf": rb"<robot[\s/>]",
    ".xacro": rb"<robot\s[^>]*\bname\s*=",
    ".sdf": rb"<sdf[\s/>]",
    ".world": rb"<sdf[\s/>]",
    ".mjcf": rb"<mujoco[\s/>]",
    ".xml": rb"<mujoco[\s/>]",
}
"""What the root element of a description looks like, by suffix."""


@dataclass(frozen=True)
class Found:
    """A design, and where its results go."""

    source: Path
    """As messages show it."""
    name: str
    """Relative to the folder that all paths have in common; with "/"."""

    @property
    def results(self) -> str:
        """Path of the results below the folder of results: a/arm.toml gives a/arm.h5, a/arm.urdf gives
        a/arm.urdf.h5, so that no file decides where another's results are."""
        return (self.name.removesuffix(".toml") if self.name.endswith(".toml") else self.name) + ".h5"


_REMEDY = "name a folder of designs, or choose with --include; what .gitignore leaves out is found with --ignored"


def discover(
    paths: Sequence[Path], *, include: Sequence[str] = (), exclude: Sequence[str] = (), ignored: bool = False,
    results: Path | None = None,
) -> tuple[Found, ...]:  # fmt: skip
    """The designs at and below these paths, sorted by name.

    `include` are patterns of names or paths (`*.step`, `arms/*.toml`): only such files, and these whatever they begin
    with, if kinform reads their format. `exclude` are left out. `ignored`: also what git ignores. Nothing below the
    folder of `results` is a design. Raises InputError for a path that is not there, no design at all, and two designs
    whose results would be one file.
    """
    missing = [Problem("there is no such file or folder", str(p)) for p in paths if not p.exists()]
    if missing:
        raise InputError(missing)
    base = _common(paths)
    out: dict[Path, Found] = {}
    for path in paths:
        files = _below(path, ignored, results) if path.is_dir() else [path]
        for file in files:
            name = Path(os.path.relpath(os.path.abspath(file), base)).as_posix()
            named = file == path
            if not named and include and not any(_matches(name, pattern) for pattern in include):
                continue
            if any(_matches(name, pattern) for pattern in exclude):
                continue
            if named or (_readable(file) if include else is_design(file)):
                out.setdefault(Path(os.path.abspath(file)), Found(file, name))
    found = tuple(sorted(out.values(), key=lambda one: one.name))
    _complain(paths, found, include)
    return found


def is_design(path: Path) -> bool:
    """Whether a file is a manifest, or a robot description that stands for itself; one that cannot be read may be."""
    suffix = path.suffix.lower()
    if not_a_file(path) is not None:
        return False
    if suffix == ".toml":
        return _is_manifest(path)
    if suffix not in _ROOTS:
        return False
    try:
        with path.open("rb") as stream:
            head = stream.read(HEAD_BYTES)
    except OSError:
        return True
    return re.search(_ROOTS[suffix], re.sub(rb"<!--.*?-->", b"", head, flags=re.S)) is not None


def _is_manifest(path: Path) -> bool:
    """Whether it begins as manifests do; a faulty one still is one, and its run says what is wrong."""
    try:
        with path.open("rb") as stream:
            text = stream.read(MANIFEST_BYTES).decode("utf-8-sig", "replace").replace("\r", "\n")
    except OSError:
        return True
    begins = (r"^[ \t]*schema[ \t]*=", r"^[ \t]*\[[ \t]*assembly\b|^[ \t]*assembly[ \t]*[.=]")
    return all(re.search(pattern, text, re.M) for pattern in begins)


def _readable(path: Path) -> bool:
    return path.suffix.lower() == ".toml" or states_units(path)


def _matches(name: str, pattern: str) -> bool:
    """Whether a path matches: a pattern without "/" is one of file names."""
    return fnmatch.fnmatchcase(name if "/" in pattern else name.rpartition("/")[2], pattern)


def _common(paths: Sequence[Path]) -> str:
    """The deepest folder that is, or holds, all paths."""
    folders = [os.path.abspath(path if path.is_dir() else path.parent) for path in paths]
    return os.path.commonpath(folders)


def _below(top: Path, ignored: bool, results: Path | None) -> Iterator[Path]:
    """All files below a folder that git would not ignore; folders whose name begins with a dot are left out."""
    rules = None if ignored else IgnoreRules(top)
    apart = None if results is None else os.path.realpath(results)
    for folder, folders, files in os.walk(top):
        here = Path(folder)
        if rules is not None:
            rules.enter(here)
        folders[:] = sorted(
            name
            for name in folders
            if not name.startswith(".")
            and os.path.realpath(here / name) != apart
            and (rules is None or not rules.ignores(here / name, True))
        )
        for name in sorted(files):
            kept = name.endswith(".toml") or states_units(here / name)
            if kept and (rules is None or not rules.ignores(here / name, False)):
                yield here / name


class IgnoreRules:
    """What the `.gitignore` files on the way from the root of the repository say."""

    def __init__(self, top: Path):
        self._specs: dict[str, Any] = {}
        folder = os.path.abspath(top)
        above = [folder]
        while not os.path.exists(os.path.join(folder, ".git")) and os.path.dirname(folder) != folder:
            folder = os.path.dirname(folder)
            above.append(folder)
        self._root = folder if os.path.exists(os.path.join(folder, ".git")) else os.path.abspath(top)
        for each in reversed(above):
            if each.startswith(self._root):
                self.enter(Path(each))

    def enter(self, folder: Path) -> None:
        """Read the rules of a folder."""
        where = os.path.abspath(folder)
        if where in self._specs:
            return
        lines: list[str] = []
        files = [os.path.join(where, ".gitignore")]
        if where == self._root:
            files.insert(0, os.path.join(where, ".git", "info", "exclude"))
        for file in files:
            if os.path.isfile(file):
                lines += Path(file).read_text(encoding="utf-8", errors="replace").splitlines()
        spec = None
        if lines:
            import pathspec

            spec = pathspec.GitIgnoreSpec.from_lines(lines)
        self._specs[where] = spec

    def ignores(self, path: Path, folder: bool) -> bool:
        """Whether the nearest rules that say anything of a path leave it out."""
        whole = os.path.abspath(path)
        where = os.path.dirname(whole)
        while where.startswith(self._root):
            spec = self._specs.get(where)
            if spec is not None:
                name = os.path.relpath(whole, where).replace(os.sep, "/") + ("/" if folder else "")
                said = spec.check_file(name).include
                if said is not None:
                    return bool(said)
            if where == self._root:
                break
            where = os.path.dirname(where)
        return False


def _complain(paths: Sequence[Path], found: Sequence[Found], include: Sequence[str]) -> None:
    if not found:
        what = f"no file matches {' or '.join(include)}" if include else "there is no manifest and no robot description"
        raise InputError([
            Problem(f"{what} here or below", str(path), None, _REMEDY)
            for path in paths
        ])  # fmt: skip
    by_results: dict[str, Found] = {}
    problems = []
    for one in found:
        first = by_results.setdefault(one.results.casefold(), one)
        if first is not one:
            message = f"its results and those of {first.source} would be the same file, {one.results}"
            problems.append(Problem(message, str(one.source), None, "rename one of them, or leave one out: --exclude"))
    if problems:
        raise InputError(problems)

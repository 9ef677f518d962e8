"""Which files below some paths are designs: manifests and robot descriptions, told from their content.

What `.gitignore` names is left out where git says which files it tracks: these always count, in folders whose name
begins with a dot too. Without git, or outside of a repository, no `.gitignore` counts. A file that is named itself is
taken as it is. Descriptions that only others include (xacro without a name, MJCF without `<mujoco>`) are no designs by
themselves. What looks like a design and cannot be read is one; what cannot be looked into is reported.
"""

from __future__ import annotations

import fnmatch
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import field, replace
from pathlib import Path

from kinform.errors import InputError, Problem
from kinform.form.recognition import DESCRIPTIONS, is_design
from kinform.form.sources import states_units
from kinform.foundation.git import GitError, git, names, root_of
from kinform.foundation.regular_files import not_a_file
from kinform.frozen import dataclass

RECORD = "batch.json"
"""Name of the record in the folder of results, which no results may have."""


@dataclass(frozen=True)
class Found:
    """A design, and where its results go."""

    source: Path
    """As messages show it."""
    name: str
    """Relative to the folder that all paths have in common; with "/"."""
    fault: Problem | None = field(default=None)
    """Why it cannot be run; None of others."""

    @property
    def results(self) -> str:
        """Path of the results below the folder of results: a/arm.toml gives a/arm.h5, a/arm.urdf gives
        a/arm.urdf.h5, so that no file decides where another's results are."""
        return (self.name.removesuffix(".toml") if self.name.endswith(".toml") else self.name) + ".h5"


_REMEDY = "name a folder of designs, or choose with --include; what .gitignore leaves out is found with --ignored"


def discover(
    paths: Sequence[Path], *, include: Sequence[str] = (), exclude: Sequence[str] = (), ignored: bool = False,
    results: Path | None = None, say: Callable[[str], None] | None = None,
) -> tuple[Found, ...]:  # fmt: skip
    """The designs at and below these paths, sorted by name.

    `include` are patterns of names or paths (`*.step`, `arms/*.toml`), whatever their case: only such files, and these
    whatever they hold, if kinform reads their format. `exclude` are left out. `ignored`: also what git ignores. Nothing
    below the folder of `results` is a design. `say` is called for each file or folder that was passed
    over. Two designs whose results would be one file have a fault. Raises InputError for a path that is not there, and
    for no design at all.
    """
    missing = [Problem("there is no such file or folder", str(p)) for p in paths if not os.path.exists(p)]
    if missing:
        raise InputError(missing)
    tell = say or (lambda text: None)
    base = _common(paths)
    out: dict[Path, Found] = {}
    for path in paths:
        below = _Below(path, ignored, results, tell)
        files = below.files() if path.is_dir() else [path]
        for file in files:
            name = _posix(os.path.relpath(os.path.abspath(file), base))
            named = file == path
            if not named and include and not any(_matches(name.lower(), pattern.lower()) for pattern in include):
                continue
            if any(_matches(name, pattern) for pattern in exclude):
                continue
            if named or file in below.by_name or _chosen(file, bool(include), tell):
                out.setdefault(Path(os.path.abspath(file)), Found(file, name))
    found = tuple(sorted(out.values(), key=lambda one: one.name))
    if not found:
        what = f"no file matches {' or '.join(include)}" if include else "there is no manifest and no robot description"
        raise InputError([Problem(f"{what} here or below", str(path), None, _REMEDY) for path in paths])
    return _with_faults(found)


def _chosen(file: Path, whatever: bool, tell: Callable[[str], None]) -> bool:
    fault = not_a_file(file)
    if fault is not None:
        tell(f"passed over: {file} {fault}")
        return False
    return _readable(file) if whatever else is_design(file)


def _readable(path: Path) -> bool:
    return path.suffix.lower() == ".toml" or states_units(path)


def _matches(name: str, pattern: str) -> bool:
    """Whether a path matches: a pattern without "/" is one of file names."""
    return fnmatch.fnmatchcase(name if "/" in pattern else name.rpartition("/")[2], pattern)


def _common(paths: Sequence[Path]) -> str:
    """The deepest folder that is, or holds, all paths."""
    folders = [os.path.abspath(path if path.is_dir() else path.parent) for path in paths]
    return os.path.commonpath(folders)


def _posix(path: str) -> str:
    return path.replace(os.sep, "/")


class _Below:
    """The files below a folder that may be designs."""

    def __init__(self, top: Path, ignored: bool, results: Path | None, tell: Callable[[str], None]):
        self.top, self.ignored, self.tell = top, ignored, tell
        self.apart = None if results is None else os.path.realpath(results)
        self.real = os.path.realpath(top)
        self.by_name: set[Path] = set()
        """Descriptions that are links out of the folder, or its repository: they are not opened to look into them."""
        self.left_out: set[str] = set()
        """Real paths of files and folders that git ignores, and does not track."""

    def files(self) -> Iterator[Path]:
        """All of them, each once: what git tracks, and what lies there and is not ignored. Folders whose name begins
        with a dot, and those of results, hold only what is tracked, or nothing."""
        inside_one = root_of(self.real) is not None
        tracked = self._asked(self.real) if inside_one else set()
        unused = not inside_one and not self.ignored
        for folder, folders, inside in os.walk(self.real, onerror=self._unreadable):
            if unused and ".gitignore" in inside and root_of(folder) is None:
                self.tell(f"{self.top} is in no repository of git, so that no .gitignore is used")
                unused = False
            entered = []
            for name in sorted(folders):
                path = os.path.join(folder, name)
                if name.startswith(".") or path == self.apart or path in self.left_out:
                    continue
                if os.path.islink(path):
                    self._note_link(path)
                    continue
                if os.path.lexists(os.path.join(path, ".git")):
                    tracked |= self._asked(path)
                entered.append(name)
            folders[:] = entered
            for name in inside:
                path = os.path.join(folder, name)
                if path not in self.left_out and _may_be(path):
                    tracked.add(path)
        for path in sorted(tracked):
            shown = self._shown(path)
            if self._of_results(path):
                continue
            if self._leads_out(path):
                if shown.suffix.lower() in (".toml", ".xml"):  # of whatever program
                    self.tell(f"passed over: {shown} is a link that leads out of here")
                    continue
                self.by_name.add(shown)
            yield shown

    def _asked(self, folder: str) -> set[str]:
        """What git tracks below a folder of a repository; what it ignores there is left out from now on."""
        root = root_of(folder)
        assert root is not None
        at = os.path.relpath(folder, root)
        listing = ("ls-files", "-z", "--full-name")
        ignored = ("--others", "--ignored", "--exclude-standard", "--directory")
        try:
            tracked = names(git(root, *listing, "--cached", "--", at))
            if not self.ignored:
                for name in names(git(root, *listing, *ignored, "--", at)):
                    self.left_out.add(os.path.join(root, name.rstrip("/")))
        except GitError as error:
            self.tell(f"{root}: {error.reason}, so that files that .gitignore names are included")
            return set()
        paths = [os.path.join(root, name) for name in tracked]
        files = {path for path in paths if _may_be(path) and os.path.lexists(path) and not os.path.isdir(path)}
        for path in paths:  # a submodule is tracked as one name; folders with a dot are not walked
            if os.path.lexists(os.path.join(path, ".git")) and not os.path.islink(path) and path != folder:
                files |= self._asked(path)
        return files

    def _of_results(self, path: str) -> bool:
        """Whether a file lies in the folder of results; one that git tracks there is reported."""
        apart = self.apart
        if apart is None or apart == self.real or not path.startswith(os.path.join(apart, "")):
            return False
        if is_design(Path(path)):
            self.tell(f"passed over: {self._shown(path)} lies in the folder of results")
        return True

    def _leads_out(self, path: str) -> bool:
        """Whether a file is a link that leads out of the folder and the repository that it is in."""
        target = os.path.realpath(path)
        bound = root_of(self.real) or self.real
        return target != path and not target.startswith(os.path.join(bound, ""))

    def _note_link(self, path: str) -> None:
        """Links to folders are not followed: what is in one that lies elsewhere is not looked for."""
        target = os.path.realpath(path)
        if not os.path.join(target, "").startswith(os.path.join(self.real, "")):
            self.tell(
                f"passed over: {self._shown(path)} is a link to a folder elsewhere; name that folder to include it"
            )

    def _unreadable(self, error: OSError) -> None:
        self.tell(f"passed over: {self._shown(str(error.filename))} cannot be read: {error.strerror}")

    def _shown(self, path: str) -> Path:
        return self.top / os.path.relpath(path, self.real)


def _may_be(path: str) -> bool:
    """Whether the suffix is that of a file that can be a design."""
    named = Path(path)
    return named.suffix.lower() in (".toml", *DESCRIPTIONS) or states_units(named)


def _with_faults(found: Sequence[Found]) -> tuple[Found, ...]:
    """The designs, with a fault where the results of one cannot be written: their place is that of another's."""
    by_results: dict[str, Found] = {}
    out = []
    for one in found:
        first = by_results.setdefault(one.results.casefold(), one)
        remedy = "rename one of them, or leave one out: --exclude"
        fault = None
        if first is not one:
            message = f"its results and those of {first.source} would be the same file, {one.results}"
            fault = Problem(message, str(one.source), None, remedy)
        elif one.results.casefold().split("/")[0] == RECORD:
            message = f"its results would be in place of {RECORD}, the record of the batch"
            fault = Problem(message, str(one.source), None, "rename its folder")
        out.append(one if fault is None else replace(one, fault=fault))
    return tuple(out)

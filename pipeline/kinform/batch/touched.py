"""Which designs differ from how they were at a commit: those of whose files one does.

Which files these are is what the readers open: each design whose own file is as it was is read here, in a process of a
desk. One that cannot be read counts. What an opened file holds is compared with what the commit has in its place. Where
files are looked for by name, a file that is gone counts for designs that open another of the same name, and a change of
a package (`package.xml`, `model.config`) or of a link for all. So a design may be run for nothing, and none is left
out. The revision is one of the repository in which the command runs, else of the outermost that tracks the design: a
submodule is compared with the commit that the outer one names, whatever its own branches are called, for whoever
changes the outer one chooses the submodule. Files outside of any repository have no revision: they do not count; files
in one that it did not have then do.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

from kinform.batch.desks import close_all, perform
from kinform.batch.discovery import Found
from kinform.batch.session import Settings
from kinform.batch.task import Task
from kinform.errors import InputError, Problem
from kinform.form.constants import TEXT_BYTES
from kinform.form.files import is_mesh
from kinform.foundation.git import GitError, git, root_of
from kinform.foundation.regular_files import not_a_file

_PACKAGES = ("package.xml", "model.config")
"""Files that say where packages and models are."""
_LINK, _MODULE = b"120000", b"160000"
_POINTER = b"version https://git-lfs"
_POINTER_BYTES = 1024
"""Bytes that a pointer of Git LFS has at most, by its specification."""


def changed_since(found: Sequence[Found], revision: str, settings: Settings | None = None) -> tuple[Found, ...]:
    """Those of the designs that differ from how they were at the revision of git, in whatever they are made of.

    Raises InputError where there is no repository, or no such revision.
    """
    asked = settings or Settings()
    before = _Before(revision)
    own = [before.of_source(one.source) for one in found]
    surely = [
        one.fault is not None or then.everything or not before.same(os.path.abspath(one.source), then)
        for one, then in zip(found, own, strict=True)
    ]

    def touched(k: int) -> bool:
        return surely[k] or _differs(found[k], own[k], before, asked)

    try:
        with ThreadPoolExecutor(max(asked.jobs, 1)) as pool:
            differing = list(pool.map(touched, range(len(found))))
    finally:
        close_all()
    return tuple(one for one, differs in zip(found, differing, strict=True) if differs)


def _differs(one: Found, then: _Then, before: _Before, settings: Settings) -> bool:
    """Whether a file that the readers open for a design is not what it was; true where they cannot read it."""
    given = {
        "source": str(one.source.absolute()),
        "allow_outside": settings.allow_outside,
        "allow_xacro": settings.allow_xacro,
    }
    answer = perform(Task(one.name, "kinform.batch.work:files_of", given, settings.limits))
    if answer.failure is not None or not answer.result:
        return True
    top = os.path.dirname(os.path.abspath(one.source))
    paths = [os.path.normpath(os.path.join(top, name)) for name in answer.result if not name.endswith("/")]
    folders = [os.path.normpath(os.path.join(top, name)) for name in answer.result if name.endswith("/")]
    if any(os.path.basename(path).casefold() in then.gone for path in paths):
        return True
    return not all(before.same(path, then) for path in paths) or not all(before.lists(at, then) for at in folders)


class _Then:
    """A repository at a commit, beside what it is now."""

    def __init__(self, root: Path, commit: str):
        """Raises GitError where there is no such commit."""
        self.root = root
        self.entries: dict[str, tuple[bytes, str]] = {}
        """Mode and object by path."""
        for line in git(root, "ls-tree", "-r", "-z", "--full-tree", commit).split(b"\0"):
            if line:
                about, _, name = line.partition(b"\t")
                mode, _, object = about.split(b" ")
                self.entries[os.fsdecode(name)] = mode, object.decode()

    def place(self, name: str) -> str:
        """The absolute path of a file of the repository."""
        return os.path.join(self.root, name)

    @cached_property
    def modules(self) -> dict[str, _Then | None]:
        """The submodules that are there, by path, at the commits that this one names; None where one is unknown."""
        out: dict[str, _Then | None] = {}
        for name, (mode, object) in self.entries.items():
            path = Path(self.place(name))
            if mode == _MODULE and os.path.lexists(path / ".git"):
                try:
                    out[name] = _Then(path, object)
                except GitError:
                    out[name] = None
        return out

    @cached_property
    def gone(self) -> frozenset[str]:
        """Names, without case, of the files that are no longer there, those of submodules too."""
        own = {os.path.basename(name).casefold() for name in self.entries if not os.path.lexists(self.place(name))}
        return frozenset(own).union(*(inner.gone for inner in self.modules.values() if inner is not None))

    @cached_property
    def everything(self) -> bool:
        """Whether something differs on which all paths may depend: a link, a package, or a submodule that is gone or
        whose commit of then is unknown."""
        if any(inner is None or inner.everything for inner in self.modules.values()):
            return True
        for name, (mode, object) in self.entries.items():
            if mode == _LINK:
                try:
                    differs = _object(os.fsencode(os.readlink(self.place(name))), object) != object
                except OSError:
                    differs = True
                if differs:
                    return True
            elif mode == _MODULE:
                if not os.path.isdir(self.place(name)):
                    return True
            elif os.path.basename(name) in _PACKAGES and not self.holds(name):
                return True
        try:
            now = self._now()
        except GitError:
            return True
        return any(
            (mode == _LINK or os.path.basename(name) in _PACKAGES) and name not in self.entries for name, mode in now
        )

    def _now(self) -> list[tuple[str, bytes]]:
        """Path and mode of what is tracked now."""
        lines = git(self.root, "ls-files", "-z", "--stage").split(b"\0")
        return [(os.fsdecode(line.partition(b"\t")[2]), line[:6]) for line in lines if line]

    def holds(self, name: str) -> bool:
        """Whether a file is what the commit has in its place: the same bytes, the same text with other ends of lines,
        or what its pointer of Git LFS stands for."""
        entry = self.entries.get(name)
        path = self.place(name)
        if entry is None or entry[0] in (_LINK, _MODULE) or not_a_file(path) is not None:
            return False
        object = entry[1]
        try:
            with open(path, "rb") as stream:
                begun = _begun(os.fstat(stream.fileno()).st_size, object)
                if hashlib.file_digest(stream, lambda: begun).hexdigest() == object:
                    return True
                stream.seek(0)
                text = stream.read(TEXT_BYTES + 1)
                if len(text) <= TEXT_BYTES and b"\0" not in text and b"\r\n" in text:
                    plain = text.replace(b"\r\n", b"\n")
                    if _object(plain, object) == object:
                        return True
                pointer = self._pointer(object)
                stream.seek(0)
                return bool(pointer) and hashlib.file_digest(stream, "sha256").hexdigest() == pointer
        except OSError:
            return False

    def _pointer(self, object: str) -> str:
        """SHA-256 (hex) of the file that a pointer of Git LFS stands for; "" where the object is none."""
        try:
            if int(git(self.root, "cat-file", "-s", object)) > _POINTER_BYTES:
                return ""
            text = git(self.root, "cat-file", "blob", object)
        except GitError:
            return ""
        digests = [line.partition(b"sha256:")[2] for line in text.splitlines() if line.startswith(b"oid sha256:")]
        return digests[0].decode("ascii", "replace") if text.startswith(_POINTER) and digests else ""


class _Before:
    """What files were at a revision, in whatever repository they are."""

    def __init__(self, revision: str):
        self.revision = revision
        self._here = root_of(os.curdir)
        self._known: dict[Path, _Then] = {}
        self._outer: dict[Path, Path | None] = {}

    def of_source(self, source: Path) -> _Then:
        """The repository whose revision a design is compared with, then. Raises InputError where there is none, or no
        such revision."""
        root = root_of(os.path.dirname(os.path.abspath(source)))
        if root is None:
            raise InputError([Problem("is in no repository of git", str(source), None, "leave --changed-since out")])
        while root != self._here and (outer := self._outer_of(root)) is not None:
            root = outer
        if root not in self._known:
            commit = self._commit(root)
            try:
                self._known[root] = _Then(root, commit)
            except GitError as error:
                raise InputError([Problem(f"--changed-since: {error.reason}", str(root))]) from None
        return self._known[root]

    def _outer_of(self, root: Path) -> Path | None:
        """The repository around another that tracks it as a submodule, or files in its folder."""
        if root not in self._outer:
            outer = root_of(root.parent)
            try:
                tracked = b"" if outer is None else git(outer, "ls-files", "-z", "--", os.path.relpath(root, outer))
            except GitError:
                tracked = b""
            self._outer[root] = outer if tracked else None
        return self._outer[root]

    def _commit(self, root: Path) -> str:
        try:
            asked = ("rev-parse", "--verify", "--quiet", "--end-of-options", f"{self.revision}^{{commit}}")
            return git(root, *asked).decode("ascii", "replace").strip()
        except GitError as error:
            if "installed" in error.reason:
                problem = Problem(f"--changed-since asks git: {error.reason}", None, None, "install git")
                raise InputError([problem]) from None
        remedy = "correct its name; or fetch it, where the clone is shallow: git fetch --unshallow"
        raise InputError([Problem(f"there is no revision {self.revision}", str(root), None, remedy)])

    def same(self, path: str, then: _Then) -> bool:
        """Whether a file is what it was, seen from the repository of a design."""
        here = os.sep
        for part in path.split(os.sep)[1:]:
            here = os.path.join(here, part)
            if os.path.islink(here):
                if self._is_new(here, then):
                    return False
                here = os.path.realpath(here)
        at = self._in(os.path.dirname(here), then)
        return at is True or (at is not None and at.holds(os.path.relpath(here, at.root)))

    def lists(self, folder: str, then: _Then) -> bool:
        """Whether a folder has meshes of the same names as it had."""
        here = os.path.realpath(folder)
        at = self._in(here, then)
        if at is True or at is None:
            return at is True
        below = os.path.relpath(here, at.root)
        names = (name for name in at.entries if (os.path.dirname(name) or ".") == below)
        try:
            now = {name for name in os.listdir(here) if is_mesh(Path(name))}
        except OSError:
            return False
        return now == {os.path.basename(name) for name in names if is_mesh(Path(name))}

    def _is_new(self, link: str, then: _Then) -> bool:
        """Whether a link in a repository was not there then."""
        at = self._in(os.path.dirname(link), then)
        return at is None or (at is not True and at.entries.get(os.path.relpath(link, at.root), (b"", ""))[0] != _LINK)

    def _in(self, folder: str, then: _Then) -> _Then | Literal[True] | None:
        """The repository of a real folder, then; True outside of all, None where it is not known what was there."""
        root = root_of(folder)
        if root is None:
            return True
        if root == then.root:
            return then
        if root.is_relative_to(then.root):
            outer = self._in(str(root.parent), then)
            return None if not isinstance(outer, _Then) else outer.modules.get(os.path.relpath(root, outer.root))
        try:
            return self.of_source(root / ".git")
        except InputError:
            return None


def _begun(size: int, object: str) -> Any:
    """A hash as git makes it of a blob of so many bytes, before the bytes; of the kind of another object's name."""
    begun = hashlib.sha1(usedforsecurity=False) if len(object) == 40 else hashlib.sha256()
    begun.update(b"blob %d\0" % size)
    return begun


def _object(data: bytes, object: str) -> str:
    """The name that git gives a blob, of the kind of another object's name."""
    begun = _begun(len(data), object)
    begun.update(data)
    return str(begun.hexdigest())

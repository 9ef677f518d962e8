"""The results file as a whole: which group holds what, and what makes a file one of ours.

Groups, attributes and units are those of the results contract. The bytes depend on the design and on the
versions of kinform and HDF5 alone: groups are written in one order, nothing is compressed, no times are
kept, byte order and file format are pinned.
"""

from __future__ import annotations

import contextlib
import dataclasses
import importlib
import json
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py

from kinform.design import Design
from kinform.errors import ResultsError
from kinform.model.fingerprints import Fingerprints
from kinform.results import store as _store
from kinform.results import table as _table
from kinform.results.groups import assembly as _assembly
from kinform.results.groups import findings as _findings
from kinform.reuse import lineage
from kinform.version import __version__

if TYPE_CHECKING:
    from kinform.behaviour import Behaviour
    from kinform.model.assembly import Assembly
    from kinform.model.contacts import Contacts
    from kinform.model.findings import CheckReport
    from kinform.model.kinematics import Kinematics
    from kinform.model.mass import MassReport
    from kinform.model.simulation import Simulation
    from kinform.model.surfaces import MeshSurfaces

__all__ = ["SCHEMA", "Earlier", "check_output", "files_of", "read", "read_if_current", "to_bytes", "write"]

SCHEMA = "kinform/results/2"
_FAMILY = "kinform/results/"
_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_DAMAGE = (
    ArithmeticError, AttributeError, LookupError, MemoryError, OSError, RuntimeError, TypeError, ValueError,
)  # fmt: skip
"""What h5py and the codecs raise on a file whose content makes no sense."""
_NONSENSE = (
    ArithmeticError, AttributeError, LookupError, OSError, RuntimeError, TypeError, ValueError,
)  # fmt: skip
"""The same without want of memory."""
_COMPUTE = "compute it from the manifest: kinform run MANIFEST -o FILE"
_RECOMPUTE = f"delete it, and {_COMPUTE}"
_NAME_ONE = "name a results file of kinform"
_GROWTH = 1 << 20
"""Bytes by which the image of a file grows: with fewer it is copied often."""
_STAGE_OF = {"constraints": "joints", "mobility": "joints", "behaviour": "simulation"}


def write(design: Design, path: str | Path) -> None:
    """Write the design to `path`, whole or not at all; see the contract of the results file.

    Identical bytes keep the file and touch its time. Raises ResultsError when `path` cannot be written,
    or holds something that is not a results file of this schema: that is never overwritten.
    """
    check_output(path)
    _store.replace(path, to_bytes(design))


def check_output(path: str | Path) -> None:
    """Raise ResultsError when `write` would refuse this path."""
    _store.check_target(path)
    target = Path(path)
    if target.exists() and target.stat().st_size > 0:
        try:
            with _opened(target):
                pass
        except ResultsError as error:
            message = str(error).split("\n")[0].removeprefix(f"{target}: ")
            raise _store.refuse(
                path, f"{message}; it is not overwritten", "delete it, or give another name with -o"
            ) from error


def read(path: str | Path) -> Design:
    """The design in the results file at `path`; its arrays are read-only.

    Raises ResultsError when there is no file, or it is not HDF5, of another program, of another schema,
    or damaged.
    """
    with Earlier(path) as found:
        return found.design


class Earlier:
    """The design in a results file, each part of it read when it is first asked for: most of what an earlier run left
    is of no use to one whose input changed. Fields as of Design; raises ResultsError as `read` does, also later.
    """

    def __init__(self, path: str | Path):
        self._path = path
        self._open = contextlib.ExitStack()
        self._file = self._open.enter_context(_opened(path))

    def __enter__(self) -> Earlier:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the file; what was not asked for can no longer be read."""
        self._open.close()

    def _read(self, codec: str, *groups: str) -> tuple[Any, ...]:
        """What a codec reads of some groups, one after the other; empty where the first is not there."""
        try:
            if groups[0] not in self._file:
                return ()
            codecs = [importlib.import_module(f"kinform.results.groups.{name}") for name in codec.split()]
            return tuple(one.read(self._file[group]) for one, group in zip(codecs, groups, strict=True))
        except _NONSENSE as error:
            raise self._damaged(error) from error

    def _damaged(self, error: BaseException) -> ResultsError:
        return _store.refuse(self._path, f"the results file is damaged ({error})", _RECOMPUTE)

    @cached_property
    def assembly(self) -> Assembly:
        """As written; KeyError is damage, for every results file has one."""
        try:
            return _assembly.read(self._file["assembly"])
        except _NONSENSE as error:
            raise self._damaged(error) from error

    @cached_property
    def _surfaces(self) -> tuple[Any, ...]:
        return self._read("surfaces", "surfaces")

    @cached_property
    def surfaces(self) -> dict[str, MeshSurfaces]:
        """By mesh digest."""
        return self._surfaces[0][0] if self._surfaces else {}

    @cached_property
    def _contacts(self) -> tuple[Any, ...]:
        return self._read("contacts", "contacts")

    @cached_property
    def contacts(self) -> Contacts | None:
        """As of Design; so are those below."""
        return self._contacts[0][0] if self._contacts else None

    @cached_property
    def kinematics(self) -> Kinematics | None:
        from kinform.model.kinematics import Kinematics

        found = self._read("joints constraints mobility", "joints", "constraints", "mobility")
        return Kinematics(**found[0], matrix=found[1], mobility=found[2]) if found else None

    @cached_property
    def mass(self) -> MassReport | None:
        return next(iter(self._read("mass", "mass")), None)

    @cached_property
    def behaviour(self) -> Behaviour | None:
        return next(iter(self._read("behaviour", "behaviour")), None)

    @cached_property
    def simulation(self) -> Simulation | None:
        return next(iter(self._read("simulation", "simulation")), None)

    @cached_property
    def report(self) -> CheckReport | None:
        return next(iter(self._read("findings", "findings")), None)

    @cached_property
    def fingerprints(self) -> Fingerprints:
        try:
            return Fingerprints(
                stages=_read_marks(self._file),
                meshes=self._surfaces[0][1] if self._surfaces else {},
                pairs=self._contacts[0][1] if self._contacts else {},
                files=_read_contents(self._file),
                lineage=_read_lineage(self._file),
                inputs=_read_inputs(self._file),
                decisions=_read_decisions(self._file),
            )
        except _NONSENSE as error:
            raise self._damaged(error) from error

    @property
    def design(self) -> Design:
        """All of it."""
        return Design(**{field.name: getattr(self, field.name) for field in dataclasses.fields(Design)})


def to_bytes(design: Design) -> bytes:
    """The results file as bytes: the same design gives the same bytes, everywhere."""
    file = h5py.File(
        "results", "w", driver="core", backing_store=False, block_size=_GROWTH, libver=("earliest", "v108"),
        track_order=False,
    )  # fmt: skip
    with file:
        file.attrs["schema"] = SCHEMA
        file.attrs["kinform"] = __version__
        _write_groups(file, design)
        file.flush()
        image: bytes = file.id.get_file_image()
    return image


def _group(file: h5py.File, name: str, marks: Fingerprints) -> h5py.Group:
    group = file.create_group(name)
    group.attrs["schema"] = f"{SCHEMA}/{name}"
    group.attrs["fingerprint"] = marks.stages.get(_STAGE_OF.get(name, name), "")
    if name in marks.lineage:
        group.attrs["lineage"] = marks.lineage[name]
    if name in marks.inputs:
        group.attrs["inputs"] = json.dumps(marks.inputs[name], sort_keys=True)
    return group


def _write_groups(file: h5py.File, design: Design) -> None:
    from kinform.results.groups import constraints as _constraints
    from kinform.results.groups import contacts as _contacts
    from kinform.results.groups import joints as _joints
    from kinform.results.groups import mass as _mass
    from kinform.results.groups import mobility as _mobility
    from kinform.results.groups import simulation as _simulation
    from kinform.results.groups import surfaces as _surfaces

    marks, contacts, kinematics = design.fingerprints, design.contacts, design.kinematics
    _assembly.write(_group(file, "assembly", marks), design.assembly)
    if marks.files:
        _table.write_texts(
            file["assembly"], "contents", [f"{hash} {name}" for name, hash in sorted(marks.files.items())]
        )
    if design.surfaces or contacts is not None:
        _surfaces.write(_group(file, "surfaces", marks), design.surfaces, marks.meshes)
    if contacts is not None:
        _contacts.write(_group(file, "contacts", marks), contacts, marks.pairs)
    if kinematics is not None:
        patches = () if contacts is None else contacts.patches
        _constraints.write(_group(file, "constraints", marks), kinematics.matrix, patches)
        _joints.write(_group(file, "joints", marks), kinematics)
        if marks.decisions:
            _joints.write_decisions(file["joints"], marks.decisions)
        _mobility.write(_group(file, "mobility", marks), kinematics.mobility)
    if design.mass is not None:
        _mass.write(_group(file, "mass", marks), design.mass)
    if design.behaviour is not None:
        from kinform.results.groups import behaviour as _behaviour

        _behaviour.write(_group(file, "behaviour", marks), design.behaviour)
    if design.simulation is not None:
        _simulation.write(_group(file, "simulation", marks), design.simulation)
    if design.report is not None:
        _findings.write(_group(file, "findings", marks), design.report)


def _read_marks(file: h5py.File) -> dict[str, str]:
    marks = {name: str(group.attrs["fingerprint"]) for name, group in file.items() if name not in _STAGE_OF}
    return {name: mark for name, mark in marks.items() if mark}


def _read_contents(file: h5py.File) -> dict[str, str]:
    lines = _table.read_texts(file["assembly"], "contents") if "contents" in file["assembly"] else ()
    return {name: hash for hash, name in (line.split(" ", 1) for line in lines)}


def _read_lineage(file: h5py.File) -> dict[str, str]:
    return {name: str(group.attrs["lineage"]) for name, group in file.items() if "lineage" in group.attrs}


def _read_inputs(file: h5py.File) -> dict[str, dict[str, str]]:
    return {name: json.loads(group.attrs["inputs"]) for name, group in file.items() if "inputs" in group.attrs}


def _read_decisions(file: h5py.File) -> dict[str, tuple[str, str]]:
    from kinform.results.groups import joints as _joints

    return _joints.read_decisions(file["joints"]) if "joints" in file else {}


def files_of(path: str | Path) -> tuple[str, ...]:
    """The files that were read for these results, relative to the manifest; () where there are no such results."""
    try:
        with _opened(path) as file:
            return _table.read_texts(file["assembly"], "files")
    except (ResultsError, *_DAMAGE):
        return ()


def read_if_current(path: str | Path, manifest: Path, *, allow_outside: bool) -> Design | None:
    """What findings are told with, of results that are what a run of the manifest would give; None of others.

    The assembly is without parts, the kinematics without joints. Raises nothing: whatever is wrong with the file or
    its inputs, a run will tell.
    """
    try:
        with _opened(path) as file:
            known = _read_lineage(file).get("findings")
            if not known or known != lineage.current(manifest, _read_contents(file), allow_outside=allow_outside):
                return None
            assembly = _assembly.read_header(file["assembly"])
            marks = Fingerprints(lineage=_read_lineage(file))
            return Design(
                assembly,
                kinematics=_bodies(file, assembly),
                report=_findings.read(file["findings"]),
                fingerprints=marks,
            )
    except (ResultsError, *_DAMAGE):
        return None


def _bodies(file: h5py.File, assembly: Assembly) -> Kinematics | None:
    """The bodies, where the ground is one that kinform chose and findings are told with a note about it."""
    if assembly.ground is not None:
        return None
    from kinform.results.groups import joints as _joints

    return _joints.read_bodies(file["joints"])


@contextlib.contextmanager
def _opened(path: str | Path) -> Iterator[h5py.File]:
    """The file, open for reading and known to be a results file of this schema."""
    with contextlib.ExitStack() as stack:
        try:
            stream = stack.enter_context(open(path, "rb"))
            signature = stream.read(len(_SIGNATURE))
        except FileNotFoundError as error:
            raise _store.refuse(path, "there is no such file", f"check the name, or {_COMPUTE}") from error
        except OSError as error:
            raise _store.refuse(path, f"cannot be read: {error.strerror or error}", _NAME_ONE) from error
        if signature != _SIGNATURE:
            raise _store.refuse(path, "this is not a results file of kinform (not HDF5)", _NAME_ONE)
        try:
            file = stack.enter_context(h5py.File(stream, "r"))
            schema, version = file.attrs.get("schema"), file.attrs.get("kinform", "unknown")
        except _DAMAGE as error:
            raise _store.refuse(path, "the results file is truncated or damaged", _RECOMPUTE) from error
        _check_schema(path, schema, version)
        yield file


def _check_schema(path: str | Path, schema: object, version: object) -> None:
    if schema == SCHEMA:
        return
    if isinstance(schema, str) and schema.startswith(_FAMILY):
        raise _store.refuse(
            path,
            f"the results file has the schema {schema}, written by kinform {version}; "
            f"this is kinform {__version__}, which reads {SCHEMA}",
            f"use that version, or {_RECOMPUTE}",
        )
    raise _store.refuse(path, "this HDF5 file was written by another program", _NAME_ONE)

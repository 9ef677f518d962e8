"""The results file as a whole: which group holds what, and what makes a file one of ours.

Groups, attributes and units are those of the results contract. The bytes depend on the design and on the
versions of kinform and HDF5 alone: groups are written in one order, nothing is compressed, no times are
kept, byte order and file format are pinned.
"""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py

from kinform._version import __version__
from kinform.errors import ResultsError
from kinform.model.design import Design
from kinform.model.fingerprints import Fingerprints
from kinform.results import _assembly, _findings, _store, _table, lineage

if TYPE_CHECKING:
    from kinform.model.assembly import Assembly
    from kinform.model.kinematics import Kinematics

__all__ = ["SCHEMA", "check_output", "files_of", "read", "read_if_current", "to_bytes", "write"]

SCHEMA = "kinform/results/2"
_FAMILY = "kinform/results/"
_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_DAMAGE = (
    ArithmeticError, AttributeError, LookupError, MemoryError, OSError, RuntimeError, TypeError, ValueError,
)  # fmt: skip
"""What h5py and the codecs raise on a file whose content makes no sense."""
_COMPUTE = "compute it from the manifest: kinform run MANIFEST -o FILE"
_RECOMPUTE = f"delete it, and {_COMPUTE}"
_NAME_ONE = "name a results file of kinform"
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
    with _opened(path) as file:
        try:
            return _read_groups(file)
        except (
            ArithmeticError,
            AttributeError,
            LookupError,
            OSError,
            RuntimeError,
            TypeError,
            ValueError,
        ) as error:
            raise _store.refuse(path, f"the results file is damaged ({error})", _RECOMPUTE) from error


def to_bytes(design: Design) -> bytes:
    """The results file as bytes: the same design gives the same bytes, everywhere."""
    file = h5py.File("results", "w", driver="core", backing_store=False, libver=("earliest", "v108"), track_order=False)
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
    return group


def _write_groups(file: h5py.File, design: Design) -> None:
    from kinform.results import _constraints, _contacts, _joints, _mass, _mobility, _simulation, _surfaces

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
        _mobility.write(_group(file, "mobility", marks), kinematics.mobility)
    if design.mass is not None:
        _mass.write(_group(file, "mass", marks), design.mass)
    if design.behaviour is not None:
        from kinform.results import _behaviour

        _behaviour.write(_group(file, "behaviour", marks), design.behaviour)
    if design.simulation is not None:
        _simulation.write(_group(file, "simulation", marks), design.simulation)
    if design.report is not None:
        _findings.write(_group(file, "findings", marks), design.report)


def _read_groups(file: h5py.File) -> Design:
    from kinform.model.kinematics import Kinematics
    from kinform.results import _constraints, _contacts, _joints, _mass, _mobility, _simulation, _surfaces

    parts: dict[str, Any] = {"assembly": _assembly.read(file["assembly"])}
    marks = Fingerprints(stages=_read_marks(file), files=_read_contents(file), lineage=_read_lineage(file))
    if "surfaces" in file:
        parts["surfaces"], meshes = _surfaces.read(file["surfaces"])
        marks = dataclasses.replace(marks, meshes=meshes)
    if "contacts" in file:
        parts["contacts"], pairs = _contacts.read(file["contacts"])
        marks = dataclasses.replace(marks, pairs=pairs)
    if "joints" in file:
        parts["kinematics"] = Kinematics(
            **_joints.read(file["joints"]),
            matrix=_constraints.read(file["constraints"]),
            mobility=_mobility.read(file["mobility"]),
        )
    if "mass" in file:
        parts["mass"] = _mass.read(file["mass"])
    if "behaviour" in file:
        from kinform.results import _behaviour

        parts["behaviour"] = _behaviour.read(file["behaviour"])
    if "simulation" in file:
        parts["simulation"] = _simulation.read(file["simulation"])
    if "findings" in file:
        parts["report"] = _findings.read(file["findings"])
    return Design(**parts, fingerprints=marks)


def _read_marks(file: h5py.File) -> dict[str, str]:
    marks = {name: str(group.attrs["fingerprint"]) for name, group in file.items() if name not in _STAGE_OF}
    return {name: mark for name, mark in marks.items() if mark}


def _read_contents(file: h5py.File) -> dict[str, str]:
    lines = _table.read_texts(file["assembly"], "contents") if "contents" in file["assembly"] else ()
    return {name: hash for hash, name in (line.split(" ", 1) for line in lines)}


def _read_lineage(file: h5py.File) -> dict[str, str]:
    return {name: str(group.attrs["lineage"]) for name, group in file.items() if "lineage" in group.attrs}


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
    from kinform.results import _joints

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

"""Opening a results file: it is read only after it has proven that it is whole (`seal`), of this schema, and made of
what results are made of (`structure`). HDF5 sees no byte of any other file."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from io import BufferedReader
from pathlib import Path

import h5py

from kinform.errors import ResultsError
from kinform.foundation import provenance
from kinform.foundation.regular_files import not_a_file
from kinform.results.held import HeldFile, hold
from kinform.results.replacement import refuse
from kinform.results.seal import BLOCK, Seal, is_sealed, read_seal
from kinform.results.structure import ForeignError, check_structure
from kinform.version import __version__

SCHEMA = "kinform/results/3"
DAMAGE = (
    ArithmeticError, AttributeError, LookupError, MemoryError, OSError, RuntimeError, TypeError, ValueError,
)  # fmt: skip
"""What h5py and the codecs raise on a file whose content makes no sense."""
_HDF5 = b"\x89HDF\r\n\x1a\n"
_COMPUTE = "compute it from the manifest: kinform run MANIFEST -o FILE"
RECOMPUTE = f"delete it, and {_COMPUTE}"
_NAME_ONE = "name a results file of kinform"


class NotWholeError(ResultsError):
    """The file was written as a results file of this schema, and is not what was written, or makes no sense."""


@contextlib.contextmanager
def opened(path: str | Path) -> Iterator[HeldFile]:
    """What the file holds, open for reading and known to be a whole results file of this schema. Raises NotWholeError,
    and ResultsError for what was never one."""
    with contextlib.ExitStack() as stack:
        stream = stack.enter_context(_stream(path))
        seal = _sealed(path, stream)
        _check_seal(path, seal)
        size = os.fstat(stream.fileno()).st_size
        try:
            file = stack.enter_context(h5py.File(stream, "r"))
            check_structure(file, stream, size)
            schema = file.attrs.get("schema")
        except ForeignError as error:
            raise not_whole(path, f"kinform did not write this results file: it holds {error}") from error
        except DAMAGE as error:
            raise not_whole(path, "the results file is damaged: its HDF5 makes no sense") from error
        if schema != SCHEMA:
            raise not_whole(path, "the results file is damaged: it has two schemas")
        yield hold(file, recorded=provenance.is_recorded(seal.digest, path))


def check_replaceable(path: Path) -> None:
    """Raise ResultsError where a file is there that kinform did not write, or in another schema."""
    with _stream(path) as stream:
        start = stream.read(BLOCK)
        if not is_sealed(start):
            raise _stranger(path, stream)
        if f"schema {SCHEMA}\n".encode() in start:
            return
        with contextlib.suppress(NotWholeError):
            _check_seal(path, _sealed(path, stream))


def _stream(path: str | Path) -> BufferedReader:
    """The file open for reading, if it is one: opening a pipe would wait for who writes into it."""
    try:
        fault = not_a_file(path)
        if fault is not None:
            raise refuse(path, fault, _NAME_ONE)
        return open(path, "rb")
    except FileNotFoundError as error:
        raise refuse(path, "there is no such file", f"check the name, or {_COMPUTE}") from error
    except OSError as error:
        raise refuse(path, f"cannot be read: {error.strerror or error}", _NAME_ONE) from error


def _sealed(path: str | Path, stream: BufferedReader) -> Seal:
    try:
        seal = read_seal(stream)
    except OSError as error:
        raise refuse(path, f"cannot be read: {error.strerror or error}", _NAME_ONE) from error
    if seal is None:
        raise _stranger(path, stream)
    return seal


def _stranger(path: str | Path, stream: BufferedReader) -> ResultsError:
    """The error about a file that does not begin as results do."""
    stream.seek(0)
    if stream.read(len(_HDF5)) == _HDF5:
        return refuse(
            path,
            "this HDF5 file has no digest before it: another program wrote it, or kinform before results had one",
            f"{_NAME_ONE}, or {RECOMPUTE}",
        )
    return refuse(path, "this is not a results file of kinform", _NAME_ONE)


def _check_seal(path: str | Path, seal: Seal) -> None:
    if seal.fault is not None:
        raise not_whole(path, f"the results file is not whole: {seal.fault}")
    if seal.schema != SCHEMA:
        raise refuse(
            path,
            f"the results file has the schema {seal.schema}; this is kinform {__version__}, which reads {SCHEMA}",
            f"use the version that wrote it, or {RECOMPUTE}",
        )


def not_whole(path: str | Path, message: str) -> NotWholeError:
    """The error about a file that was written as results, and can only be made again."""
    return NotWholeError(refuse(path, message, RECOMPUTE).problem)

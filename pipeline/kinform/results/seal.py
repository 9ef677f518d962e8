"""What proves that a results file is whole: a block of 512 bytes before its HDF5, with the SHA-256 of all that follows.

HDF5 lets a file begin with a block of its user (h5py's `userblock_size`), which every program that reads HDF5 skips. So
a file is known to be whole before HDF5 sees a byte of it, also without kinform: `tail -c +513 F.h5 | sha256sum`. The
block says nothing but schema, length and digest, and is compared as a whole: no bit of the file is outside of what is
proven. It proves that the file is as it was written, not who wrote it.

SHA-256, because processors have instructions for it: 0.07 s for 100 MB on one that has, where BLAKE2b takes 0.14 s.
"""

from __future__ import annotations

import hashlib
import os
import re
from io import BufferedReader

from kinform.frozen import dataclass

BLOCK = 512
"""Bytes before the HDF5: the least that HDF5 allows, and more than the digest needs."""


_MARK = b"kinform results\n"
_FAMILY = b"\nschema kinform/results/"
_FORM = re.compile(
    rb"kinform results\nschema (kinform/results/[0-9]{1,9})\nbytes ([0-9]{1,18})\nsha256 ([0-9a-f]{64})\n"
)
_ADVICE = "All after these 512 bytes is HDF5, and its digest is: tail -c +513 FILE | sha256sum\n"


@dataclass(frozen=True)
class Seal:
    """What the block of a file says of it, and whether that is so."""

    schema: str
    """"" where the block itself is not whole."""
    fault: str | None
    """What shows that the file is not as it was written; None where it is whole."""
    digest: str = ""
    """SHA-256 (hex) of the HDF5 of a file that is whole."""


def block(schema: str, length: int, digest: str) -> bytes:
    """The block before `length` bytes of HDF5 with this SHA-256 (hex)."""
    text = f"{_MARK.decode()}schema {schema}\nbytes {length}\nsha256 {digest}\n{_ADVICE}"
    return text.ljust(BLOCK - 1).encode() + b"\n"


def seal(image: bytes, schema: str) -> bytes:
    """The bytes of a results file: the block, then the HDF5, which was made to stand behind it."""
    return b"".join((block_of(image, schema), image))


def block_of(image: bytes, schema: str) -> bytes:
    """The block before this HDF5."""
    return block(schema, len(image), hashlib.sha256(image).hexdigest())


def digest_in(start: bytes) -> str:
    """The digest that the block at the start of a file states; "" where there is none."""
    stated = _FORM.match(start)
    return "" if stated is None else stated[3].decode()


def is_sealed(start: bytes) -> bool:
    """Whether a file that starts with these bytes was written as a results file, whole or not."""
    return start.startswith(_MARK) or _FAMILY in start


def read_seal(stream: BufferedReader) -> Seal | None:
    """What the block of an open file says, after all of the file was read and compared with it; the stream is then at
    its start again. None where it does not start as a results file does. Raises OSError as reading does."""
    stream.seek(0)
    start = stream.read(BLOCK)
    if not is_sealed(start):
        stream.seek(0)
        return None
    seal = _compare(stream, start)
    stream.seek(0)
    return seal


def _compare(stream: BufferedReader, start: bytes) -> Seal:
    stated = _FORM.match(start)
    if stated is None:
        return Seal("", "its first 512 bytes are not as they were written")
    schema, length, digest = stated[1].decode(), int(stated[2]), stated[3].decode()
    present = os.fstat(stream.fileno()).st_size - len(start)
    if len(start) < BLOCK or present < length:
        return Seal(schema, f"{length - max(present, 0)} of its {length + BLOCK} bytes are missing")
    if present > length:
        return Seal(schema, f"{present - length} bytes more than were written are in it")
    hasher = hashlib.file_digest(stream, "sha256")
    if start != block(schema, length, hasher.hexdigest()):
        return Seal(schema, f"its SHA-256 is not the {digest[:12]}… that it was written with")
    return Seal(schema, None, digest)

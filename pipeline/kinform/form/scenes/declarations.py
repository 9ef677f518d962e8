"""What XML may not declare: a document type or an entity, by which little text becomes much, or a file is read."""

from __future__ import annotations

import re

from kinform.form.meshes.raw import Fault, MeshError

_DECLARED = re.compile(
    b"<\0?!\0?" + b"\0?".join([b"(?:E", b"N", b"T", b"I", b"T", b"Y|D", b"O", b"C", b"T", b"Y", b"P", b"E)"])
)
"""In texts of one byte a character, and of two."""


def refuse_declarations(data: bytes) -> None:
    """Raise MeshError where a text declares one."""
    if _DECLARED.search(data):
        raise MeshError([Fault("declares a document type or an entity, which is refused", "remove the declaration")])

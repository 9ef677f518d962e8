"""Surfaces and contacts of small assemblies, computed once for all tests of a process that ask about the same parts."""

from __future__ import annotations

import hashlib

from kinform import contacts, surfaces
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.surfaces import MeshSurfaces
from kinform.reuse.digest import digest
from kinform.reuse.views import for_contacts

remember = True
"""Off in tests that change the code which finds surfaces or contacts."""
_known: dict[str, tuple[dict[str, MeshSurfaces], Contacts]] = {}


def touching(whole: Assembly) -> tuple[dict[str, MeshSurfaces], Contacts]:
    """The surfaces of the meshes and the contacts of the parts. What these depend on is what their stage sees of the
    assembly, without its function; and the vertices, as tests change those of a mesh and leave its digest."""
    shapes = (part.mesh.vertices.tobytes() for part in whole.parts)
    key = digest(for_contacts(whole), *(hashlib.sha256(shape).hexdigest() for shape in shapes))
    if key not in _known or not remember:
        found = {part.mesh.digest: surfaces.recover(part.mesh, whole.tolerances) for part in whole.parts}
        _known[key] = found, contacts.find(whole, found)
    return _known[key]

"""Small assemblies, their suggestions and what is derived from them."""

from __future__ import annotations

from dataclasses import replace

from kinform import contacts, kinematics, surfaces
from support.assemblies import assembly
from support.solids import box, part, rod

CORNERS = [(12, 8), (-12, 8), (-12, -8), (12, -8)]


def made_of(X, infer=False, assume=(), joints=(), **solids):
    """An assembly of solids (mm) in a common pose."""
    made = assembly(*(part(name, solid, X) for name, solid in solids.items()), assume=assume, joints=joints)
    return replace(made, infer_fasteners=infer)


def found(X, **wanted):
    """Suggestions, and bodies and joints."""
    made = made_of(X, **wanted)
    recovered = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    touching = contacts.find(made, recovered)
    return touching.suggestions, kinematics.derive(made, recovered, touching)


def drilled(z0, z1, places, radius=2.0):
    """A plate with holes."""
    plate = box(-20, 20, -15, 15, z0, z1)
    for x, y in places:
        plate = plate - rod(radius, z0 - 1, z1 + 1).translate((x, y, 0))
    return plate


def kinds(suggestions):
    """Pairs and kinds."""
    return [(hint.parts, hint.kind) for hint in suggestions]

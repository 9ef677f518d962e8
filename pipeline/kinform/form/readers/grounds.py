"""What the name of a sub-assembly stands for where a joint names it: its ground, or its largest part."""

from __future__ import annotations

from collections.abc import Sequence

from kinform.form.readers.open_manifest import Scope
from kinform.foundation.tied_sizes import largest
from kinform.model.assembly import Part, Subassembly


def grounds_of(scopes: Sequence[Scope], subassemblies: Sequence[Subassembly], parts: Sequence[Part]) -> dict[str, str]:
    """The full name of a part or group for each sub-assembly that has parts: what its manifest states to be the ground,
    else the part of the greatest volume, the first by name of those that are as large but for rounding."""
    stated = {scope.prefix: scope.manifest.assembly.ground for scope in scopes}
    size = {part.name: abs(part.mesh.health.volume) if part.mesh is not None else 0.0 for part in parts}
    out = {}
    for one in subassemblies:
        prefix = one.name + "/"
        inside = [part.name for part in parts if part.name.startswith(prefix)]
        ground = stated.get(prefix)
        if ground is not None:
            out[one.name] = prefix + ground
        elif inside:
            out[one.name] = largest({name: size[name] for name in inside})
    return out

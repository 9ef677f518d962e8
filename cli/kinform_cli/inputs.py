"""What `import` and `run` start from: one manifest, or meshes in place of one."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from kinform_cli.errors import refuse
from kinform_cli.files import MESHES

__all__ = ["Sources", "is_manifest"]

Sources = Annotated[
    list[Path],
    typer.Argument(
        metavar="M.toml|MESH",
        show_default=False,
        help="A manifest; or STL and OBJ files in place of one, with --units.",
    ),
]


def is_manifest(sources: Sequence[Path], units: str | None) -> bool:
    """Whether the sources are a manifest (else meshes); InputError where they are a mixture."""
    kinds = {source.suffix.lower() for source in sources}
    if kinds <= set(MESHES):
        if units is None:
            raise refuse(
                "the unit of these meshes is not stated",
                file=sources[0],
                remedy="add --units mm (or m, cm, um, in, ft)",
            )
        return False
    if ".h5" in kinds or ".hdf5" in kinds:
        raise refuse(
            "is a results file; this command starts from a manifest or from meshes",
            file=next(source for source in sources if source.suffix.lower() in (".h5", ".hdf5")),
            remedy="look into it with `kinform show`, or verify it with `kinform check`",
        )
    if len(sources) > 1:
        raise refuse(
            "several inputs that are not all meshes",
            file=next(source for source in sources if source.suffix.lower() not in MESHES),
            remedy="name one manifest (.toml), or only meshes (.stl, .obj)",
        )
    if units is not None:
        raise refuse(
            "--units is for meshes in place of a manifest",
            file=sources[0],
            remedy="leave --units out: the manifest states its own `units`",
        )
    return True

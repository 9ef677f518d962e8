"""Reuse inside the contacts stage: surfaces mesh by mesh, contacts pair by pair.

Patches are kept in the world frame, so the contacts of a pair are reused only where shape and pose of both parts are
the same to the last bit.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from kinform import contacts as contacts_stage
from kinform import surfaces as surfaces_stage
from kinform.foundation.processes import map_in_processes
from kinform.foundation.progress import Progress
from kinform.foundation.words import counted
from kinform.model.assembly import Assembly, Mesh
from kinform.model.contacts import Contacts
from kinform.model.names import PartName
from kinform.model.surfaces import MeshSurfaces
from kinform.model.tolerances import Tolerances
from kinform.reuse.dependence import CONTACTS
from kinform.reuse.digest import digest
from kinform.reuse.fingerprints import Inputs, few, mark
from kinform.reuse.ledger import Ledger
from kinform.surfaces.copies import Copy

Pair = tuple[PartName, PartName]


def surfaces(
    view: Assembly,
    jobs: int,
    progress: Progress | None,
    ledger: Ledger,
    meanwhile: Callable[[], None] | None = None,
) -> tuple[dict[str, MeshSurfaces], dict[str, str]]:
    """Surfaces and fingerprints by mesh digest, of the assembly as the contacts stage sees it. `meanwhile` is called
    while other processes look for them."""
    meshes: dict[str, Mesh] = {}
    for part in view.parts:
        if part.mesh is not None:
            meshes.setdefault(part.mesh.digest, part.mesh)
    copies = surfaces_stage.rigid_copies(meshes)
    marks = {key: mark("surfaces", _of_mesh(mesh, view.tolerances, copies.get(key))) for key, mesh in meshes.items()}
    result: dict[str, MeshSurfaces] = {}
    if ledger.previous is not None:
        before, earlier = ledger.fingerprints.meshes, ledger.previous.surfaces
        result = {key: earlier[key] for key, mark_now in marks.items() if before.get(key) == mark_now}
    wanted = [key for key in sorted(meshes) if key not in result]
    if result:
        ledger.keep(f"surfaces of {counted(len(result), 'mesh', 'meshes')}")
    if wanted:
        ledger.compute(f"surfaces of {counted(len(wanted), 'mesh', 'meshes')}", _why_meshes(view, wanted, ledger))
    recover = functools.partial(surfaces_stage.recover_all, tolerances=view.tolerances)
    shapes = sorted({copies[k].of if k in copies else k for k in wanted} - set(result))
    # the largest first, so that no core is left with one of them at the end
    packs = [[shapes[i] for i in pack] for pack in surfaces_stage.packs([len(meshes[k].faces) for k in shapes], jobs)]
    name = lambda pack: f"surfaces of {few([mesh.path for mesh in pack])}"
    wanted_of = [[meshes[k] for k in pack] for pack in packs]
    recovered = map_in_processes(recover, wanted_of, jobs, name=name, meanwhile=meanwhile)
    done = 0
    for pack, found in zip(packs, recovered, strict=True):
        result.update(zip(pack, found, strict=True))
        done += len(pack)
        if progress is not None:
            progress(done, len(shapes))
    for key in wanted:
        if key in copies:
            result[key] = surfaces_stage.surfaces_of_copy(result[copies[key].of], key, copies[key])
    return {key: result[key] for key in sorted(result)}, {key: marks[key] for key in sorted(marks)}


def contacts(
    view: Assembly,
    recovered: dict[str, MeshSurfaces],
    stage_mark: str,
    jobs: int,
    progress: Progress | None,
    ledger: Ledger,
    meanwhile: Callable[[], None] | None = None,
) -> tuple[Contacts, dict[Pair, str]]:
    """Contacts of the assembly and fingerprints by pair; `stage_mark` is the fingerprint of the whole stage.
    `meanwhile` is called while other processes look for them."""
    before = ledger.fingerprints
    earlier = None if ledger.previous is None else ledger.previous.contacts
    if earlier is not None and before.stages.get("contacts") == stage_mark:
        ledger.keep(f"contacts of {counted(len(earlier.candidates), 'pair')} of parts")
        return earlier, before.pairs
    parts = _of_parts(view, recovered)

    def mark_of(pair: Pair) -> str:
        return mark("contacts", {"the tolerances": digest(view.tolerances), **parts[pair[0]], **parts[pair[1]]})

    same = frozenset(pair for pair, old in before.pairs.items() if parts.keys() >= set(pair) and mark_of(pair) == old)
    result = contacts_stage.find(
        view, recovered, jobs=jobs, reuse=earlier, reuse_pairs=same, progress=progress, meanwhile=meanwhile
    )  # fmt: skip
    kept = [pair for pair in result.candidates if pair in same]
    wanted = [pair for pair in result.candidates if pair not in same]
    if kept:
        ledger.keep(f"contacts of {counted(len(kept), 'pair')} of parts")
    if wanted or not kept:
        what = f"contacts of {counted(len(wanted), 'pair')} of parts"
        ledger.compute(what, _why_pairs(view, parts, wanted, ledger))
    return result, {pair: mark_of(pair) for pair in result.candidates}


def _of_mesh(mesh: Mesh, tolerances: Tolerances, copy: Copy | None) -> Inputs:
    """Inputs of the surfaces of one mesh; a copy has them from the mesh that it is a copy of."""
    inputs = {"the shape": digest(mesh.bare), "the tolerances": digest(tolerances)}
    return inputs if copy is None else {**inputs, "the shape that it is a copy of": copy.of}


def _of_parts(view: Assembly, recovered: Mapping[str, MeshSurfaces]) -> dict[str, Inputs]:
    """What each meshed part, as the contacts stage sees it, brings to the contacts of its pairs."""
    meshes = {part.mesh.digest: part.mesh for part in view.parts if part.mesh is not None}
    shapes = {key: digest(mesh, recovered[key]) for key, mesh in meshes.items() if key in recovered}
    return {
        part.name: {
            f"the shape of {part.name}": shapes[part.mesh.digest],
            f"the pose of {part.name}": digest(part.X_WP),
            f"whether {part.name} is solid": digest(part.solid),
        }
        for part in view.parts
        if part.mesh is not None and part.mesh.digest in shapes
    }


def _why_meshes(view: Assembly, wanted: Sequence[str], ledger: Ledger) -> str:
    before = ledger.previous
    if before is None or not before.surfaces:
        return "not computed before"
    if before.assembly.tolerances != view.tolerances:
        return "the tolerances changed"
    new = set(wanted) - set(before.surfaces)
    names = [part.name for part in view.parts if part.mesh is not None and part.mesh.digest in new]
    if not names:
        return "computed by another version of kinform"
    return f"new shape of {few(names)}"


def _why_pairs(view: Assembly, parts: Mapping[str, Inputs], wanted: Sequence[Pair], ledger: Ledger) -> str:
    before = ledger.previous
    if before is None or before.contacts is None:
        return "not computed before"
    if before.assembly.tolerances != view.tolerances:
        return "the tolerances changed"
    names = sorted({name for pair in wanted for name in pair})
    asked = replace(before.assembly, parts=tuple(part for part in before.assembly.parts if part.name in set(names)))
    old = _of_parts(CONTACTS.view(asked), before.surfaces)
    reasons = [f"{name} is new" for name in names if name not in old]
    for name in names:
        changed = [key for key, now in parts[name].items() if name in old and old[name].get(key) != now]
        reasons += [f"{key} changed" for key in changed]
    if reasons:
        return few(reasons)
    if any(pair in before.fingerprints.pairs for pair in wanted):
        return "computed by another version of kinform"
    return "not looked at before" if wanted else "which pairs are looked at changed"

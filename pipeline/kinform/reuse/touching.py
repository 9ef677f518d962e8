"""Reuse inside the contacts stage: surfaces mesh by mesh, contacts pair by pair.

Patches are kept in the world frame, so the contacts of a pair are reused only where shape and pose of both
parts are the same to the last bit.
"""

from __future__ import annotations

import functools
import signal
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

from kinform import contacts as contacts_stage
from kinform import surfaces as surfaces_stage
from kinform.foundation.progress import Progress
from kinform.model.assembly import Assembly, Mesh
from kinform.model.contacts import Contacts
from kinform.model.names import PartName
from kinform.model.surfaces import MeshSurfaces
from kinform.model.tolerances import Tolerances
from kinform.reuse import fingerprints, inputs
from kinform.reuse.ledger import Ledger
from kinform.surfaces.copies import Copy

__all__ = ["contacts", "surfaces"]

Pair = tuple[PartName, PartName]
Item = TypeVar("Item")
Out = TypeVar("Out")


def surfaces(
    view: Assembly, jobs: int, progress: Progress | None, ledger: Ledger
) -> tuple[dict[str, MeshSurfaces], dict[str, str]]:
    """Surfaces and fingerprints by mesh digest, of the assembly as the contacts stage sees it."""
    meshes: dict[str, Mesh] = {}
    for part in view.parts:
        if part.mesh is not None:
            meshes.setdefault(part.mesh.digest, part.mesh)
    copies = surfaces_stage.rigid_copies(meshes)
    marks = {
        key: fingerprints.mark("surfaces", _inputs_of(mesh, view.tolerances, copies.get(key)))
        for key, mesh in meshes.items()
    }
    before = ledger.previous
    found: dict[str, MeshSurfaces] = {}
    if before is not None:
        known = before.fingerprints.meshes
        found = {key: before.surfaces[key] for key, mark in marks.items() if known.get(key) == mark}
    wanted = [key for key in sorted(meshes) if key not in found]
    if found:
        ledger.keep(f"surfaces of {_count(len(found), 'mesh', 'meshes')}")
    if wanted:
        ledger.compute(f"surfaces of {_count(len(wanted), 'mesh', 'meshes')}", _why_meshes(view, wanted, ledger))
    recover = functools.partial(_recover, view.tolerances)
    # the largest first, so that no core is left with one of them at the end
    shapes = sorted(
        {copies[k].of if k in copies else k for k in wanted} - set(found), key=lambda k: (-len(meshes[k].faces), k)
    )
    for key, recovered in zip(shapes, _mapped(recover, [meshes[k] for k in shapes], jobs, progress), strict=True):
        found[key] = recovered
    for key in wanted:
        if key in copies:
            found[key] = surfaces_stage.surfaces_of_copy(found[copies[key].of], key, copies[key])
    return {key: found[key] for key in sorted(found)}, {key: marks[key] for key in sorted(marks)}


def contacts(
    view: Assembly,
    recovered: dict[str, MeshSurfaces],
    mark: str,
    jobs: int,
    progress: Progress | None,
    ledger: Ledger,
) -> tuple[Contacts, dict[Pair, str]]:
    """Contacts of the assembly and fingerprints by pair; `mark` is the fingerprint of the whole stage."""
    before = ledger.previous
    earlier = None if before is None else before.contacts
    if before is not None and earlier is not None and before.fingerprints.stages.get("contacts") == mark:
        ledger.keep(f"contacts of {_count(len(earlier.candidates), 'pair', 'pairs')} of parts")
        return earlier, before.fingerprints.pairs
    known = {} if before is None else before.fingerprints.pairs
    parts = fingerprints.of_parts(view, recovered)

    def mark_of(pair: Pair) -> str:
        inputs_of_pair = fingerprints.of_pair(view.tolerances, parts[pair[0]], parts[pair[1]])
        return fingerprints.mark("contacts", inputs_of_pair)

    same = frozenset(pair for pair, old in known.items() if parts.keys() >= set(pair) and mark_of(pair) == old)
    found = contacts_stage.find(view, recovered, jobs=jobs, reuse=earlier, reuse_pairs=same, progress=progress)
    kept = [pair for pair in found.candidates if pair in same]
    wanted = [pair for pair in found.candidates if pair not in same]
    if kept:
        ledger.keep(f"contacts of {_count(len(kept), 'pair', 'pairs')} of parts")
    if wanted or not kept:
        what = f"contacts of {_count(len(wanted), 'pair', 'pairs')} of parts"
        ledger.compute(what, _why_pairs(view, parts, wanted, ledger))
    return found, {pair: mark_of(pair) for pair in found.candidates}


def _inputs_of(mesh: Mesh, tolerances: Tolerances, copy: Copy | None) -> fingerprints.Inputs:
    """A copy has its surfaces from the mesh that it is a copy of."""
    own = fingerprints.of_mesh(mesh, tolerances)
    return own if copy is None else {**own, "the shape that it is a copy of": copy.of}


def _recover(tolerances: Tolerances, mesh: Mesh) -> MeshSurfaces:
    return surfaces_stage.recover(mesh, tolerances)


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
    return f"new shape of {fingerprints.listed(names)}"


def _why_pairs(view: Assembly, parts: Mapping[str, fingerprints.Inputs], wanted: Sequence[Pair], ledger: Ledger) -> str:
    before = ledger.previous
    if before is None or before.contacts is None:
        return "not computed before"
    if before.assembly.tolerances != view.tolerances:
        return "the tolerances changed"
    names = sorted({name for pair in wanted for name in pair})
    asked = replace(before.assembly, parts=tuple(part for part in before.assembly.parts if part.name in set(names)))
    old = fingerprints.of_parts(inputs.assembly_for("contacts", asked), before.surfaces)
    reasons = [f"{name} is new" for name in names if name not in old]
    for name in names:
        changed = [key for key, mark in parts[name].items() if name in old and old[name].get(key) != mark]
        reasons += [f"{key} changed" for key in changed]
    if reasons:
        return fingerprints.listed(reasons)
    if any(pair in before.fingerprints.pairs for pair in wanted):
        return "computed by another version of kinform"
    return "not looked at before" if wanted else "which pairs are looked at changed"


def _count(number: int, one: str, many: str) -> str:
    return f"{number} {one if number == 1 else many}"


def _mapped(
    function: Callable[[Item], Out], items: Sequence[Item], jobs: int, progress: Progress | None
) -> Iterator[Out]:
    """The function of each item, in their order, in `jobs` processes where the system can fork."""
    for done, result in enumerate(_results(function, items, jobs), start=1):
        if progress is not None:
            progress(done, len(items))
        yield result


def _results(function: Callable[[Item], Out], items: Sequence[Item], jobs: int) -> Iterator[Out]:
    if jobs <= 1 or len(items) < 2:
        yield from map(function, items)
        return
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor

    if "fork" not in multiprocessing.get_all_start_methods():
        yield from map(function, items)
        return
    context = multiprocessing.get_context("fork")
    pool = ProcessPoolExecutor(jobs, context, initializer=signal.signal, initargs=(signal.SIGINT, signal.SIG_IGN))
    try:
        yield from pool.map(function, items)
    finally:
        pool.shutdown(wait=True, cancel_futures=True)

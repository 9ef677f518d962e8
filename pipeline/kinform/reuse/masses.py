"""Reuse inside the mass stage: mass properties of parts that are the same to the last bit."""

from __future__ import annotations

from kinform.design import Design
from kinform.model.assembly import Assembly
from kinform.model.mass import MassProperties
from kinform.reuse import fingerprints
from kinform.reuse.dependence import MASS
from kinform.reuse.digest import digest
from kinform.reuse.ledger import Ledger


def earlier_masses(design: Design, view: Assembly, ledger: Ledger) -> dict[str, MassProperties]:
    """Of earlier results of the present code, the mass properties of unchanged parts, by name; `view`: the assembly as
    the mass stage sees it."""
    previous, marks = ledger.previous, ledger.fingerprints
    if previous is None or previous.assembly.tolerances != view.tolerances or "mass" not in marks.inputs:
        return {}
    if marks.stages.get("mass") != fingerprints.mark("mass", marks.inputs["mass"]) or previous.mass is None:
        return {}
    before, now = marks.meshes, design.fingerprints.meshes
    old = {part.name: digest(part) for part in MASS.view(previous.assembly).parts}
    same = {
        str(part.name)
        for part in view.parts
        if old.get(part.name) == digest(part)
        and (part.mesh is None or before.get(part.mesh.digest) == now.get(part.mesh.digest) is not None)
    }
    return {item.name: item for item in previous.mass.parts if item.name in same}

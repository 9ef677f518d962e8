"""A block in a slot and a lever between pegs, as meshes through to joints, and runs in which a part is moved."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinform import contacts, kinematics, surfaces
from kinform.model.simulation import Simulation
from support.solids import assembly, box, part, rod

__all__ = ["SLOT", "block_in_slot", "derived", "lever_between_pegs", "moved"]

SLOT = (-40, 30)


def block_in_slot(gap=0.0):
    lever = box(-60, 60, -20, 20, 0, 8) - box(*SLOT, -9, 9, -1, 9) - box(*SLOT, -11, 11, 3, 5)
    block = box(-12, 12, -9 + gap, 9 - gap, 0, 8) + box(-12, 12, -11 + gap, 11 - gap, 3 + gap, 5 - gap)
    return {"lever": lever, "block": block}


def lever_between_pegs():
    plate = box(-50, 50, -50, 50, -5, 0) + rod(5, -1, 11) + rod(8, 10, 13)
    base = plate + box(28, 32, 12, 16, -1, 8) + box(20, 24, -20, -16, -1, 8)
    lever = box(-8, 40, -4, 4, 0, 10) + rod(9, 0, 10) - rod(5.02, -1, 11, 32, 3.0)
    return {"base": base, "lever": lever}


def derived(solids, X=None, ground=None, scale=1e-3, contact=None):
    """Assembly, surfaces, contacts and kinematics of solids in units of `scale` (m); `contact`: that tolerance."""
    X = np.eye(4) if X is None else X
    made = assembly(*(part(name, solid, X, scale) for name, solid in solids.items()), ground=ground)
    if contact is not None:
        made = replace(made, tolerances=replace(made.tolerances, contact=contact * scale))
    known = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    touching = contacts.find(made, known)
    return made, known, touching, kinematics.derive(made, known, touching)


def moved(kin, places, X, name="block"):
    """A run in which the part is at `places` (m) along the slot, a second apart."""
    names = tuple(sorted(str(body.name) for body in kin.bodies))
    p, q = np.zeros((len(places), 2, 3)), np.zeros((len(places), 2, 4))
    q[..., 0] = 1.0
    p[:, names.index(name)] = np.outer(places, X[:3, 0])
    made = object.__new__(Simulation)
    for name, value in {"time": np.arange(float(len(places))), "body_names": names, "p_WB": p, "q_WB": q}.items():
        object.__setattr__(made, name, value)
    return made

"""Couplings that the function states, imposed on joints of geometry where no teeth and no screw give them a ratio.

Teeth and screws that geometry shows keep their own ratio, whatever is stated: a difference is a finding, not a motion.
What they leave free is tied as stated. A joint that is general because teeth, and nothing else, carry it is replaced
by a coupling that ties all joints on the way from its one body to the other: a planet and the sun that is borne in the
housing, the side wheels of a differential. Cams are not: their ratio is another in every pose.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from kinform.foundation.graphs.graph import UnionFind
from kinform.foundation.rounding import SOLVED
from kinform.frozen import dataclass
from kinform.function import resolve_joint
from kinform.kinematics import is_higher
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.function import Coupling
from kinform.model.kinematics import Coupling as Found
from kinform.model.kinematics import Kinematics


@dataclass(frozen=True)
class Imposed:
    """What becomes of the stated couplings of an assembly with meshes."""

    couplings: tuple[tuple[int, Coupling], ...]
    """Those that are imposed, by their number, counted from 1."""
    replaced: Mapping[str, int]
    """By the name of a joint that is general by its teeth alone: the number of the coupling that stands for it."""


def imposed_couplings(assembly: Assembly, kinematics: Kinematics, contacts: Contacts | None) -> Imposed:
    """The stated couplings that geometry leaves to be stated.

    Without `contacts` no joint is known to be general by its teeth alone, and none is replaced.
    """
    counted = {str(coupling.through): coupling for coupling in kinematics.couplings if _keeps_ratio(coupling)}
    rows = [{str(c.joints[0]): 1.0, str(c.joints[1]): -c.ratio} for c in counted.values()]
    couplings: list[tuple[int, Coupling]] = []
    replaced: dict[str, int] = {}
    for number, stated in enumerate(assembly.function.couplings, start=1):
        ends = [resolve_joint(assembly, kinematics, name).joint for name in stated.every]
        names = [str(joint.name) for joint in ends if joint is not None and joint.freedoms == 1]
        if len(set(names)) == len(stated.every) and _left_free(rows, names) >= 2:
            couplings.append((number, stated))
            replaced |= {
                name: number for name in _carried_by_teeth(kinematics, contacts, names, counted) if name not in replaced
            }
    return Imposed(tuple(couplings), replaced)


def _keeps_ratio(coupling: Found) -> bool:
    """Whether it is simulated with the ratio that geometry gives."""
    return coupling.kind == "screw" or (coupling.meshing is not None and coupling.status == "determined")


def _left_free(rows: Sequence[Mapping[str, float]], names: Sequence[str]) -> int:
    """How many of the values of these joints the ratios of geometry leave free of each other."""
    columns = sorted({name for row in rows for name in row} | set(names))
    index = {name: k for k, name in enumerate(columns)}
    ties = np.zeros((len(rows), len(columns)))
    for k, row in enumerate(rows):
        size = max(abs(factor) for factor in row.values())
        for name, factor in row.items():
            ties[k, index[name]] = factor / size
    free = _null_space(ties)[[index[name] for name in names]]
    return int(np.linalg.matrix_rank(free, tol=SOLVED)) if free.size else 0


def _null_space(matrix: Array) -> Array:
    """(n, z) directions that the rows leave."""
    if not len(matrix):
        return np.eye(matrix.shape[1])
    _, values, right = np.linalg.svd(matrix)
    rank = int(np.count_nonzero(values > SOLVED * values[0]))
    return np.asarray(right[rank:].T)


def _carried_by_teeth(
    kinematics: Kinematics, contacts: Contacts | None, names: Sequence[str], counted: Mapping[str, Found]
) -> list[str]:
    """Joints that are general by points and lines alone, and whose bodies the joints of these names connect."""
    if contacts is None:
        return []
    number = {body.name: k for k, body in enumerate(kinematics.bodies)}
    met = UnionFind(len(number))
    for joint in kinematics.joints:
        if joint.name in names:
            met.union(*(number[name] for name in joint.bodies))
    uneven = {str(coupling.through) for coupling in kinematics.couplings if coupling.kind == "cam"}
    return [
        str(joint.name)
        for joint in kinematics.joints
        if joint.name not in counted
        and joint.name not in uneven
        and is_higher(joint, contacts.patches)
        and len({met.find(number[name]) for name in joint.bodies}) == 1
    ]

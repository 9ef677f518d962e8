"""`[function] complete = true`: every joint that is meant to move is stated; what no contact holds is taken as stated.

Robot descriptions end their meshes at a flange or leave a gap: pins and bearings are in no mesh. With a function that
says that it is complete
- a stated fixed joint makes its two sides one body;
- contact between bodies that stated joints move relative to each other, and that no stated joint joins, constrains
  nothing: crossing legs, link 0 on link 2 (it is reported: KF406, KF407);
- a stated joint that contact does not hold, or that has no contact, is taken as stated (`joints_in_force`); what
  contact certainly forbids stays as contact has it.

It covers the parts of its own file. Where the top manifest is complete, all bodies follow from the joints
(`kinematics/partition`); else parts that no stated joint reaches are decided by contact as ever.
"""

from __future__ import annotations

from collections.abc import Callable

from kinform.foundation.graphs.graph import UnionFind
from kinform.kinematics.joints.bodies.merging import Merger
from kinform.model.assembly import Assembly
from kinform.model.function import IntendedJoint
from kinform.model.names import PartName


def complete_joints(assembly: Assembly) -> tuple[IntendedJoint, ...]:
    """The intended joints of manifests that say that they are complete."""
    covered = set(assembly.function.complete)
    return tuple(j for j in assembly.function.joints if j.name[: j.name.rfind("/") + 1] in covered)


def rests(assembly: Assembly) -> bool:
    """Whether the manifest at the top says that it is complete, and states fixed joints alone: nothing moves."""
    joints = assembly.function.joints
    return "" in assembly.function.complete and bool(joints) and all(joint.type == "fixed" for joint in joints)


def without_effect(assembly: Assembly, merger: Merger) -> Callable[[PartName, PartName], bool]:
    """Tells of two parts whether contact between them constrains nothing, as bodies are now."""
    pairs: set[frozenset[int]] = set()
    numbers: dict[int, int] = {}
    for joint in complete_joints(assembly):
        if joint.type != "fixed":
            ends = [merger.root(assembly.parts_of(name)[0]) for name in joint.between]
            pairs.add(frozenset(ends))
            for end in ends:
                numbers.setdefault(end, len(numbers))
    chained = UnionFind(len(numbers))
    for pair in pairs:
        chained.union(*(numbers[end] for end in (min(pair), max(pair))))

    def nothing(first: PartName, second: PartName) -> bool:
        a, b = merger.root(first), merger.root(second)
        if a not in numbers or b not in numbers or frozenset((a, b)) in pairs:
            return False
        return chained.find(numbers[a]) == chained.find(numbers[b])

    return nothing

"""The mobility of a sub-assembly by itself: of its parts among themselves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from kinform.consistency.questions.immobile_joints import bodies_between, is_immobile
from kinform.consistency.questions.passive_turns import passive_turns
from kinform.design import Design
from kinform.frozen import dataclass
from kinform.kinematics.mobility.finite_motion import finite_mobility
from kinform.kinematics.mobility.idle import idle_turns
from kinform.kinematics.mobility.named_freedoms import named_freedoms
from kinform.kinematics.mobility.two_ends import joint_ends, mobility_ends
from kinform.mechanism.first_order import body_twists
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.kinematics import Kinematics
from kinform.model.names import BodyName


@dataclass(frozen=True, eq=False)
class InnerMobility:
    """Freedoms of some parts among themselves."""

    count: int
    """All, finite ones where that is known."""
    idle: int
    """Of them, turns of single bodies that nobody sees."""
    still: tuple[str, ...]
    """Stated joints among these parts that none of the freedoms moves."""
    ends: tuple[int, int] = (0, 0)
    """The least and the most that `effective` may be, by joints drawn at a stop or in doubt (`mobility.two_ends`)."""

    passive: int = 0
    """Bodies that turn about the line of their ball joints."""

    @property
    def effective(self) -> int:
        """All but the idle ones."""
        return self.count - self.idle


def inner_mobility(design: Design, part_names: Sequence[str]) -> InnerMobility | None:
    """Freedoms of some parts among themselves: of the bodies they belong to, by the joints between those, relative to
    the first of these bodies, or to ground if it is among them. None where two ways to count them disagree. Raises
    AssertionError without kinematics."""
    kinematics = design.kinematics
    assert kinematics is not None
    graph = _graph_within(kinematics, part_names)
    if graph is None:
        return InnerMobility(0, 0, ())
    size = kinematics.matrix.length
    closure = graph.close(size)
    finite = finite_mobility(graph.edges, graph.joints, len(graph.bodies), closure.mobility, size)
    if finite.on_edge:
        return None
    wanted, assembly = set(part_names), design.assembly
    inside = [j for j in assembly.function.joints if all(wanted.issuperset(assembly.parts_of(n)) for n in j.between)]
    alone = replace(assembly, function=replace(assembly.function, joints=tuple(inside)))
    # what is stated as ground of the whole need not be among them
    alone = alone if any(body.ground for body in graph.bodies) else replace(alone, ground=None)
    idle, spinning = 0, set[BodyName]()
    if design.contacts is not None:
        based = replace(graph, bodies=tuple(replace(b, ground=k == graph.ground) for k, b in enumerate(graph.bodies)))
        turns = idle_turns(alone, based, design.contacts.patches, size, design.surfaces)
        places = [assembly.part(body.parts[0]).X_WP[:3, 3] for body in graph.bodies]
        named = [freedom for freedom in named_freedoms(graph, closure, turns, places, size) if freedom.idle]
        idle, spinning = len(named), {freedom.body for freedom in named}
    twists, still = body_twists(closure, graph.edges, graph.spaces), []
    for joint in inside:
        first, second = bodies_between(assembly, kinematics, joint)
        if is_immobile(joint, twists[:, graph.node[second]] - twists[:, graph.node[first]]):
            still.append(joint.name)
    count = closure.mobility if finite.count is None else finite.count
    ends = mobility_ends(graph, joint_ends(alone, graph, ()), count - idle, closure.mobility, size, None)
    return InnerMobility(count, idle, tuple(still), ends, len(passive_turns(graph.bodies, graph.joints, spinning)))


def _graph_within(kinematics: Kinematics, part_names: Sequence[str]) -> JointGraph | None:
    """The bodies of some parts with the joints between them; None where there are no bodies."""
    wanted = set(part_names)
    bodies = tuple(b for b in kinematics.bodies if wanted.intersection(b.parts))
    names = {body.name for body in bodies}
    joints = tuple(j for j in kinematics.joints if names.issuperset(j.bodies))
    return JointGraph(bodies, joints) if bodies else None

"""The kinematics stage: contacts → bodies, joints, constraint matrix, mobility. `derive` reads as its method."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from kinform.foundation.memory import uncollected
from kinform.frozen import dataclass
from kinform.kinematics.joints.axes.bounds import move_bounds
from kinform.kinematics.joints.axes.equal_lengths import equalise_lengths
from kinform.kinematics.joints.axes.higher_pairs import align_higher_pairs
from kinform.kinematics.joints.axes.misfit import misfit_of, moves_between
from kinform.kinematics.joints.axes.proportions import fit_proportions
from kinform.kinematics.joints.axes.snapping import snap_axes
from kinform.kinematics.joints.bodies.classification import Pairs, decide_ignored
from kinform.kinematics.joints.bodies.complete_function import complete_joints, rests
from kinform.kinematics.joints.bodies.end_play import without_end_play
from kinform.kinematics.joints.bodies.fasteners import label_inferred, turn_about_suggested_axes
from kinform.kinematics.joints.bodies.fusing import Fused, fuse_as_given, fuse_by_contact
from kinform.kinematics.joints.bodies.ignored_contacts import ignored_contacts
from kinform.kinematics.joints.bodies.joints_in_force import joints_in_force
from kinform.kinematics.joints.bodies.readings import choose_readings
from kinform.kinematics.joints.bodies.stated_joints import stated_joints
from kinform.kinematics.joints.pair.question import Answer
from kinform.kinematics.mechanism_results import DecidedMechanism, kinematics_of
from kinform.kinematics.partition import Partition, find_missing_sides, partition, undeclared_joints
from kinform.kinematics.step_cache import StepCache
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.kinematics import Body, Joint, Kinematics, Membership, Move, Unseparated, body_of_part
from kinform.model.names import BodyName, JointName, PartName
from kinform.model.surfaces import MeshSurfaces


@uncollected()
def derive(
    assembly: Assembly,
    surfaces: Mapping[str, MeshSurfaces],
    contacts: Contacts,
    cache: StepCache | None = None,
) -> Kinematics:
    """Bodies, joints, J and mobility of an assembly whose contacts are known.

    The joints of pairs of bodies, and what separates, may come from the `cache`. Raises OpenSidesError where a joint
    names one side or none and it is not clear which are meant.
    """
    assembly, sides = find_missing_sides(assembly, contacts)
    pairs = Pairs(assembly, contacts, cache)
    # parts as a function that states all joints has them together; None: contact decides
    found = partition(assembly, contacts, assembly.function.joints, surfaces) if _complete(assembly) else None
    fused = fuse_by_contact(pairs, contacts) if found is None else fuse_as_given(pairs, found.parts)
    bodies = fused.merger.bodies()
    decided = _decide_joints(pairs, surfaces, contacts, fused, bodies, whole=found is not None)
    joints, moves = _consistent_axes(pairs, bodies, decided.joints)
    mechanism = DecidedMechanism(
        assembly=assembly,
        graph=JointGraph(bodies, joints),
        size=pairs.size,
        clusters=bodies if found is not None else fused.clusters(assembly),
        patches=pairs.patches,
        strict={name: answer.strict for name, answer in decided.answers.items() if answer.strict is not None},
        surfaces=surfaces,
        extremes=pairs.extremes,
        cache=cache,
    )
    kinematics = kinematics_of(mechanism)
    ask_undeclared = found is not None or rests(assembly)
    return replace(
        kinematics,
        mobility=replace(kinematics.mobility, by_contact=decided.by_contact),
        misfit=misfit_of(moves),
        misaligned=_misaligned(decided.answers),
        moves=moves,
        asides=ignored_contacts(decided.ignored, pairs.patches, bodies, kinematics.mobility),
        membership=() if found is None else _membership(found, body_of_part(bodies)),
        unparted=() if found is None else tuple(Unseparated(joint, parts) for joint, parts in found.unparted.items()),
        left_out=undeclared_joints(assembly, surfaces, contacts, bodies) if ask_undeclared else (),
        sides=sides,
    )


def _complete(assembly: Assembly) -> bool:
    """Whether the function of the top states every joint that is meant to move."""
    stated = any(joint.type != "fixed" for joint in assembly.function.joints)
    return stated and "" in assembly.function.complete


@dataclass(frozen=True, eq=False)
class _DecidedJoints:
    """The joints in force between the bodies."""

    joints: tuple[Joint, ...]
    """Sorted by their bodies."""
    answers: Mapping[JointName, Answer]
    """What contact says of those that it decided."""
    ignored: tuple[Joint, ...] = ()
    """Joints of contact that constrains nothing: the function states all joints, and moves these bodies by others."""
    by_contact: int | None = None
    """Instantaneous mobility of what contact alone gives, where the function states all joints."""


def _decide_joints(
    pairs: Pairs,
    surfaces: Mapping[str, MeshSurfaces],
    contacts: Contacts,
    fused: Fused,
    bodies: tuple[Body, ...],
    *,
    whole: bool,
) -> _DecidedJoints:
    """The joint of every two bodies: by contact, as somebody states it, or as suggestions complete it.

    `whole`: the bodies follow from a function that states the joints of all parts.
    """
    assembly, of_part = pairs.assembly, body_of_part(bodies)
    decided = choose_readings(assembly, of_part, fused.decided, pairs.patches, pairs.size)
    decided = without_end_play(assembly, surfaces, bodies, decided, pairs.patches)
    stated = stated_joints(assembly, of_part)
    answers = {joint.name: answer for pair, (answer, joint) in sorted(decided.items()) if pair not in stated}
    every = {pair: joint for pair, (_, joint) in decided.items()} | stated
    joints = turn_about_suggested_axes(assembly, contacts, [every[pair] for pair in sorted(every)], bodies)
    joints = label_inferred(joints, bodies)
    if not complete_joints(assembly):
        return _DecidedJoints(tuple(joints), answers)
    by_contact = JointGraph(bodies, tuple(joints)).close(pairs.size).mobility
    beside = decide_ignored(pairs, fused.merger)
    taken = joints_in_force(assembly, fused.merger, joints, beside, pairs.patches, whole=whole)
    kept = {joint.name for joint in taken.joints if joint.status != "stated"}
    answers = {name: answer for name, answer in answers.items() if name in kept}
    return _DecidedJoints(taken.joints, answers, taken.ignored, by_contact)


def _consistent_axes(
    pairs: Pairs, bodies: tuple[Body, ...], joints: Sequence[Joint]
) -> tuple[tuple[Joint, ...], tuple[Move, ...]]:
    """The joints with axes that agree exactly where they agree within what contact tells, and by how much each moved:
    coaxial and parallel axes, then equal lengths, then proportions in which loops close. At last the spaces of teeth
    and cams are turned to agree with these (up to `MOST_TURNED`): no axis moves, and no move is recorded."""
    size, alignment = pairs.size, pairs.assembly.tolerances.alignment
    bounds = move_bounds(joints, pairs.patches, alignment, size)
    snapped = snap_axes(joints, bounds)
    left = bounds.after(moves_between(joints, snapped), joints)
    equal = equalise_lengths(JointGraph(bodies, snapped), left, size)
    left = bounds.after(moves_between(joints, equal), joints)
    fitted = fit_proportions(JointGraph(bodies, equal), left, size)
    aligned = align_higher_pairs(JointGraph(bodies, fitted), pairs.patches, size, alignment)
    return aligned, moves_between(joints, fitted)


def _misaligned(answers: Mapping[JointName, Answer]) -> tuple[tuple[str, float, float], ...]:
    """Joints whose mated axes differ beyond what clearance allows, by an angle (rad) and an offset (m)."""
    return tuple((name, a.angle, a.offset) for name, a in answers.items() if a.angle > 0.0 or a.offset > 0.0)


def _membership(found: Partition, of_part: Mapping[PartName, BodyName]) -> tuple[Membership, ...]:
    """What holds every part in its body."""
    names = [of_part[parts[0]] for parts in found.parts]
    return tuple(
        Membership(
            part,
            of_part[part],
            placed.how,
            placed.margin,
            BodyName("") if placed.other is None else names[placed.other],
            placed.unclear,
            placed.evidence,
        )
        for part, placed in sorted(found.placed.items())
    )

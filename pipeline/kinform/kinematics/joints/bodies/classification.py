"""Pairs of bodies that touch: each is decided by the patches between the two, fixed ones become one body."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.rounding import SINGLE
from kinform.foundation.words import quoted
from kinform.kinematics.joints.bodies.admitted import admits
from kinform.kinematics.joints.bodies.backlash import without_backlash
from kinform.kinematics.joints.bodies.complete_function import without_effect
from kinform.kinematics.joints.bodies.extents import Extents
from kinform.kinematics.joints.bodies.merging import Merger
from kinform.kinematics.joints.bodies.overlaps import deepest_overlaps, with_overlap
from kinform.kinematics.joints.bodies.stated_joints import Pair, joint_twists, pair_between, stated_roots
from kinform.kinematics.joints.pair.evidence import Evidence, Member, gather
from kinform.kinematics.joints.pair.question import Answer, Question, answer_each, bare_patches, joint_between
from kinform.kinematics.step_cache import StepCache, cached_each
from kinform.model.arrays import Ints
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.kinematics import Body, Joint, body_of_part
from kinform.model.names import BodyName, PartName
from kinform.model.tolerances import Tolerances


class Pairs:
    """Decides pairs of bodies by the patches between them."""

    def __init__(self, assembly: Assembly, contacts: Contacts, cache: StepCache | None = None):
        self.assembly = assembly
        self.patches = bare_patches(contacts.patches)
        self._tolerance, self._extents, self._cache = contacts.tolerance, Extents(assembly), cache
        self.size = self._extents.assembly
        """m: diagonal of the assembly."""
        self.interferences = contacts.interferences
        self.extremes: dict[int, Ints] = {}
        """Samples that bound the patches that were looked at."""

    def decide(self, pairs: Sequence[tuple[Sequence[Member], Sequence[Body]]]) -> list[Answer]:
        """What the patches between two bodies say, of several pairs of bodies."""
        questions = [self._question(members, bodies) for members, bodies in pairs]
        answers = cached_each(self._cache, "pair", questions, answer_each)
        for (members, _), answer in zip(pairs, answers, strict=True):
            self.extremes |= {index: samples for (index, _, _), samples in zip(members, answer.extremes, strict=True)}
        return [self._without_lost(answer, members) for answer, (members, _) in zip(answers, pairs, strict=True)]

    def _question(self, members: Sequence[Member], bodies: Sequence[Body]) -> Question:
        tolerances = self.assembly.tolerances
        contact, size = _scales(members, bodies, tolerances, self._tolerance, self._extents)
        return Question(tuple((patch, turned) for _, patch, turned in members), tolerances, contact, size)

    def _without_lost(self, answer: Answer, members: Sequence[Member]) -> Answer:
        """The answer, which is not certain where files lost the shapes of parts."""
        lost = {part for _, patch, _ in members for part in patch.parts} & self.assembly.lost
        if not lost or answer.joint is None:
            return answer
        meshes = {part: self.assembly.part(part).mesh for part in lost}
        share = self.assembly.tolerances.resolved
        in_file = any(mesh is not None and mesh.resolution > share * mesh.diagonal for mesh in meshes.values())
        what = ("file" if in_file else "place") + ("" if len(lost) == 1 else "s")
        reason = f"the {what} of {quoted(sorted(lost))} lost the shape: too few digits"
        return replace(answer, joint=replace(answer.joint, status="ambiguous", reason=reason))


def decide_all(pairs: Pairs, merger: Merger, *, fusing: bool = True) -> dict[Pair, tuple[Answer, Joint]]:
    """Decide every pair of touching bodies; fuse what is fixed; repeat until nothing fuses. Not `fusing`: bodies are
    known, and stay."""
    known: dict[tuple[int, ...], Answer] = {}
    stated = stated_roots(pairs.assembly, merger)
    while True:
        touching = _touching(pairs, merger, beside=False)
        out = _decided(pairs, merger, touching, known)
        fused = False
        moving = _stated_to_move(pairs.assembly, merger, touching) if fusing else set()
        for pair, (_, joint) in out.items():
            parts = touching[pair][0][1].parts
            if not fusing or pair in moving or frozenset(merger.root(p) for p in parts) in stated:
                continue
            if joint.type == "fixed" and joint.status == "determined":
                turning = bool(np.abs(joint.closed[:, :3]).max(initial=0.0) > SINGLE)
                merger.fuse(parts[0], parts[1], f"contact {parts[0]}~{parts[1]} leaves no freedom", turning=turning)
                fused = True
        if not fused:
            return out


def _stated_to_move(assembly: Assembly, merger: Merger, touching: Mapping[Pair, Sequence[Member]]) -> set[Pair]:
    """Pairs of bodies that the function states to move in a way that contact admits, in one sense at least."""
    bodies = {body.name: body for body in merger.bodies()}
    of_part = body_of_part(tuple(bodies.values()))
    out = set()
    for joint in assembly.function.joints:
        pair, motions = pair_between(assembly, of_part, joint.between), joint_twists(joint)
        if pair is None or motions is None or pair not in touching:
            continue
        if admits([patch for _, patch, _ in touching[pair]], motions, bodies[pair[0]].parts):
            out.add(pair)
    return out


def _stated_to_turn(assembly: Assembly, of_part: Mapping[PartName, BodyName]) -> set[Pair]:
    """Pairs of bodies that the function states to turn relative to each other."""
    turning = [joint for joint in assembly.function.joints if joint.type not in ("fixed", "prismatic")]
    pairs = (pair_between(assembly, of_part, joint.between) for joint in turning)
    return {pair for pair in pairs if pair is not None}


def decide_ignored(pairs: Pairs, merger: Merger) -> list[Joint]:
    """What contact would hold between bodies that a function which states all joints moves by others, sorted by their
    bodies: it constrains nothing."""
    decided = _decided(pairs, merger, _touching(pairs, merger, beside=True), {})
    return [joint for _, (_, joint) in sorted(decided.items())]


def _touching(pairs: Pairs, merger: Merger, *, beside: bool) -> dict[Pair, list[Member]]:
    """Patches by pairs of bodies; `beside`: of those that constrain nothing, else of all others."""
    of_part = body_of_part(merger.bodies())
    touching: dict[Pair, list[Member]] = defaultdict(list)
    nothing = without_effect(pairs.assembly, merger)
    for index, patch in enumerate(pairs.patches):
        a, b = of_part[patch.parts[0]], of_part[patch.parts[1]]
        if a != b and nothing(*patch.parts) == beside:
            touching[(a, b) if a < b else (b, a)].append((index, patch, a > b))
    for pair, members in touching.items():
        # what is known decides; what is not known leaves in doubt only what nothing else says
        touching[pair] = [member for member in members if not member[1].unknown] or members
    return touching


def _decided(
    pairs: Pairs, merger: Merger, touching: Mapping[Pair, Sequence[Member]], known: dict[tuple[int, ...], Answer]
) -> dict[Pair, tuple[Answer, Joint]]:
    """The joint of each pair of bodies by its patches; `known` are answers by patches, and those of now are added."""
    bodies = merger.bodies()
    of_name = {body.name: body for body in bodies}
    keys = {pair: tuple(-1 - i if turned else i for i, _, turned in touching[pair]) for pair in sorted(touching)}
    new = {key: pair for pair, key in keys.items() if key not in known}
    decided = pairs.decide([(touching[pair], [of_name[n] for n in pair]) for pair in new.values()])
    known |= zip(new, decided, strict=True)
    overlaps = deepest_overlaps(pairs.interferences, body_of_part(bodies))
    turning = _stated_to_turn(pairs.assembly, body_of_part(bodies))
    out: dict[Pair, tuple[Answer, Joint]] = {}
    for pair, key in keys.items():
        answer = known[key]
        if answer.joint is None:
            continue
        places = [index for index, _, _ in touching[pair]]
        joint = joint_between(answer.joint, pair, places)
        if joint.at_stop and pair not in turning:
            sides = ([pairs.assembly.part(part) for part in of_name[name].parts] for name in pair)
            joint = without_backlash(joint, pairs.patches, *sides)
        if pair in overlaps:
            joint = with_overlap(joint, overlaps[pair])
        if answer.other is not None:
            answer = replace(answer, other=joint_between(answer.other, pair, places))
        out[pair] = answer, joint
    return out


def evidence_between(
    members: Sequence[Member], bodies: Sequence[Body], assembly: Assembly, contacts: Contacts, extents: Extents
) -> Evidence | None:
    """Evidence of the patches between two bodies; None where none has an area."""
    contact, size = _scales(members, bodies, assembly.tolerances, contacts.tolerance, extents)
    return gather(members, assembly.tolerances, contact, size)


def _scales(
    members: Sequence[Member],
    bodies: Sequence[Body],
    tolerances: Tolerances,
    of_parts: Mapping[tuple[PartName, PartName], float],
    extents: Extents,
) -> tuple[float, float]:
    """The contact tolerance of a pair of bodies, and the diagonal of the smaller one (m)."""
    size = min(extents.diagonal(body.parts) for body in bodies)
    usual = tolerances.contact_large * size if tolerances.contact is None else tolerances.contact
    return max(of_parts.get(p.parts, usual) for _, p, _ in members), size

"""What became of everything that the function states, and what of the geometry is understood."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from kinform.consistency.comparisons.answers import answer_of
from kinform.consistency.comparisons.couplings import derived_ratio, derived_sum
from kinform.consistency.comparisons.ranges import range_comparisons
from kinform.consistency.context import Context
from kinform.consistency.control import Applied, means
from kinform.consistency.rule import Rule
from kinform.foundation.meshes.shells import shell_volumes, shells_of
from kinform.model.assembly import Mesh
from kinform.model.coverage import Coverage, Statement, StatementOutcome
from kinform.model.findings import NOT_SELECTED
from kinform.model.kinematics import Joint


def statements(context: Context, applied: Mapping[str, Applied]) -> tuple[Statement, ...]:
    """Joints, ranges, couplings, mobility, then requirements and limits, each in the order of the function."""
    every = (_joints, _ranges, _couplings, _mobilities, _requirements)
    return tuple(statement for made in every for statement in made(context, applied))


def _joints(context: Context, applied: Mapping[str, Applied]) -> Iterator[Statement]:
    lacking = context.lacks("comparisons")
    compared = {} if lacking else {c.intended.name: c for c in context.comparisons}
    skipped = _unselected(applied, "KF402")
    for joint in context.function.joints:
        if lacking is not None or compared[joint.name].state == "stated":
            given = lacking is None or lacking.kind == "skipped"
            yield Statement("joint", joint.name, "given" if given else "undecided", lacking.reason if lacking else "")
        elif skipped:
            yield Statement("joint", joint.name, "not checked", skipped)
        else:
            answer = answer_of(context, compared[joint.name])
            reason = compared[joint.name].reason if answer.answer == "undecided" else ""
            yield Statement("joint", joint.name, answer.answer, reason)


def _ranges(context: Context, applied: Mapping[str, Applied]) -> Iterator[Statement]:
    if not any(joint.range is not None for joint in context.function.joints):
        return
    short, skipped = _found_wrong(applied["KF412"]), _unselected(applied, "KF412")
    for item in range_comparisons(context):
        name, reason = item.intended.name, ""
        outcome: StatementOutcome = "met"
        if item.given:
            outcome = "given"
        elif skipped:
            outcome, reason = "not checked", skipped
        elif name in short:
            outcome = "violated"
        elif item.unknown:
            outcome, reason = "undecided", item.unknown
        yield Statement("range", name, outcome, reason)


def _couplings(context: Context, applied: Mapping[str, Applied]) -> Iterator[Statement]:
    other, skipped = {f.subject for f in applied["KF411"].judged.findings}, _unselected(applied, "KF411")
    lacking = context.lacks("kinematics")
    for coupling in context.function.couplings:
        name, reason = " ".join(coupling.every), ""
        outcome: StatementOutcome = "met"
        if not context.meshes:
            outcome = "given"
        elif skipped:
            outcome, reason = "not checked", skipped
        elif coupling.joints in other or coupling.every in other:
            outcome = "violated"
        else:
            derived = derived_sum if coupling.others else derived_ratio
            found = (
                lacking.reason
                if lacking
                else derived(context.assembly, context.kinematics, coupling, context.design.contacts)
            )
            outcome, reason = ("undecided", found) if isinstance(found, str) else ("met", "")
        yield Statement("coupling", name, outcome, reason)


def _mobilities(context: Context, applied: Mapping[str, Applied]) -> Iterator[Statement]:
    if context.function.mobility is not None:
        yield _of_rule(applied["KF301"], context.assembly.name)
    for part in context.assembly.subassemblies:
        if part.mobility is not None:
            yield _of_rule(applied["KF302"], part.name)


def _of_rule(applied: Applied, name: str) -> Statement:
    """What one rule says of a stated mobility."""
    judged = applied.judged
    if judged.kind == "skipped":
        return Statement("mobility", name, "not checked", judged.reason)
    if any(finding.subject[:1] == (name,) for finding in judged.findings):
        return Statement("mobility", name, "violated")
    if judged.kind == "inconclusive":
        return Statement("mobility", name, "undecided", judged.reason)
    return Statement("mobility", name, "met")


def _requirements(context: Context, applied: Mapping[str, Applied]) -> Iterator[Statement]:
    asleep = "nothing drives the joint" if context.simulation_requested else "no simulation requested"
    for wanted in context.function.requirements:
        answer = context.answers.get(wanted)
        outcome: StatementOutcome = "not checked"
        reason = asleep if wanted in context.dormant else NOT_SELECTED
        if answer is not None:
            outcome, reason = answer.state, answer.message if answer.state == "undecided" else ""
        yield Statement("limit" if wanted.when_run else "requirement", wanted.name, outcome, reason, wanted.kind)


def coverage(context: Context, applied: Mapping[str, Applied], rules: Sequence[Rule]) -> Coverage:
    """What is understood of contacts and joints, what is open, and which rules `[check.severity]` makes notes."""
    kinematics, contacts = context.design.kinematics, context.design.contacts
    joints = () if kinematics is None else kinematics.joints
    touching: dict[frozenset[str], bool] = {}
    for patch in () if contacts is None else contacts.patches:
        pair = frozenset(map(str, patch.parts))
        touching[pair] = touching.get(pair, False) or not patch.unknown
    for overlap in () if contacts is None else contacts.interferences:
        touching.setdefault(frozenset(map(str, overlap.parts)), False)
    accepted = {
        code: {n for item in applied[code].ignored for n in item.finding.subject} for code in ("KF107", "KF901")
    }
    open_ = [str(j.name) for j in joints if _doubtful(j) and tuple(sorted(j.bodies)) not in context.intended_pairs]
    levels = {
        rule.code: level for word, level in context.assembly.check.severity for rule in rules if means(rule, word)
    }
    return Coverage(
        stated=context.function.stated,
        joints=len(joints),
        joints_understood=sum(not _doubtful(joint) for joint in joints),
        contacts=len(touching),
        contacts_understood=sum(touching.values()),
        interpretations=tuple(name for name in open_ if name not in accepted["KF901"]),
        several=tuple(
            str(name)
            for use in context.meshes
            if use.mesh.health.shells > 1 and not accepted["KF107"].issuperset(use.subject) and _solids(use.mesh) > 1
            for name in use.subject
        ),
        fused=() if kinematics is None else tuple(pair for body in kinematics.bodies for pair in body.turning),
        lowered=tuple(rule.code for rule in rules if levels.get(rule.code) == "note" and rule.severity != "note"),
    )


def _found_wrong(applied: Applied) -> set[str]:
    """What findings of more than a note are about, by the first name of each."""
    return {f.subject[0] for f in applied.judged.findings if f.subject and f.severity != "note"}


def _unselected(applied: Mapping[str, Applied], code: str) -> str:
    """Why a rule did not look, where `[check] select` leaves it out; else empty."""
    judged = applied[code].judged
    return judged.reason if judged.kind == "skipped" and judged.reason == NOT_SELECTED else ""


def _doubtful(joint: Joint) -> bool:
    """Whether contact leaves undecided what the joint is."""
    return joint.status == "ambiguous" or any(reading.cause == "doubt" for reading in joint.readings)


def _solids(mesh: Mesh) -> int:
    """How many shells are no cavities; all of an open mesh, which has no inside."""
    if not (mesh.health.watertight and mesh.health.consistent_winding):
        return mesh.health.shells
    return int((shell_volumes(mesh.vertices, mesh.faces, shells_of(mesh.vertices, mesh.faces)) > 0.0).sum())

"""The rules of requirements: one for each kind, which reports what is violated; KF902 reports what is undecided.

What a kind asks for and how it is answered is in `kinform.requirements`.
"""

from __future__ import annotations

from collections.abc import Callable

from kinform.consistency.context import Context
from kinform.consistency.evidence import DesignEvidence
from kinform.consistency.outcome import Outcome, decided, skipped
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted
from kinform.frozen import dataclass
from kinform.model.function import Requirement
from kinform.requirements import kind_of
from kinform.requirements.answer import Answer, undecided


@dataclass(frozen=True, kw_only=True)
class RequirementRule(Rule):
    """The rule of one kind of requirement, with what answers them."""

    kind: str
    judge: Callable[[Context, Requirement], Answer]


def answer(context: Context, requirement: Requirement) -> Answer:
    """What became of a requirement: undecided where a stage that its kind needs has not run."""
    kind, evidence = kind_of(requirement.kind), DesignEvidence(context)
    for stage, remedy in kind.needs.items():
        lacking = evidence.lacking(stage)
        if lacking is not None:
            return undecided(lacking, remedy)
    return kind.judge(evidence, kind.record.read(requirement.values))


def requirement_rule(code: str, name: str, kind: str, documentation: str | None) -> RequirementRule:
    """The rule of one kind of requirement: an error for each that is violated."""

    def check(context: Context) -> Outcome:
        answers = {r: answer for r, answer in context.answers.items() if r.kind == kind}
        if not answers:
            asleep = sum(r.kind == kind for r in context.dormant)
            quiet = f"{counted(asleep, 'limit')} of joints not checked: nothing drives them in a simulation"
            return skipped(quiet if asleep else "the function states no requirement of this kind")
        if all(answer.state == "undecided" for answer in answers.values()):
            return skipped(f"{counted(len(answers), 'requirement')} could not be decided: see KF902")
        findings = [
            rule.finding(
                [requirement.name],
                f"requirement '{requirement.name}' ({kind}): {answer.message}",
                found=answer.found,
                intended=answer.intended,
                place=answer.place,
                declared=requirement,
                remedy=answer.remedy,
                witness=answer.witness,
            )
            for requirement, answer in answers.items()
            if answer.state == "violated"
        ]
        return decided(findings, "; ".join(f"'{r.name}': {a.message}" for r, a in answers.items() if a.state == "met"))

    rule = RequirementRule(code, name, "error", documentation, check, kind=kind, judge=answer)
    return rule

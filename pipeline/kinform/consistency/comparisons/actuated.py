"""Whether something that acts on one freedom of a joint finds that freedom."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, settled
from kinform.consistency.rule import Declared, Rule
from kinform.foundation.words import counted, quoted
from kinform.function import FREEDOMS, acted_freedom, resolve_joint
from kinform.model.findings import Witness, computed, stated


def _single_freedom(context: Context, name: str, freedom: str) -> tuple[str, str]:
    """("", "") when a freedom of the joint of this name is meant; else ("absent" or "unknown", why)."""
    resolution = resolve_joint(context.assembly, context.kinematics, name)
    joint, carried = resolution.joint, loose_carriers(context, name) or _afloat(context, name)
    if joint is None:
        return ("unknown", carried) if carried else ("absent", resolution.reason)
    if joint.status == "ambiguous":
        return "unknown", f"joint '{joint.name}' is ambiguous: {joint.reason}"
    meant = acted_freedom(context.assembly, context.kinematics, name, freedom)
    if meant.freedom is not None:
        return "", ""
    why = f"joint '{joint.name}' is {joint.type}, with {counted(joint.freedoms, 'freedom')}"
    alone = resolution.intended is not None and len(FREEDOMS.get(resolution.intended.type, ())) == 1
    if joint.type in FREEDOMS and (freedom or not alone):
        why = meant.reason
    if joint.type == "general" and joint.freedoms > 0:
        return "unknown", why
    return ("unknown", carried) if carried else ("absent", why)


class Acting(Declared, Protocol):
    """Something in the manifest that acts on a joint."""

    @property
    def joint(self) -> str: ...

    @property
    def freedom(self) -> str: ...


def without_freedom(
    context: Context, rule: Rule, acting: Sequence[Acting], words: Callable[[Any], str], remedy: str
) -> Outcome:
    """A finding for each that acts on a joint of which it is not clear which freedom is meant; `words`: what acts."""
    findings, unknown = [], []
    for item in acting:
        state, reason = _single_freedom(context, item.joint, item.freedom)
        if state == "unknown":
            unknown.append(reason)
        elif state == "absent":
            findings.append(
                rule.finding(
                    [item.joint],
                    f"the {words(item)} '{item.joint}' has no freedom to act on: {reason}",
                    found=reason,
                    intended="one freedom of the joint",
                    declared=item,
                    remedy=remedy,
                    witness=_witness(context, item),
                )
            )
    return settled(findings, "; ".join(dict.fromkeys(unknown)))


def _witness(context: Context, item: Acting) -> Witness | None:
    """How many freedoms the joint has; of one that is not there, that the manifest names it."""
    joint = resolve_joint(context.assembly, context.kinematics, item.joint).joint
    if joint is None or len(joint.twists) == 1:
        return stated(item, item.joint)
    return computed("freedoms of twists", abs(len(joint.twists) - 1), 0.0, twists=joint.twists)


def _afloat(context: Context, name: str) -> str:
    """That the joint of this name may be carried by a part with play; else ""."""
    every = () if context.lacks("comparisons") else context.comparisons
    return next((f"joint '{name}': {c.afloat}" for c in every if c.intended.name == name and c.afloat), "")


def loose_carriers(context: Context, name: str) -> str:
    """Where the freedom of a stated joint is carried by loose parts, it exists but nothing can act on it yet: why;
    else ""."""
    for comparison in () if context.lacks("comparisons") else context.comparisons:
        if comparison.intended.name == name and comparison.through and comparison.right_type:
            parts = quoted(comparison.through)
            return (
                f"joint '{name}' is carried by loose parts between its bodies, beside or through {parts}: fasten what "
                "is loose to one of them with a [[group]]"
            )
    return ""

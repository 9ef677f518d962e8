"""Whether something that acts on one freedom of a joint finds that freedom."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

from kinform.consistency.context import Context
from kinform.consistency.rule import Declared, Outcome, Rule, decided, inconclusive
from kinform.foundation.words import counted, quoted
from kinform.function import resolve
from kinform.model.kinematics import Kinematics

__all__ = ["actuated", "loose", "without_freedom"]

DRIVEN = ("revolute", "prismatic", "screw")
"""Joints with one freedom, on which a single value acts."""


def actuated(context: Context, kinematics: Kinematics, name: str) -> tuple[str, str]:
    """("", "") when the joint of this name has exactly one freedom; else ("absent" or "unknown", why)."""
    resolution = resolve(context.assembly, kinematics, name)
    joint = resolution.joint
    if joint is None:
        return _unknown(loose(context, name)) or ("absent", resolution.reason)
    if joint.status == "ambiguous":
        return "unknown", f"joint '{joint.name}' is ambiguous: {joint.reason}"
    if joint.type in DRIVEN:
        return "", ""
    if joint.type == "general" and joint.freedoms > 0:
        return "unknown", f"joint '{joint.name}' is general, with {counted(joint.freedoms, 'freedom')}"
    short = ("absent", f"joint '{joint.name}' is {joint.type}, with {counted(joint.freedoms, 'freedom')}")
    return _unknown(loose(context, name)) or short


class Acting(Declared, Protocol):
    """Something in the manifest that acts on a joint."""

    @property
    def joint(self) -> str: ...


def without_freedom(
    context: Context, rule: Rule, acting: Sequence[Acting], told: Callable[[Any], str], remedy: str
) -> Outcome:
    """A finding for each that acts on a joint which has not exactly one freedom; `told` says what acts."""
    kinematics = context.kinematics
    if isinstance(kinematics, Outcome):
        return kinematics
    findings, unknown = [], []
    for item in acting:
        state, reason = actuated(context, kinematics, item.joint)
        if state == "unknown":
            unknown.append(reason)
        elif state == "absent":
            findings.append(
                rule.finding(
                    [item.joint],
                    f"the {told(item)} '{item.joint}' has no freedom to act on: {reason}",
                    found=reason,
                    intended="a joint with one freedom",
                    declared=item,
                    remedy=remedy,
                )
            )
    return inconclusive("; ".join(dict.fromkeys(unknown)), findings) if unknown else decided(findings)


def _unknown(reason: str) -> tuple[str, str] | None:
    return ("unknown", reason) if reason else None


def loose(context: Context, name: str) -> str:
    """Where the freedom of a stated joint is carried by loose parts, it exists but nothing can act on it yet: why; else ""."""
    compared = context.comparisons
    if not isinstance(compared, tuple):
        return ""
    for comparison in compared:
        if comparison.intended.name == name and comparison.through and comparison.right_type:
            parts = quoted(comparison.through)
            return (
                f"joint '{name}' is carried by loose parts between its bodies, beside or through {parts}: fasten what is "
                "loose to one of them with a [[group]]"
            )
    return ""

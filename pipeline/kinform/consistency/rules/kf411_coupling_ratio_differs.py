"""Two joints are coupled in another ratio than intended.

Where teeth keep a constant ratio (`kinform show F.h5 mobility` counts them) it is that of their numbers; else the
ratio is read out of the motions that all contacts leave, at the pose of the meshes. A finding when it differs by more
than 0.1 % where teeth are counted, 1 % where they are not, 0.1 % a screw, or its uncertainty. Three joints and more
are held against the motions at the pose of the meshes: a finding above 5 % of the greatest term. Couplings that
nothing could be derived for are KF903.

Why it matters: the driven side turns by another angle than is meant, or the other way.

What to do: correct the numbers of teeth or the pitch, or `ratio` in `[[function.coupling]]`; mind the signs, which are
those of the axes of the intended joints.

Example: `ratio = -2.5` where gears of 20 and 48 teeth give −2.4.
"""

from __future__ import annotations

from kinform.consistency.comparisons.as_written import ratio_as_written
from kinform.consistency.comparisons.couplings import (
    UNCERTAIN_RATIO,
    Difference,
    derived_ratio,
    derived_sum,
    shown_ratio,
)
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, skipped
from kinform.consistency.rule import Rule
from kinform.foundation.words import quoted
from kinform.model.findings import Finding
from kinform.model.function import Coupling


def check(context: Context) -> Outcome:
    """Every coupling that can be derived."""
    findings, count = [], 0
    for coupling in context.function.couplings:
        if coupling.others:
            sums = derived_sum(context.assembly, context.kinematics, coupling, context.design.contacts)
            if not isinstance(sums, str):
                count += 1
                findings += [_of_sum(context, coupling, sums)] if sums.share > UNCERTAIN_RATIO else []
            continue
        derived = derived_ratio(context.assembly, context.kinematics, coupling, context.design.contacts)
        if isinstance(derived, str):
            continue
        count += 1
        if abs(derived.value - coupling.ratio) > derived.allowed:
            has, wanted = (shown_ratio(context.assembly, coupling, ratio) for ratio in (derived.value, coupling.ratio))
            findings.append(
                RULE.finding(
                    coupling.joints,
                    f"{quoted(coupling.joints)} are coupled with the {has} through {quoted(derived.through)}, "
                    f"intended is {wanted}",
                    found=has,
                    intended=wanted,
                    declared=coupling,
                    remedy="Correct the teeth or the pitch, or the ratio, the value of the first for one of the second"
                    f"{ratio_as_written(context, coupling, derived.value) or '; mind the sign'}.",
                )
            )
    return decided(findings) if count else skipped("no coupling can be compared")


def _of_sum(context: Context, coupling: Coupling, sums: Difference) -> Finding:
    """Of three joints and more."""
    has, wanted = f"{sums.found:.4g}", f"{sums.meant:.4g}"
    return RULE.finding(
        coupling.every,
        f"{quoted(coupling.every)} do not move in the {shown_ratio(context.assembly, coupling, coupling.ratio)}: "
        f"at this pose '{coupling.joints[0]}' moves by {has} where the others ask for {wanted} (rad/s or m/s), through "
        f"{quoted(sums.through)}",
        found=has,
        intended=wanted,
        declared=coupling,
        remedy="Correct the teeth, or `ratio`: value of the first for one of each other; mind the signs.",
    )


RULE = Rule("KF411", "coupling-ratio-differs", "error", __doc__, check, needs=("stated couplings", "kinematics"))

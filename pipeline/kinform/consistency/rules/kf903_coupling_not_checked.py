"""The function states a coupling of joints for which geometry gives no ratio.

No teeth, rack or screw that touch are found between bodies with joints of one freedom, or what ties them is a cam, or
uncertain. The rule is inconclusive as long as there is one. Where no part has a mesh, a coupling is given and counts as
a constraint: the rule does not apply.

Why it matters: whether the geometry couples these joints in this ratio is not known.

What to do: bring teeth into contact at the pose of the meshes (a gap of a few hundredths of a millimetre counts), give
both sides a joint with a common body, or check the ratio by other means.

Example: `ratio = -2.5` between two shafts whose gears are drawn as plain discs.
"""

from __future__ import annotations

from kinform.consistency.comparisons.couplings import derived_ratio, derived_sum, shown_ratio
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, settled, skipped
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted, quoted


def check(context: Context) -> Outcome:
    """Every coupling."""
    couplings = context.function.couplings
    if not context.meshes:
        return skipped(
            f"no part has a mesh: {counted(len(couplings), 'coupling')} given by the function, nothing to compare"
        )
    lacking = context.lacks("kinematics")
    if lacking is not None:
        return lacking
    known = context.assembly, context.kinematics
    findings = [
        RULE.finding(
            coupling.every,
            f"the coupling of {quoted(coupling.every)} is not checked: {reason}",
            found="not checked",
            intended=shown_ratio(context.assembly, coupling, coupling.ratio),
            declared=coupling,
            remedy="Bring the teeth into contact at this pose, or check the ratio by other means.",
        )
        for coupling in couplings
        if isinstance(
            reason := (derived_sum if coupling.others else derived_ratio)(*known, coupling, context.design.contacts),
            str,
        )
    ]
    return settled(findings, f"{counted(len(findings), 'coupling')} not checked" if findings else "")


RULE = Rule("KF903", "coupling-not-checked", "note", __doc__, check, needs=("stated couplings",), speaks_for=("KF411",))

"""A sub-assembly, taken alone, has more or fewer freedoms than its manifest states.

Why it matters: a sub-assembly that is reused, such as a motor, must move inside every design as it does
on its own. Contacts with the surrounding parts are left out. Idle freedoms, of pins and screws that only spin, may be
counted or not, as in KF301. Inconclusive as in KF301.

What to do: check the sub-assembly on its own with `kinform run`; correct it, or its `mobility`.

Example: a motor with `mobility = 1` whose rotor is fused to its stator by a wrong `[[group]]`.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, settled
from kinform.consistency.questions.subassembly_mobility import inner_mobility
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted, quoted


def check(context: Context) -> Outcome:
    """Stated against derived mobility of each sub-assembly."""
    stated = [s for s in context.assembly.subassemblies if s.mobility is not None]
    kinematics = context.kinematics
    findings, unknown = [], []
    for sub in stated:
        parts = tuple(p.name for p in context.assembly.parts if p.name.startswith(f"{sub.name}/"))
        bodies = {kinematics.body_of(part).name for part in parts}
        inside = [j for j in kinematics.joints if bodies.issuperset(j.bodies)]
        ambiguous = any(joint.status == "ambiguous" for joint in inside)
        found = None if ambiguous else inner_mobility(context.design, parts)
        if found is None or sub.mobility is None:
            unknown.append(sub.name)
            continue
        spins = sub.mobility - found.effective
        low, high = found.ends
        if spins and (low < sub.mobility < high or low - found.passive <= sub.mobility < low):
            unknown.append(sub.name)
            continue
        if spins < 0 and context.design.contacts is not None and context.with_play(parts) is not None:
            unknown.append(sub.name)
            continue
        if spins and sub.mobility not in found.ends and not (0 < spins <= found.idle and not found.still):
            idle = f" ({counted(found.idle, 'idle freedom')} not counted)" if found.idle else ""
            findings.append(
                RULE.finding(
                    [sub.name],
                    f"the sub-assembly {quoted([sub.name])} has {counted(found.effective, 'freedom')} of its own, "
                    f"intended are {sub.mobility}{idle}",
                    found=str(found.effective),
                    intended=str(sub.mobility),
                    declared=sub.source,
                    remedy="Check the sub-assembly on its own; correct its joints, or its `mobility`.",
                )
            )
    doubts = "joints inside are ambiguous, contact only pushes, parts have play, or a rank is on the edge"
    return settled(findings, f"{doubts}: {quoted(unknown)}" if unknown else "")


RULE = Rule(
    "KF302",
    "subassembly-mobility-differs",
    "error",
    __doc__,
    check,
    needs=("stated mobility of sub-assemblies", "kinematics"),
)

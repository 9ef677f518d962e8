"""Joints give at first order, and then lock: a freedom that is no motion.

Velocities pass all constraints of a loop, but no step along them closes it again: the structure is shaky, as
two bars in line between two walls. `finite` and `effective` mobility do not count such freedoms. Each loop is
tried by finite steps, and by the curvature of its closure as an independent test. Inconclusive where a function
states a mobility and some loop could not be tried, because a joint in it is ambiguous or known by its velocities
only. Where contact that only pushes decides whether the loop is shaky, a note says so; the rule is inconclusive then
if the stated mobility is between what all contact leaves and what is left without that contact (KF301).

Why it matters: the structure is soft in this direction, small play or wear becomes a large movement, and forces
along it grow without bound. An analysis of velocities alone calls it a mechanism.

What to do: if it shall move, free a joint of the loop. If it shall be rigid, move a joint off the line or plane in
which they meet.

Example: a strut of two hinged bars in line, with a hinge at each end, gives sideways at the middle.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, inconclusive, settled
from kinform.consistency.questions.both_ends import BY_PUSHING, doubt_of_ends
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted, quoted
from kinform.model.findings import Finding
from kinform.model.kinematics import FiniteCertificate


def check(context: Context) -> Outcome:
    """Freedoms that exist at first order only, block by block."""
    mobility, stated = context.kinematics.mobility, context.function.mobility
    shaky = [certificate for certificate in mobility.certificates if certificate.infinitesimal]
    findings = [_finding(context, certificate) for certificate in shaky]
    reason = "" if findings else mobility.finite_reason
    if stated is not None and mobility.finite is None:
        return inconclusive(mobility.finite_reason, findings)
    return settled(findings, doubt_of_ends(context, shaky), reason)


def _finding(context: Context, certificate: FiniteCertificate) -> Finding:
    verb = "is" if certificate.infinitesimal == 1 else "are"
    return (RULE if certificate.at_ends else RULE.at("note")).finding(
        certificate.moves,
        f"{quoted(certificate.moves)} give at first order and then lock: "
        f"{counted(certificate.infinitesimal, 'freedom')} of this loop {verb} only infinitesimal"
        + ("" if certificate.at_ends else f"; {BY_PUSHING}"),
        found=f"finite mobility {certificate.finite} of {certificate.instantaneous}",
        intended="freedoms that lead over a distance",
        declared=context.assembly.source,
        remedy="Free a joint of the loop if it shall move; else move a joint out of line with the others.",
    )


RULE = Rule("KF305", "mobility-infinitesimal", "warning", __doc__, check, needs=("kinematics",), also=("note",))

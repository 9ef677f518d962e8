"""Joints give at first order, and then lock: a freedom that is no motion.

Velocities pass all constraints of a loop, but no step along them closes it again: the structure is shaky, as
two bars in line between two walls. `finite` and `effective` mobility do not count such freedoms. Each loop is
tried by finite steps, and by the curvature of its closure as an independent test. Inconclusive where a function
states a mobility and some loop could not be tried, because a joint in it is ambiguous or known by its velocities
only.

Why it matters: the structure is soft in this direction, small play or wear becomes a large movement, and forces
along it grow without bound. An analysis of velocities alone calls it a mechanism.

What to do: if it shall move, free a joint of the loop. If it shall be rigid, move a joint off the line or plane in
which they meet.

Example: a strut of two hinged bars in line, with a hinge at each end, gives sideways at the middle.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, inconclusive
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted, quoted


def check(context: Context) -> Outcome:
    """Freedoms that exist at first order only, block by block."""
    mobility = context.kinematics.mobility
    findings = [
        RULE.finding(
            certificate.moves,
            f"{quoted(certificate.moves)} give at first order and then lock: "
            f"{counted(certificate.infinitesimal, 'freedom')} of this loop "
            f"{'is' if certificate.infinitesimal == 1 else 'are'} only infinitesimal",
            found=f"finite mobility {certificate.finite} of {certificate.instantaneous}",
            intended="freedoms that lead over a distance",
            declared=context.assembly.source,
            remedy="Free a joint of the loop if it shall move; else move a joint out of line with the others.",
        )
        for certificate in mobility.certificates
        if certificate.infinitesimal
    ]
    doubtful = mobility.finite is None and context.function.mobility is not None
    reason = "" if findings else mobility.finite_reason
    return inconclusive(mobility.finite_reason, findings) if doubtful else decided(findings, reason)


RULE = Rule("KF305", "mobility-infinitesimal", "warning", __doc__, check, needs=("kinematics",))

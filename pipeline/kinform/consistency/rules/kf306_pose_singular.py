"""The pose in which the parts are drawn is singular: it has more freedoms than the poses beside it.

Where several motions lead out of the pose, it is a bifurcation, and which of them the device follows is left to
chance. Found by finite steps in all directions of the freedoms, see KF305, also for contact that only pushes.

Why it matters: the mobility at this pose is not that of the device in use, drives lose their hold here, and a
simulation that starts here, or passes, cannot know how to go on.

What to do: draw the assembly in another pose. If the device passes this one in use, guide it: by an end stop
before it, or by a second crank out of phase.

Example: a parallelogram of four bars that lie in one line may go on as a parallelogram, or crossed.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, settled
from kinform.consistency.questions.both_ends import BY_PUSHING, doubt_of_ends
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted, listed, quoted
from kinform.model.findings import Finding
from kinform.model.kinematics import FiniteCertificate


def check(context: Context) -> Outcome:
    """Blocks whose pose has more freedoms than the branches that lead out of it."""
    singular = [certificate for certificate in context.kinematics.mobility.certificates if certificate.singular]
    return settled([_finding(context, certificate) for certificate in singular], doubt_of_ends(context, singular))


def _finding(context: Context, certificate: FiniteCertificate) -> Finding:
    ways = certificate.branches
    branches = (
        f"{len(ways)} branches ({listed([str(way) for way in ways])} freedoms) were found that lead out of it"
        if len(ways) > 1
        else f"beside it {ways[0]}"
    )
    return (RULE if certificate.at_ends else RULE.at("note")).finding(
        certificate.joints,
        f"{quoted(certificate.joints)} have {counted(certificate.instantaneous or 0, 'freedom')} in this pose, "
        + branches
        + ("" if certificate.at_ends else f"; {BY_PUSHING}"),
        found="bifurcation" if len(ways) > 1 else "singular pose",
        intended="a regular pose",
        declared=context.assembly.source,
        remedy="Draw the assembly in another pose; guide the device where it passes this one.",
    )


RULE = Rule("KF306", "pose-singular", "warning", __doc__, check, needs=("kinematics",), also=("note",))

"""A robot description leaves a link free, and contact with another link holds it.

A link on a floating joint, or on no joint at all (a body with a free joint, a link of an SDF that nothing names), may
move in every way. Contact that opens as the link is lifted off is as it should be: a cube on a table. What is found
here is contact that no motion opens everywhere at once, as of a shaft in its bore. In a URDF, which has to say
`floating`, it is an error; elsewhere, where a loose thing may be drawn in its holder, a warning. Links that a loop, a
`[[group]]` or an `[[assume]]` connects are not free of each other.

Why it matters: a simulator lets the link fall, or throws it out of the bore; and the mobility that is counted is not
that of the mechanism.

What to do: state the joint that is there; or give the two a gap, if the link is to be free.

Example: a wheel on its axle, whose joint is `floating` where `continuous` was meant.
"""

from __future__ import annotations

from kinform.consistency.comparisons.free_links import HeldLink, held_links
from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.model.assembly import Source
from kinform.model.findings import Finding


def check(context: Context) -> Findings:
    """Links of descriptions that no joint connects, and that touch."""
    return map(_finding, held_links(context))


def _finding(held: HeldLink) -> Finding:
    stated = held.description.format == "urdf"
    joint = "on a floating joint" if stated else "on no joint, or a free one"
    return RULE.at("error" if stated else "warning").finding(
        [held.link.name, held.other.name],
        f"link '{held.link.name}' is {joint}, so free of '{held.other.name}', and their contact holds it",
        found=held.words,
        intended="free",
        place=held.place,
        declared=Source(held.link.file, held.link.line),
        remedy="State the joint that is there, or give the two a gap.",
    )


RULE = Rule(
    "KF417",
    "link-not-free",
    "error",
    __doc__,
    check,
    needs=("descriptions", "contacts", "kinematics"),
    also=("warning",),
)

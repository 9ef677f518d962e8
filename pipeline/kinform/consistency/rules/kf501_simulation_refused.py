"""The simulation that was asked for, or a part of it, cannot be run.

The rule is then inconclusive: what depends on motion or forces is not verified. Joints that are
ambiguous, general or missing, bodies without mass, and elements that are not supported yet are the usual
reasons; where one of them is a mistake of the design, another rule reports it as such.

Why it matters: a run that did not happen proves nothing.

What to do: remove the cause that is given, or ask for a lower `level`. With `partial = true` in `[simulation]` joints
that are not understood are held and named, and the rest moves; what that shows is not verified, so this rule and all
that read the motion stay inconclusive.

Example: `level = "dynamic"` for an arm of which one joint came out ambiguous.
"""

from __future__ import annotations

from collections.abc import Sequence

from kinform.consistency.comparisons.actuated import loose_carriers
from kinform.consistency.comparisons.near import nearly_moves
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, inconclusive
from kinform.consistency.rule import Declared, Rule
from kinform.foundation.words import quoted
from kinform.function import resolve_joint
from kinform.model.findings import Finding

SPEAKS_FOR = ("KF413", "KF502", "KF503", "KF504", "KF505", "KF506", "KF507")
GROUP = "Fasten what is loose, such as a pin, to one of the two parts with a [[group]]."


def check(context: Context) -> Outcome:
    """Refusals, of the whole simulation or of single elements."""
    simulation = context.attempt
    if simulation.status != "refused" and not simulation.failures:
        return decided()
    failures = simulation.failures or ((context.assembly.name, simulation.reason),)
    findings = [_finding(context, subject, reason) for subject, reason in failures]
    reasons = "; ".join(f"{subject}: {reason}" for subject, reason in failures)
    return inconclusive(simulation.reason or reasons, findings)


def _finding(context: Context, subject: str, reason: str) -> Finding:
    names = _joints_in(context, subject)
    request = context.assembly.simulation
    asked = request if request is not None and request.file is not None else None
    level = request.level if request is not None else None
    carried = next(filter(None, (loose_carriers(context, name) for name in names)), "")
    near = nearly_moves(context) if "loops cannot move" in reason and not context.lacks("kinematics") else ""
    why = "; ".join(filter(None, (reason, carried, near)))
    return RULE.finding(
        names,
        f"{quoted(names)} {'is' if len(names) == 1 else 'are'} not simulated: {why}",
        found="not simulated",
        intended=f"a {level} simulation" if level else "a simulation",
        declared=_declaring(context, subject, names) or asked or context.assembly.source,
        remedy=GROUP if carried else _remedy(context, subject),
    )


def _remedy(context: Context, subject: str) -> str:
    usual = "Remove the cause, or ask for a lower `level`."
    joint = context.joint(subject)
    if context.attempt.partial or joint is None or not (joint.type == "general" or joint.status == "ambiguous"):
        return usual
    return f"{usual[:-1]}; `partial = true` in [simulation] holds what is not understood and moves the rest."


def _joints_in(context: Context, subject: str) -> list[str]:
    """The joints that a subject lists, else the subject itself."""
    names = subject.split(", ")
    return names if all(context.joint(name) is not None for name in names) else [subject]


def _declaring(context: Context, subject: str, names: Sequence[str]) -> Declared | None:
    """What in the manifest acts on the subject: a drive, a coupling, a load, or an initial value."""
    function = context.function
    if context.lacks("kinematics"):
        return None

    def stands_for(stated: str) -> bool:
        joint = resolve_joint(context.assembly, context.kinematics, stated).joint
        return stated in names or (joint is not None and joint.name in names)

    request = context.assembly.simulation
    acting: list[tuple[bool, Declared]] = [(stands_for(drive.joint), drive) for drive in function.drives]
    acting += [(subject == "coupling of " + " and ".join(c.joints), c) for c in function.couplings]
    acting += [(load.part == subject, load) for load in function.loads]
    acting += [(spring.name == subject, spring) for spring in function.springs]
    acting += [(stands_for(value.joint), value) for value in (request.initial if request is not None else ())]
    return next((item for matches, item in acting if matches), None)


RULE = Rule("KF501", "simulation-refused", "note", __doc__, check, needs=("attempt",), speaks_for=SPEAKS_FOR)

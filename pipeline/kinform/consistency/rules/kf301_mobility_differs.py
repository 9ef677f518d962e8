"""The assembly has more or fewer freedoms than `function.mobility` states.

Compared with the *effective* mobility: independent motions of the whole assembly relative to ground,
without idle freedoms (KF304: a pin that only spins), and without freedoms that lead nowhere over a distance (KF305,
KF306), where that is known. A number that counts some or all of the idle freedoms is right, too, as long as every
intended joint that is to move can: the outcome says which it counts. Blocked joints count by their type. Inconclusive
when a joint is ambiguous, and where a body that no joint connects with ground overlaps with the rest: it would count as
free, and what is drawn there may hold it. So it is where there are too many freedoms, or bodies that nothing holds, and
a part has play between two bodies (KF203): it may hold them; and where all that is too many are turns of couplers about
the line of their ball joints, which textbooks leave out, or turns of bodies whose meshes are too rough to tell whether
they are seen.

Why it matters: one freedom too few and the mechanism jams; one too many and something moves that no
drive holds.

What to do: `kinform show F.h5 mobility` lists the freedoms and what moves in each. Findings on single
joints (KF203, KF204, KF401, KF402) are usually the cause: begin there. Where a freedom is missing because one joint of
the loops is a little out of place, the joints are named any one of which would only have to be corrected, and by how
much: a redundant loop, as that of three parallel cranks, bears no such error.

Example: a gimbal that shall turn about two axes has three freedoms, because the pitch shaft has no shoulder.
"""

from __future__ import annotations

from kinform.consistency.comparisons.near import nearly_moves, out_of_place
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, inconclusive
from kinform.consistency.questions.immobile_joints import immobile_joints
from kinform.consistency.questions.passive_turns import passive_turns
from kinform.consistency.questions.rough_turns import rough_turns
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted, quoted
from kinform.kinematics import disconnected_bodies, disconnected_in_words
from kinform.model.assembly import Source
from kinform.model.kinematics import Kinematics, Mobility


def check(context: Context) -> Outcome:
    """Stated against effective mobility."""
    intended, kinematics = context.function.mobility or 0, context.kinematics
    ambiguous = [joint.name for joint in kinematics.joints if joint.status == "ambiguous"]
    if ambiguous:
        return inconclusive(f"the mobility depends on joints that are ambiguous: {quoted(ambiguous)}")
    contacts = context.design.contacts  # sticks have none
    if contacts is not None and (loose := disconnected_bodies(kinematics, contacts)):
        return inconclusive(disconnected_in_words(loose))
    mobility = kinematics.mobility
    if mobility.on_edge:
        return inconclusive(mobility.finite_reason)
    adrift_bodies = any(freedom.driver is None for freedom in mobility.named)
    spins = intended - mobility.effective  # idle freedoms that the stated number counts, if it is right
    if contacts is not None and (spins < 0 or (spins <= mobility.idle and adrift_bodies)):
        afloat = context.with_play()
        if afloat is not None:
            return inconclusive(f"the counts take for free what may not be: {afloat.words()}")
    if spins == 0:
        return decided(reason=f"{counted(intended, 'freedom')}, as intended{_details(kinematics)}")
    low, high = mobility.ends
    if spins != 0 and intended in (low, high):
        which = "all contact holds as it is drawn" if intended == low else "contact that only pushes is left out"
        return decided(reason=f"{counted(intended, 'freedom')}, as intended, where {which} ({_ends(mobility)})")
    near = nearly_moves(context) if spins > 0 else ""
    still = immobile_joints(context.assembly, kinematics) if 0 < spins <= mobility.idle else ()
    if 0 < spins <= mobility.idle and not near and not still:
        return decided(reason=f"{counted(intended, 'freedom')}, as intended: {_with_idle(kinematics, spins)}")
    if low < intended < high:
        return inconclusive(f"{_ends(mobility)}: which contact holds while it moves is not known")
    passive = passive_turns(kinematics.bodies, kinematics.joints, mobility.idle_bodies)
    if not near and low - len(passive) <= intended < low:
        return inconclusive(
            f"{quoted(passive)} {'turns' if len(passive) == 1 else 'turn'} about the line of the ball joints, and "
            f"{'moves' if len(passive) == 1 else 'move'} nothing else: the {mobility.effective} freedoms count that"
        )
    missing = low - intended - len(passive)
    rough = rough_turns(context.assembly, kinematics, missing) if missing > 0 and not near else ()
    if 0 < missing <= len(rough):
        return inconclusive(f"whether anybody sees {quoted(rough)} turn on itself is not known: its mesh is too rough")
    whole, line = context.assembly.source, context.function.mobility_line
    usual = "See the freedoms with `kinform show F.h5 mobility`; correct the joints, or `mobility`."
    finding = RULE.finding(
        (context.assembly.name,),
        f"the assembly has {counted(mobility.effective, 'freedom')}, intended are {intended}{_details(kinematics)}"
        + (f"; nothing moves {quoted(still)}" if still else "")
        + (f": {near}" if near else ""),
        found=str(mobility.effective),
        intended=str(intended),
        declared=Source(whole.file, whole.line if line is None else line),
        remedy=f"Correct the joint that is out of place: {out_of_place(context)}. `kinform show F.h5 findings` says "
        "by how much."
        if near
        else usual,
    )
    return decided([finding])


def _ends(mobility: Mobility) -> str:
    """Both ends of the mobility."""
    low, high = mobility.ends
    return f"{low} with all contact kept, {high} without contact that only pushes"


def _with_idle(kinematics: Kinematics, spins: int) -> str:
    """How a stated number comes about that counts so many of the idle freedoms."""
    mobility = kinematics.mobility
    which = f"all {mobility.idle}" if spins == mobility.idle else f"{spins} of {mobility.idle}"
    noun = "freedom" if mobility.idle == 1 else "freedoms"
    which = "the" if spins == mobility.idle == 1 else which
    return f"{mobility.effective} effective and {which} idle {noun} of {quoted(mobility.idle_bodies)}"


def _details(kinematics: Kinematics) -> str:
    mobility = kinematics.mobility
    notes = []
    if mobility.idle:
        notes.append(f"{counted(mobility.idle, 'idle freedom')} not counted")
    if mobility.blocked != mobility.instantaneous:
        notes.append(f"{mobility.blocked} of {mobility.instantaneous} left when blockers hold")
    if mobility.infinitesimal:
        notes.append(f"{mobility.infinitesimal} only infinitesimal")
    if mobility.singular:
        notes.append(f"{mobility.instantaneous} at this singular pose")
    return f" ({'; '.join(notes)})" if notes else ""


RULE = Rule("KF301", "mobility-differs", "error", __doc__, check, needs=("stated mobility", "kinematics"))

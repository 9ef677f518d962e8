"""Springs vibrate too fast to be followed, and the solver damped them.

A light part on a stiff spring without damping vibrates thousands of times a second, for ever. Where following that
would take more steps than a run may take, and outputs are too far apart to show it, the solver takes the vibration out
and goes on with the motion about which it swings. A finding when more than a millionth of the energy that is exchanged
went with it: positions are then known without the vibration only, and all rules that read the motion are inconclusive.
Forces are not known after it at all, as the least vibration of a stiff spring has forces of the size of its load.

Why it matters: how far parts swing, and what joints bear, is more than the run shows.

What to do: state the damping that the spring has, as a `damper` beside it or `damping` of a spring between points: a
real one has a few per cent of the critical. Or let the spring be rigid: leave out the joint, or prescribe its motion.
Outputs that are close enough to show the vibration (`step` in `[simulation]`) and a shorter `duration` make the solver
follow it.

Example: a rocker of 50 g held by a spring of 10^7 N·m/rad, which swings 13,500 times a second.
"""

from __future__ import annotations

from kinform.consistency.context import DAMPED_UNSEEN, Context
from kinform.consistency.outcome import Outcome, decided, inconclusive
from kinform.consistency.rule import Rule
from kinform.foundation.words import number

SPEAKS_FOR = ("KF413", "KF505", "KF506", "KF507")


def check(context: Context) -> Outcome:
    """What the solver damped."""
    run = context.attempt
    if not run.dampings:
        return decided()
    first, fastest = run.dampings[0], max(one.frequency for one in run.dampings)
    what = (
        f"vibrations of the springs, of up to {number(fastest, 3)} Hz, were damped from t = {number(first.since, 3)} s "
        f"on: {number(run.damped, 3)} J went with them, {number(100.0 * run.damped_share, 2)} % of the energy exchanged"
    )
    if run.damped_share <= DAMPED_UNSEEN:
        return decided(reason=what)
    finding = RULE.finding(
        (context.assembly.name,),
        what,
        found=f"{number(run.damped, 3)} J",
        intended="vibrations that can be followed, or are damped by the design",
        declared=context.assembly.source,
        remedy="State the damping of the springs, or make them rigid.",
    )
    return inconclusive("how far the springs swing is not known", [finding])


RULE = Rule("KF508", "vibration-damped", "warning", __doc__, check, needs=("attempt",), speaks_for=SPEAKS_FOR)

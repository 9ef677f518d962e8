"""Too little of the work that the drive of a joint puts in comes out, because of friction.

At each of the poses the joint is moved slowly against gravity, loads and springs: the efficiency is the effort without
friction over that with it, by the coefficients in motion. Other drives stand still, and joints that close no loop are
held. Friction is that of the drives of kind friction, and what couplings and motors lose by their `efficiency`; joints
without one count as free of it. Without load there is no efficiency; loads that redundancy shares leave it open:
inconclusive then (KF902).

Why it matters: the motor that was chosen for the load does not move it, and what is lost heats the thread.

What to do: take a steeper lead, a smaller radius, better materials or lubrication, or rolling bodies.

Example: `kind = "efficiency"`, `joint = "screw"`, `minimum = 0.3`.
"""

from __future__ import annotations

from kinform.consistency.requirements import requirement_rule

RULE = requirement_rule("KF434", "efficiency-too-low", "efficiency", __doc__)

"""A joint that is meant to stay under its load without a drive is moved by it.

At each of the poses gravity, loads and springs act and the joint's drive gives nothing; other drives stand still, and
joints that close no loop are held. Friction at rest (of the drives of kind friction, by the coefficients at rest)
holds the joint, or does not. Where nothing loads it, nothing is shown, and loads that redundancy shares leave it open:
inconclusive then (KF902). Vibration loosens what friction holds; a coefficient is rarely known better than to a third.

Why it matters: the lift comes down when the motor is switched off.

What to do: take a smaller lead, a larger radius, a greater coefficient at rest, or add a brake.

Example: `kind = "self_locking"`, `joint = "screw"`.
"""

from __future__ import annotations

from kinform.consistency.requirements import requirement_rule

RULE = requirement_rule("KF435", "not-self-locking", "self_locking", __doc__)

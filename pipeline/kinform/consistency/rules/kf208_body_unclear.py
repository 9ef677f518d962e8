"""Parts whose body the function and the contacts do not tell.

Where the function states all joints (`complete = true`), parts move with what holds them. Horns, spacers and bearings
on a joint's own axis may turn with either side, and parts that touch nothing go with the nearest: they are placed, and
listed here, the least clear first.

Why it matters: masses and collisions count them where they were put.

What to do: nothing where it does not matter; else name them in a `[[group]]`. `kinform show F.h5 bodies` lists all.

Example: an idler horn between two links, screwed to neither in the model.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import counted, quoted
from kinform.model.findings import Finding

NAMED_UNCLEAR = 8
"""Parts of unclear bodies that are named in one finding: two lines of a terminal. Chosen, not measured."""


def check(context: Context) -> Findings:
    """All such parts, as one finding."""
    unclear = sorted((m for m in context.kinematics.membership if m.either), key=lambda m: (m.margin, m.part))
    touching = [str(one.part) for one in unclear if one.how != "nearest"]
    alone = [str(one.part) for one in unclear if one.how == "nearest"]
    return [] if not unclear else [_finding(context, touching, alone)]


def _finding(context: Context, touching: list[str], alone: list[str]) -> Finding:
    said = [
        f"{counted(len(names), 'part')} {what}: {_some(names)}"
        for names, what in (
            (touching, "could be in another body, as far as joints and contact tell"),
            (alone, "that touched nothing went with the nearest"),
        )
        if names
    ]
    return RULE.finding(
        touching + alone,
        "; ".join(said),
        found="placed by the least contact that is parted, or nearest",
        intended="parts that something holds in one body",
        declared=context.assembly.source,
        remedy="Name them in a [[group]] where it matters; `kinform show F.h5 bodies` lists them.",
    )


def _some(names: list[str]) -> str:
    rest = len(names) - NAMED_UNCLEAR
    return quoted(names[:NAMED_UNCLEAR]) + (f" and {counted(rest, 'more part')}" if rest > 0 else "")


RULE = Rule("KF208", "body-unclear", "note", __doc__, check, needs=("kinematics",))

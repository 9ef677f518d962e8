"""The collision geometry of a link does not cover its visual geometry, or reaches far beyond it.

Both are compared as simulators use them, by the convex hulls of their pieces. Not covered: more than 15 % of the
visual's area lies outside of all hulls, some of it by more than 10 % of the link's size. Far beyond: the collision
geometry reaches out of the hull of the visual by more than 30 % of the link's size. Where one of the two is about 1000
times larger than the other, one of them is in another unit. Links with equal geometry of both kinds are not asked, nor
those that have one of them only.

Why it matters: a planner drives what is not covered through things, and stops before what is not there.

What to do: add the missing pieces to `<collision>`, or shrink it; check the `scale` and `origin` of its meshes.

Example: a collision mesh without the motor that the visual has: a quarter of the link is bare.
"""

from __future__ import annotations

from kinform.consistency.comparisons.gathering import Ranked, gathered
from kinform.consistency.comparisons.links import described_links
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted, length, number
from kinform.model.assembly import Source
from kinform.model.descriptions import Coverage, DescribedLink
from kinform.model.findings import Finding

BARE_SHARE = 0.15
"""Share of the visual's area that may lie outside of the collision geometry: rounded covers by boxes stay below.
Chosen, not measured."""
BARE_DEPTH = 0.10
"""Share of the link's size by which it may reach out there. Chosen, not measured: what matters collides by more."""
FAR_BEYOND = 0.30
"""Share of the link's size by which collision geometry may reach beyond the visual: boxes and cylinders around slender
links."""
THOUSAND_SPREAD = 5.0
"""Factor about 1000, metres over millimetres, within which two sizes of one link say that their units differ. Chosen,
not measured: collision geometry is hardly five times as large or small as what is seen."""


def check(context: Context) -> Outcome:
    """Every link with geometry of both kinds."""
    ranked: list[Ranked] = []
    doubted = {name for doubt in context.doubts for name in doubt.subject}
    compared = [link for link in described_links(context.assembly) if link.collisions and link.visuals]
    for link in compared:
        if link.coverage is not None and not doubted & {link.name, *link.parts}:
            ranked += _of_link(context, link, link.coverage)
    return decided(gathered(ranked, "link"), f"{counted(len(compared), 'link')} compared")


def _of_link(context: Context, link: DescribedLink, coverage: Coverage) -> list[Ranked]:
    units, size = context.units, coverage.size
    ratio = coverage.collision_size / size
    factor = max(ratio, 1.0 / ratio) if ratio > 0.0 else 1.0
    if 1.0 / THOUSAND_SPREAD < factor / 1000.0 < THOUSAND_SPREAD:
        larger, smaller = ("collision", "visual") if ratio > 1.0 else ("visual", "collision")
        across = sorted((coverage.collision_size, size))
        text = (
            f"the {larger} geometry of link '{link.name}' is {length(across[1], units)} across and its {smaller} "
            f"geometry {length(across[0], units)}: one of them is in millimetres, taken for metres"
        )
        found = f"{number(factor, 3)} times"
        finding = _finding("error", link, text, found, "about the same size", "Correct the `scale` of the mesh.")
        return [Ranked("scale", factor, finding)]
    findings = []
    if coverage.uncovered_share > BARE_SHARE and coverage.uncovered > BARE_DEPTH * size:
        share = f"{number(100.0 * coverage.uncovered_share, 2)} %"
        text = (
            f"the collision geometry of link '{link.name}' leaves {share} of its visual bare, which reaches "
            f"{length(coverage.uncovered, units)} out of it (the link is {length(size, units)} across)"
        )
        remedy = "Add what is missing to the collision geometry, or correct its origin and scale."
        finding = _finding("warning", link, text, f"{share} bare", "all of it covered", remedy)
        findings.append(Ranked("bare", coverage.uncovered_share, finding))
    if coverage.beyond > FAR_BEYOND * size:
        text = (
            f"the collision geometry of link '{link.name}' reaches {length(coverage.beyond, units)} beyond its visual "
            f"(the link is {length(size, units)} across)"
        )
        remedy = "Shrink the collision geometry, or correct its origin and scale."
        found = f"{length(coverage.beyond, units)} beyond"
        finding = _finding("warning", link, text, found, "as large as the visual", remedy)
        findings.append(Ranked("beyond", coverage.beyond / size, finding))
    return findings


def _finding(severity: str, link: DescribedLink, text: str, found: str, intended: str, remedy: str) -> Finding:
    return RULE.at(severity).finding(
        [link.name], text, found=found, intended=intended, declared=Source(link.file, link.line), remedy=remedy
    )


RULE = Rule(
    "KF130",
    "collision-geometry-differs",
    "warning",
    __doc__,
    check,
    needs=("descriptions", "collision geometry"),
    also=("error",),
)

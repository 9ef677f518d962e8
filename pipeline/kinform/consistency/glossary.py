"""The words that kinform prints of a design, for `kinform explain`: what each means, and what to do about it."""

from __future__ import annotations

STATUS, ANSWER, TYPE = "status of a joint", "answer to an intended joint", "type of joint"
FIT, COUNT, OUTCOME, RANGE, OTHER = "fit of a contact", "count of mobility", "outcome", "range of a joint", "word"

GLOSSARY: dict[str, tuple[str, str]] = {
    "determined": (STATUS, "Contact alone gives the joint: every motion is clearly free or clearly held."),
    "inferred": (
        STATUS,
        "Contact alone leaves more than one reading, and other evidence chooses: rims that line up, a bolt circle, a "
        "fastener, an assumption, or the stated function. The evidence is listed with the joint.",
    ),
    "stated": (
        STATUS,
        "The joint is taken from [function], whose `complete = true` says that every joint that is meant is there: "
        "contact leaves its motion free and does not hold the bodies to it, or does not touch. Whatever carries it "
        "(a bearing, a pin, screws) is in no mesh.",
    ),
    "ambiguous": (
        STATUS,
        "Contact neither clearly holds nor clearly frees some motion, and kinform does not guess: the reason names "
        "both readings, or the number that is too uncertain. Usual causes are coarse or noisy meshes, faces that may "
        "be end stops or guides, and very short bearings. Finer meshes, a stated joint, or an [[assume]] decide it; "
        "`kinform show F.h5 joints --joint NAME` lists the patches.",
    ),
    "blocked": (
        STATUS,
        "Most of the contact allows a motion that a small part of it forbids (KF204): the joint is given as it would "
        "be without what blocks it, which is listed. Look whether that part is meant (a stop, a key) or a modelling "
        "error (an overlap, a misplaced face).",
    ),
    "agrees": (ANSWER, "Contact gives the intended joint, with its axis where it is stated, within tolerance."),
    "not held": (
        ANSWER,
        "Contact leaves the intended motion free, and more beside (KF414): nothing in the geometry holds the bodies to "
        "this joint. What else is free is named.",
    ),
    "contradicts": (
        ANSWER,
        "Contact forbids the intended motion (KF402), or gives the joint elsewhere (KF403, KF404).",
    ),
    "no contact": (
        ANSWER,
        "The two bodies do not touch (KF401). The motion is free, as every motion is; nothing makes it this joint. "
        "Where a horn or a flange is between them, name the part that touches in `between`, put the parts into a "
        "[[group]], or state all joints with `complete = true`.",
    ),
    "undecided": (
        ANSWER,
        "Contact does not tell whether it is this joint (KF901), or a part with play may carry it (KF401); the "
        "reason is given.",
    ),
    "fixed": (TYPE, "No freedom: the bodies do not move relative to each other."),
    "revolute": (TYPE, "One freedom: a turn about an axis, as a hinge or a journal between collars."),
    "prismatic": (TYPE, "One freedom: a slide along a direction, as a drawer or a key in its way."),
    "cylindrical": (
        TYPE,
        "Two freedoms: a turn about an axis and a slide along it, as a smooth pin in a bore without collars. A hinge "
        "that comes out cylindrical lacks what holds it along its axis.",
    ),
    "spherical": (TYPE, "Three freedoms: all turns about a point, as a ball in its cup."),
    "planar": (TYPE, "Three freedoms: two slides on a plane and a turn about its normal, as a block on a table."),
    "screw": (TYPE, "One freedom: a turn about an axis with an advance along it, as a nut on its thread."),
    "universal": (TYPE, "Two freedoms: turns about two axes that cross, as a cross between two forks."),
    "general": (
        TYPE,
        "What the contact leaves free is none of the named types (teeth, a cam, a ball in a groove, a stray touch): "
        "its freedoms are counted, and told in words.",
    ),
    "clearance": (FIT, "The surfaces lie beside each other with a gap."),
    "touch": (FIT, "The surfaces lie on each other, as closely as the meshes can tell."),
    "transition": (FIT, "Gap and overlap are both within what the facets leave open."),
    "interference": (FIT, "The surfaces overlap: a press fit within the contact tolerance (KF202); beyond, KF201."),
    "mobility": (COUNT, "How many independent motions the whole has relative to ground."),
    "instantaneous": (COUNT, "Freedoms at first order, at the pose of the meshes."),
    "finite": (COUNT, "Freedoms that go on as motions: those of first order without those that lock at once."),
    "effective": (COUNT, "Finite freedoms without idle ones; `function.mobility` may count idle ones too."),
    "idle": (
        COUNT,
        "Turns that nobody sees: of a bare solid of revolution, a ball or a fastener, as a pin that spins (KF304). "
        "What slides counts, and so does a turn that a joint of [function] names.",
    ),
    "redundant": (COUNT, "Constraints more than are needed to hold what is held (KF303): two hinges on one axis."),
    "consistent": (OUTCOME, "The function states something, all of it was decided, and nothing fails. Exit code 0."),
    "no errors found": (
        OUTCOME,
        "Nothing fails, and less is verified than for consistent: nothing is declared, or some of it was not decided "
        "or not checked. The verdict says which. Exit code 0.",
    ),
    "inconsistent": (
        OUTCOME,
        "There are findings at or above the severity that fails. The verdict counts them by what they are about, and "
        "says how many of the stated joints match. Exit code 1.",
    ),
    "not verified": (
        OUTCOME,
        "No rule ran, or one could not decide: silence is no pass. With --strict also what the verdict leaves open. "
        "Exit code 2.",
    ),
    "not checked": (OUTCOME, "Nothing asked for the rule: limits of efforts need a simulation. It is never met."),
    "coverage": (
        OUTCOME,
        "The line below the verdict: how many joints and contacts are understood, what is open, what was not checked, "
        "and which rules [check] leaves out, ignores or lowers to notes.",
    ),
    "inconclusive": (OUTCOME, "A rule could not decide; its reason says what is missing."),
    "skipped": (OUTCOME, "A rule that does not apply: nothing is stated that it could compare. It does not count."),
    "ignored": (OUTCOME, "A finding that [check] in the manifest or a baseline accepts. It does not count."),
    "found": (RANGE, "The joint was moved until a part stopped it; what stopped it is named."),
    "unbounded": (RANGE, "Nothing stops the joint."),
    "unknown": (
        RANGE,
        "How far the joint goes could not be found; or was not looked for, with `--no-ranges` or where it takes long: "
        "`--ranges` asks.",
    ),
    "complete": (
        OTHER,
        "`complete = true` in [function]: every joint that is meant to move is stated. Which parts are one body then "
        "follows from these joints and the contacts, and contact that no stated joint moves holds.",
    ),
    "ground": (
        OTHER,
        "The body at rest. `ground = \"PART\"` in [assembly] chooses it; else the heaviest is taken (the largest "
        "without densities; of equal ones the first by name), and said. Types of joints do not depend on it; names and "
        "signs of motions may.",
    ),
    "body": (OTHER, "Parts that move as one; named after its first group, else its first part, in the alphabet."),
    "group": (OTHER, "Parts that the manifest states to be fastened by what the meshes do not show: screws, glue."),
    "patch": (OTHER, "Where a surface of one part lies on a surface of another: with area, gap and fit."),
    "held": (OTHER, "Of a joint: no motion breaks the contact. Else it says how the bodies come apart."),
    "singular values": (
        OTHER,
        "How strongly contact opposes each of six motions: near 0 free, above the limit held, between them ambiguous.",
    ),
}  # fmt: skip
"""By word: of what it is said, and what it means."""


def meaning(word: str) -> str | None:
    """What the word means; None where kinform prints no such word."""
    known = GLOSSARY.get(" ".join(word.casefold().replace("-", " ").replace("_", " ").split()))
    return None if known is None else f"{word.strip().casefold()} ({known[0]})\n\n{known[1]}\n"

"""`kinform joints`: constraint matrix, bodies, joints, mobility."""

from __future__ import annotations

from kinform_cli import console, files
from kinform_cli.options import Debug, Output, Quiet, Results, examples
from kinform_cli.progress import Working
from kinform_cli.text import count

__all__ = ["EXAMPLES", "joints"]

EXAMPLES = examples(
    "kinform joints b.h5 -o c.h5",
    "kinform show c.h5 joints",
    "kinform show c.h5 joints --format json",
)


def joints(source: Results, output: Output, quiet: Quiet = False, debug: Debug = False) -> None:
    """Derive from the contacts which parts move as one, the joints between them, and the mobility."""
    files.check_output(output)
    from kinform import results, stages

    design = files.read(source)
    with files.needing(source), Working("joints"):
        design = stages.joints(design)
    results.write(design, output)
    from kinform_cli.notes import ground_note

    found = design.kinematics
    assert found is not None
    console.say(
        f"{output}: {count(len(found.bodies), 'body', 'bodies')}, {count(len(found.joints), 'joint')}, "
        f"mobility {found.mobility.effective}"
    )
    console.say(ground_note(design))
    for joint in found.joints:
        if joint.status in ("ambiguous", "blocked"):
            console.warn(f"{joint.name} is {joint.status}: {joint.reason}")

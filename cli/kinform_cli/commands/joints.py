"""`kinform joints`: constraint matrix, bodies, joints, mobility."""

from __future__ import annotations

from kinform.foundation.words import counted
from kinform_cli import console, files
from kinform_cli.options import Output, Results, examples
from kinform_cli.text import ground_note

EXAMPLES = examples("kinform joints b.h5 -o c.h5", "kinform show c.h5 joints", "kinform show c.h5 joints --format json")


def joints(source: Results, output: Output) -> None:
    """Derive from the contacts which parts move as one, the joints between them, and the mobility."""
    from kinform import stages

    design = files.advance(source, output, "joints", lambda design, working: stages.joints(design))
    kinematics = design.kinematics
    assert kinematics is not None
    console.say(
        f"{output}: {counted(len(kinematics.bodies), 'body', 'bodies')}, {counted(len(kinematics.joints), 'joint')}, "
        f"mobility {kinematics.mobility.effective}"
    )
    console.say(ground_note(design))
    for joint in kinematics.joints:
        if joint.status in ("ambiguous", "blocked"):
            console.warn(f"{joint.name} is {joint.status}: {joint.reason}")

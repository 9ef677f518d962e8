"""`kinform lock`: keep the derived behaviour, once accepted, in a file that people review."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from kinform.foundation.words import counted
from kinform_cli import console, files
from kinform_cli.commands.diff import tolerance
from kinform_cli.errors import refuse
from kinform_cli.options import Results, Tolerances, examples, option
from kinform_cli.text import command

EXAMPLES = examples(
    "kinform lock arm.h5 -o behaviour.lock.json",
    "kinform lock arm.h5 -o behaviour.lock.json --tolerance 0.05mm --tolerance 1%",
    "kinform check arm.h5 --lock behaviour.lock.json",
)


def lock(
    source: Results,
    output: Annotated[Path, option("--output -o", "FILE", "Lock file (JSON) to write.")],
    tolerances: Tolerances = None,
) -> None:
    """Lock the behaviour: bodies, joints, axes, ranges, mobility, masses, overlaps, as they are now.

    Values are rounded to a tenth of the tolerances; those stand in the file and hold when it is checked.
    """
    within = tolerance(tolerances)
    files.check_text_output(output, inputs=[source])
    from kinform import changes

    design = files.read(source)
    files.warn_of_origin(design, source)
    behaviour = changes.snapshot(design)
    if behaviour.joints is None:
        raise refuse("has no joints to lock", file=source, remedy=command("kinform", "joints", source, "-o", source))
    files.write_text(output, changes.write_lock(behaviour) if within is None else changes.write_lock(behaviour, within))
    console.say(
        f"{output}: {counted(len(behaviour.bodies or ()), 'body', 'bodies')}, {counted(len(behaviour.joints), 'joint')}"
    )

"""`kinform mass`: mass, centre of mass and inertia."""

from __future__ import annotations

from kinform.foundation.words import counted
from kinform_cli import console, files
from kinform_cli.options import Output, Results, examples

EXAMPLES = examples("kinform mass c.h5 -o d.h5", "kinform show d.h5 mass")


def mass(source: Results, output: Output) -> None:
    """Compute mass, centre of mass and inertia of each part and body."""
    from kinform import stages

    report = files.advance(source, output, "mass", lambda design, working: stages.mass(design)).mass
    assert report is not None
    weighed = sum(part.mass is not None for part in report.parts)
    console.say(f"{output}: mass of {weighed} of {counted(len(report.parts), 'part')}")
    for part in report.parts:
        if part.mass is None and part.reason:
            console.warn(f"{part.name} has no mass: {part.reason}")
    for name, message in report.problems:
        console.warn(f"{name}: {message}")

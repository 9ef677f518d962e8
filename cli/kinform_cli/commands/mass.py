"""`kinform mass`: mass, centre of mass and inertia."""

from __future__ import annotations

from kinform_cli import console, files
from kinform_cli.options import Debug, Output, Quiet, Results, examples
from kinform_cli.progress import Working
from kinform_cli.text import count

__all__ = ["EXAMPLES", "mass"]

EXAMPLES = examples("kinform mass c.h5 -o d.h5", "kinform show d.h5 mass")


def mass(source: Results, output: Output, quiet: Quiet = False, debug: Debug = False) -> None:
    """Compute mass, centre of mass and inertia of each part and body."""
    files.check_output(output)
    from kinform import results, stages

    design = files.read(source)
    with files.needing(source), Working("mass"):
        design = stages.mass(design)
    results.write(design, output)
    found = design.mass
    assert found is not None
    known = sum(part.mass is not None for part in found.parts)
    console.say(f"{output}: mass of {known} of {count(len(found.parts), 'part')}")
    for part in found.parts:
        if part.mass is None and part.reason:
            console.warn(f"{part.name} has no mass: {part.reason}")
    for name, message in found.problems:
        console.warn(f"{name}: {message}")

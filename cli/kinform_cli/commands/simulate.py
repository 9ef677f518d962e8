"""`kinform simulate`: motion at the level that the information allows."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

from kinform_cli import console, files
from kinform_cli.options import Output, Ranges, Results, examples, option

EXAMPLES = examples(
    "kinform simulate d.h5 -o e.h5",
    "kinform simulate d.h5 -o e.h5 --level kinematic",
    "kinform simulate d.h5 -o e.h5 --no-ranges",
    "kinform show e.h5 simulation",
)


class Level(StrEnum):
    """How much is simulated."""

    functional = "functional"
    kinematic = "kinematic"
    dynamic = "dynamic"


def simulate(
    source: Results,
    output: Output,
    level: Annotated[
        Level | None,
        option(
            "--level", None, "Force a level; else the one that the manifest states, else the highest that is known."
        ),
    ] = None,
    ranges: Ranges = None,
) -> None:
    """Simulate the motion that the drives give, and write the trajectories.

    functional: the stated joints alone, as ball and stick.
    kinematic: the derived joints, moved by the drives.
    dynamic: with masses and forces.
    """
    from kinform import stages

    wanted = None if level is None else level.value
    run = files.advance(
        source,
        output,
        "simulation",
        lambda design, working: stages.simulate(design, level=wanted, ranges=ranges, progress=working, say=console.say),
    ).simulation
    assert run is not None
    from kinform_cli.views.simulation import headline

    console.say(f"{output}: {headline(run)}")
    for subject, message in run.failures:
        console.warn(f"{subject}: {message}")

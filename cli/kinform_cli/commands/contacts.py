"""`kinform contacts`: surfaces, contact patches and overlaps."""

from __future__ import annotations

from kinform_cli import console, files
from kinform_cli.options import Debug, Jobs, Output, Quiet, Results, cores, examples
from kinform_cli.progress import Working
from kinform_cli.text import count

__all__ = ["EXAMPLES", "contacts"]

EXAMPLES = examples(
    "kinform contacts a.h5 -o b.h5",
    "kinform contacts arm.h5 -o arm.h5 --jobs 4",
    "kinform show b.h5 contacts",
)


def contacts(source: Results, output: Output, jobs: Jobs = None, quiet: Quiet = False, debug: Debug = False) -> None:
    """Find the analytic surfaces of each part, and where parts touch or overlap.

    What is still valid in an earlier output is reused.
    """
    files.check_output(output)
    from kinform import results, stages
    from kinform.reuse.ledger import Ledger

    design, ledger = files.read(source), Ledger.of(output)
    with files.needing(source), Working("contacts") as progress:
        design = stages.contacts(design, jobs=cores(jobs), progress=progress, ledger=ledger)
    ledger.close()
    results.write(design, output)
    found = design.contacts
    assert found is not None
    pairs = len({patch.parts for patch in found.patches})
    console.say(
        f"{output}: {count(len(found.patches), 'contact patch', 'contact patches')} between "
        f"{count(pairs, 'pair')} of parts, {count(len(found.interferences), 'overlap')}"
    )

"""`kinform contacts`: surfaces, contact patches and overlaps."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinform.foundation.words import counted
from kinform_cli import console, files
from kinform_cli.options import Jobs, Output, Results, TrustResults, cores, examples
from kinform_cli.progress import Working

if TYPE_CHECKING:
    from kinform.design import Design


EXAMPLES = examples(
    "kinform contacts a.h5 -o b.h5", "kinform contacts arm.h5 -o arm.h5 --jobs 4", "kinform show b.h5 contacts"
)


def contacts(source: Results, output: Output, jobs: Jobs = None, trust_results: TrustResults = False) -> None:
    """Find the analytic surfaces of each part, and where parts touch or overlap.

    What is still valid in an earlier output is reused.
    """
    from kinform import results, stages
    from kinform.errors import ResultsError
    from kinform.reuse.ledger import Ledger

    def stage(design: Design, working: Working) -> Design:
        try:
            named = output.exists() and output.samefile(source)  # then it is the input
            earlier = results.earlier(output, None, console.warn, trust=trust_results or named)
            if earlier is not None and not earlier.recorded:
                design = design.of_origin(False)
            found = stages.contacts(design, jobs=cores(jobs), progress=working, ledger=Ledger(earlier))
        except ResultsError:  # it makes no sense, which was told: it counts as absent
            return stages.contacts(design, jobs=cores(jobs), progress=working)
        if earlier is not None:
            earlier.close()
        return found

    contacts = files.advance(source, output, "contacts", stage).contacts
    assert contacts is not None
    pairs = len({patch.parts for patch in contacts.patches})
    console.say(
        f"{output}: {counted(len(contacts.patches), 'contact patch', 'contact patches')} between "
        f"{counted(pairs, 'pair')} of parts, {counted(len(contacts.interferences), 'overlap')}"
    )

"""What `kinform run` does, once it is known what is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from kinform_cli import console, files
from kinform_cli.choices import FindingsFormat, Severity, cores
from kinform_cli.errors import refuse
from kinform_cli.gate import show_run
from kinform_cli.progress import Working

__all__ = ["execute"]


def execute(
    sources: Sequence[Path],
    output: Path | None,
    *,
    manifest: bool,
    units: str | None = None,
    allow_outside: bool = False,
    format: FindingsFormat = FindingsFormat.full,
    fail_on: Severity = Severity.error,
    ranges: bool | None = None,
    jobs: int | None = None,
    depfile: Path | None = None,
    changed: bool = False,
) -> int:
    """Run everything, print the findings; returns the exit code of the gate. `manifest`: whether the source is one;
    `changed`: whether it is known that the output is not what a run would give."""
    if output is not None:
        files.check_output(output, inputs=sources)
    if depfile is not None:
        if output is None:
            raise refuse("--depfile names what the output depends on", file=depfile, remedy="add -o F.h5")
        files.check_text_output(depfile, inputs=[*sources, output])
    first = output is not None and not output.exists()
    import kinform

    with Working("run") as working:
        outcome = kinform.run(
            sources[0] if manifest else sources,
            output,
            jobs=cores(jobs),
            progress=working.step,
            allow_outside=allow_outside,
            units=units,
            say=console.say,
            ranges=ranges,
            changed=changed,
        )
    if depfile is not None and output is not None:
        files.write_text(depfile, files.make_rule(output, files.read_by(outcome.gist, sources)))
    code = show_run(outcome, format, fail_on, sources[0].parent if manifest else None)
    if output is None:
        console.say("nothing was kept: add -o F.h5, and `kinform show` and `kinform report` can look at the results")
    elif first:
        page = output.with_suffix(".html")
        console.say(f"next: kinform report {output} -o {page}   (one page to look at), or: kinform show {output}")
    return code

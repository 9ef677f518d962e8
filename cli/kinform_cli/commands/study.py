"""`kinform study`: what happens when numbers of a design vary."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinform.foundation.escapes import json_text
from kinform_cli import console, files
from kinform_cli.commands.batch import Pace, limits_of, need_extra
from kinform_cli.errors import refuse
from kinform_cli.options import (
    AllowOutside,
    AllowXacro,
    Jobs,
    PrintedTable,
    TableFormat,
    TrustResults,
    argument,
    cores,
    examples,
    option,
)

if TYPE_CHECKING:
    from kinform.study import Plan

EXAMPLES = examples(
    "kinform study stroke.toml -o stroke.h5",
    "kinform study stroke.toml -o stroke.h5 --jobs 4 --format json",
    "kinform study shapes.toml -o shapes.h5 --allow-commands",
    "kinform study stroke.toml -o stroke.h5 --scheduler tcp://10.0.0.5:8786",
)


def study(
    source: Annotated[Path, argument("STUDY.toml", "What varies, how, and what is measured.")],
    output: Annotated[
        Path, option("--output -o", "S.h5", "The table to write; S.csv and the page S.html are written beside it.")
    ],
    jobs: Jobs = None,
    scheduler: Annotated[
        str | None, option("--scheduler", "ADDRESS", "A scheduler of Dask whose workers see the same files.")
    ] = None,
    seconds: Annotated[float | None, option("--time", "SECONDS", "What one sample may take.")] = None,
    memory: Annotated[str | None, option("--memory", "SIZE", "What one sample may take, as in 500MB or 2GB.")] = None,
    allow_commands: Annotated[
        bool, typer.Option("--allow-commands", help="Run the commands of the study that make meshes.")
    ] = False,
    allow_outside: AllowOutside = False,
    allow_xacro: AllowXacro = False,
    trust_results: TrustResults = False,
    format: PrintedTable = TableFormat.table,
) -> None:
    """Vary numbers of a design, and measure what becomes of it.

    A study that was interrupted goes on where it stopped.

    Exit code 0: written, also where some samples failed: the table says which. 2: all failed, or nothing was written.
    """
    limits = limits_of(seconds, memory)
    need_extra()
    from kinform import study as studies
    from kinform.batch import Settings
    from kinform.study import page, table
    from kinform.study.session import journal_of

    files.check_text_output(output, inputs=[source])
    table.check_output(output)
    beside = [output.with_suffix(end) for end in (".csv", ".html")]
    for path in beside:
        files.check_text_output(path, inputs=[source])
    if output.suffix.lower() not in (".h5", ".hdf5"):
        raise refuse("the table of a study is HDF5", file=output, remedy=f"name it {output.with_suffix('.h5')}")
    plan = studies.read_plan(source, allow_outside=allow_outside)
    _check_commands(plan, allow_commands)
    began = time.monotonic()
    with Pace("study", began) as pace:
        settings = Settings(
            cores(jobs), scheduler, False, limits, allow_outside=allow_outside, allow_xacro=allow_xacro,
            trust_results=trust_results,
        )  # fmt: skip
        outcome = studies.run(plan, output, settings, pace, console.warn)
    table.write(outcome, output)
    files.write_text(beside[0], table.as_csv(outcome))
    files.write_text(beside[1], page.page_html(outcome))
    journal_of(output).forget()
    if format is TableFormat.json:
        console.emit(json_text(json.dumps(table.values(outcome), indent=1)))
    else:
        from kinform_cli.views import study as view

        console.out(view.render(outcome))
    console.say(f"{output}, {beside[0].name} and {beside[1].name}: {time.monotonic() - began:.1f} s")
    if all(outcome.failures):
        raise typer.Exit(2)


def _check_commands(plan: Plan, allowed: bool) -> None:
    if plan.makes and not allowed:
        words = " ".join(plan.makes[0].command)
        raise refuse(f"runs commands of its own, such as: {words}", file=plan.path,
                     remedy="read them, then allow them: --allow-commands")  # fmt: skip

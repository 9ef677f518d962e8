"""`kinform batch`: every design below some folders."""

from __future__ import annotations

import math
import re
import time
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinform.foundation.words import counted
from kinform_cli import console, files
from kinform_cli.errors import refuse
from kinform_cli.options import (
    AllowOutside,
    AllowXacro,
    FailOn,
    Jobs,
    Severity,
    Strict,
    TrustResults,
    argument,
    cores,
    examples,
    option,
)
from kinform_cli.progress import Working

if TYPE_CHECKING:
    from kinform.batch import Found, Row, Settings
    from kinform.batch.task import Limits

EXAMPLES = examples(
    "kinform batch designs/ -o results",
    "kinform batch arms/ hands/ -o results --exclude 'old/*' -f junit=all.xml",
    "kinform batch . -o results --changed-since origin/main -f sarif=all.sarif",
    "kinform batch designs/ -o results --jobs 4 --time 300 --memory 2GB",
    "kinform batch arms/ -o results --catalog arms.sqlite",
    "kinform batch arms/ -o results --scheduler tcp://10.0.0.5:8786 --send",
)

_UNITS = {"": 1, "kb": 10**3, "mb": 10**6, "gb": 10**9, "kib": 2**10, "mib": 2**20, "gib": 2**30}


class BatchFormat(StrEnum):
    """How all findings are printed."""

    table = "table"
    concise = "concise"
    json = "json"
    sarif = "sarif"
    junit = "junit"
    github = "github"
    md = "md"


def batch(
    paths: Annotated[list[Path], argument("PATH...", "Folders, with all designs below them; single designs.")],
    output: Annotated[
        Path, option("--output -o", "RESULTS", "Folder of the results, which lie there as designs lie below the paths.")
    ],
    include: Annotated[
        list[str] | None,
        option("--include", "PATTERN", "Only files like this, as in '*.step' or 'arms/*.toml'. May be repeated."),
    ] = None,
    exclude: Annotated[
        list[str] | None, option("--exclude", "PATTERN", "Leave files like this out. May be repeated.")
    ] = None,
    ignored: Annotated[bool, typer.Option("--ignored", help="Also look at what .gitignore leaves out.")] = False,
    changed_since: Annotated[
        str | None,
        option("--changed-since", "REV", "Only designs of whose files one differs from this revision of git."),
    ] = None,
    jobs: Jobs = None,
    scheduler: Annotated[
        str | None,
        option("--scheduler", "ADDRESS", "A scheduler of Dask, as in tcp://10.0.0.5:8786; else one of here."),
    ] = None,
    send: Annotated[
        bool, typer.Option("--send", help="Send inputs to the workers, which see no files of here; needs --scheduler.")
    ] = False,
    seconds: Annotated[float | None, option("--time", "SECONDS", "What one design may take.")] = None,
    memory: Annotated[str | None, option("--memory", "SIZE", "What one design may take, as in 500MB or 2GB.")] = None,
    allow_outside: AllowOutside = False,
    allow_xacro: AllowXacro = False,
    trust_results: TrustResults = False,
    catalog: Annotated[
        Path | None,
        option("--catalog -c", "FILE", "Also add all results to this catalog (SQLite), made where there is none."),
    ] = None,
    fail_on: FailOn = Severity.error,
    strict: Strict = False,
    format: Annotated[
        list[str] | None,
        option(
            "--format -f",
            "FORMAT[=FILE]",
            "One text of all: table, concise, json, sarif, junit, github or md; with =FILE written there. May be given "
            "for each file, and once without.",
            autocompletion=lambda incomplete: [one for one in BatchFormat if one.startswith(incomplete)],
        ),
    ] = None,
) -> None:
    """Run every manifest and robot description below some folders.

    What is unchanged is not touched; one bad design stops no other.

    Exit code 0: none has findings or is not verified. 1: one has findings at or above --fail-on.
    2: one is not verified: a rule could not decide, the input is bad, its worker died, or what --strict adds.
    """
    shown, written = _printed(format or [])
    limits = limits_of(seconds, memory)
    if send and scheduler is None:
        raise typer.BadParameter("says how a cluster gets its inputs: name one with --scheduler", param_hint="--send")
    need_extra()
    from kinform import batch as many

    files.check_folder(output, inputs=paths)
    files.check_findings(((None, path) for _, path in written), paths)
    if catalog is not None:
        files.check_text_output(catalog, inputs=paths)
    found = many.discover(
        paths, include=include or (), exclude=exclude or (), ignored=ignored, results=output, say=console.say
    )
    settings = many.Settings(
        cores(jobs), scheduler, send, limits, allow_outside=allow_outside, allow_xacro=allow_xacro,
        trust_results=trust_results,
    )  # fmt: skip
    if changed_since is not None:
        found = _touched(found, changed_since, settings)
    began = time.monotonic()
    with Pace("batch", began) as pace:
        rows = many.run(found, output, settings, pace, console.warn) if found else ()
    rows = tuple(replace(row, strict=strict) for row in rows)
    _tell(rows, output, fail_on.value, shown, written)
    if catalog is not None:
        _fill(catalog, rows, output, trust_results)
    from kinform.batch.renderings import exit_code, summary_line

    console.say(f"{summary_line(rows, fail_on.value)}; {time.monotonic() - began:.1f} s")
    raise typer.Exit(exit_code(rows, fail_on.value) if found else 0)


def _fill(file: Path, rows: tuple[Row, ...], output: Path, trust: bool) -> None:
    """Add what has results to the catalog; what it has already with the same bytes is not read again, if this user's
    kinform wrote the catalog, or `trust`."""
    from kinform import catalog

    old = catalog.read(file) if file.exists() else catalog.Catalog()
    designs = {output / row.results: row.digest for row in rows if not row.failure}
    kept, refused = catalog.fill(old, designs, output, file.parent, reuse=trust or catalog.is_recorded(file))
    catalog.write(kept, file)
    for item in refused:
        console.warn(f"left out {item.path}: {item.reason}")
    console.say(f"{file}: {counted(len(kept.entries), 'design')}")


def need_extra() -> None:
    """An error where the package is missing that many designs at once need."""
    import importlib.util

    if importlib.util.find_spec("distributed") is None:
        raise refuse(
            "many designs at once need the package distributed",
            remedy="install it: pip install 'kinform[batch]'",
        )


def _touched(found: tuple[Found, ...], revision: str, settings: Settings) -> tuple[Found, ...]:
    from kinform.batch import changed_since

    with Working("read"):
        left = changed_since(found, revision, settings)
    console.say(f"{len(left)} of {counted(len(found), 'design')} differ from {revision}")
    return left


def _tell(
    rows: tuple[Row, ...], output: Path, fail_on: str, shown: BatchFormat, written: list[tuple[BatchFormat, Path]]
) -> None:
    """The files that were asked for, then what goes to stdout; what has no results is told on stderr too."""
    from kinform.batch import render

    for one, path in written:
        files.write_text(path, _text(rows, output, fail_on, one))
    if shown is not BatchFormat.table:
        console.emit(render(rows, output, shown.value, fail_on))
        return
    from kinform_cli.views import batch as view

    console.out(view.table(rows, fail_on))
    for row in rows:
        for problem in row.problems:
            console.say(f"{row.source}: {row.failure}: {replace(problem, remedy=None)}")
            console.say(f"  remedy: {problem.remedy}" if problem.remedy else None)


def _text(rows: tuple[Row, ...], output: Path, fail_on: str, format: BatchFormat) -> str:
    from kinform.batch import render

    if format is not BatchFormat.table:
        return render(rows, output, format.value, fail_on)
    from kinform_cli.views import batch as view

    return view.as_text(rows, fail_on)


def _printed(stated: list[str]) -> tuple[BatchFormat, list[tuple[BatchFormat, Path]]]:
    """What goes to stdout, and what to which files; a usage error where a format is none, or two go to one place."""
    shown: list[BatchFormat] = []
    written: dict[Path, BatchFormat] = {}
    for text in stated:
        name, equals, file = text.partition("=")
        if name not in set(BatchFormat):
            from kinform.foundation.name_hints import did_you_mean

            remedy = did_you_mean(name, BatchFormat, "the formats")
            raise typer.BadParameter(f"{name!r} is no format: {remedy}", param_hint="--format")
        if equals and not file:
            raise typer.BadParameter(f"{text!r} names no file after the =", param_hint="--format")
        if equals and Path(file) in written:
            raise typer.BadParameter(f"two formats go to {file}", param_hint="--format")
        if equals:
            written[Path(file)] = BatchFormat(name)
        else:
            shown.append(BatchFormat(name))
    if len(shown) > 1:
        raise typer.BadParameter(f"{shown[0]} and {shown[1]} both go to stdout: give one a file, as in {shown[1]}=FILE",
                                 param_hint="--format")  # fmt: skip
    return (shown or [BatchFormat.table])[0], [(one, path) for path, one in written.items()]


def limits_of(seconds: float | None, memory: str | None) -> Limits:
    """What a design may take; a usage error where it is no time or no size."""
    from kinform.batch.task import Limits

    if seconds is not None and not 0.0 < seconds < math.inf:
        raise typer.BadParameter(f"{seconds:g} is no time", param_hint="--time")
    size = None
    if memory is not None:
        match = re.fullmatch(r"(\d+(?:\.\d+)?)\s*([kmg]i?b)", memory.strip().lower())
        if match is None or float(match[1]) == 0.0:
            raise typer.BadParameter(f"{memory!r} is no size, such as 500MB or 2GB", param_hint="--memory")
        size = int(float(match[1]) * _UNITS[match[2]])
    return Limits(seconds, size)


class Pace(Working):
    """Progress with the rate and the time that is left; off a terminal a line a minute."""

    def __init__(self, label: str, began: float):
        super().__init__(label)
        self._noun = label
        self._began: float | None = None
        self._said = began

    def __call__(self, done: int, total: int) -> None:
        """So many of the designs that are run are done."""
        now = time.monotonic()
        if self._began is None:
            self._began = now
        if done:
            self.stage(pace(self._noun, done, total, now - self._began))
        if now - self._said > 60.0 and self._thread is None:
            self._said = now
            console.say(f"{done} of {total}, {pace(self._noun, done, total, now - self._began)}")
        super().__call__(done, total)


def pace(noun: str, done: int, total: int, seconds: float) -> str:
    """ "batch 4.1/s, 1 min 52 s left"."""
    rate = done / max(seconds, 1e-9)
    left = round((total - done) / rate)
    hours, rest = divmod(left, 3600)
    minutes, single = divmod(rest, 60)
    told = f"{hours} h {minutes} min" if hours else f"{minutes} min {single} s" if minutes else f"{single} s"
    speed = f"{rate:.3g}/s" if rate >= 1 else f"{60 * rate:.3g}/min"
    return f"{noun} {speed}, {told} left"

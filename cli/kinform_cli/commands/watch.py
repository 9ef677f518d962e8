"""`kinform watch`: run again whenever a file of the design is saved."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinform.foundation.regular_files import AS_A_FILE, not_a_file
from kinform_cli import console, errors, files
from kinform_cli.commands.report import show_page
from kinform_cli.errors import refuse
from kinform_cli.gate import Gate
from kinform_cli.options import (
    AllowOutside,
    AllowXacro,
    Deviation,
    FailOn,
    FindingsFormat,
    Geometry,
    GeometryKind,
    Jobs,
    Packages,
    PrintedFindings,
    Severity,
    TrustResults,
    argument,
    cores,
    examples,
    option,
    printed,
    reading,
)
from kinform_cli.progress import Working
from kinform_cli.serving import PageServer

if TYPE_CHECKING:
    from kinform.form.sources import Reading


EXAMPLES = examples(
    "kinform watch arm.toml -o arm.h5",
    "kinform watch arm.toml -o arm.h5 --fail-on warning",
    "kinform watch arm.toml -o arm.h5 --report --open    # and the page",
    "kinform watch arm.toml -o arm.h5 --max-runs 1    # once",
)

Stamp = tuple[int, int, int] | None


def watch(
    manifest: Annotated[Path, argument("SOURCE", "Manifest or robot description of the design.")],
    output: Annotated[Path, option("--output -o", "F.h5", "Results file; what is valid is reused.")],
    allow_outside: AllowOutside = False,
    allow_xacro: AllowXacro = False,
    geometry: Geometry = GeometryKind.visual,
    packages: Packages = None,
    deviation: Deviation = None,
    format: PrintedFindings = None,
    fail_on: FailOn = Severity.error,
    jobs: Jobs = None,
    period: Annotated[
        float, typer.Option("--period", min=0.01, metavar="SECONDS", help="How often the files are looked at.")
    ] = 0.5,
    report: Annotated[
        bool, option("--report", None, "Serve the page to browsers on this machine; it loads itself again on save.")
    ] = False,
    port: Annotated[
        int | None, option("--port", "N", "With --report: the port; default: a free one.", min=1, max=65535)
    ] = None,
    open_: Annotated[bool, option("--open", None, "With --report: open the page in the browser.")] = False,
    max_runs: Annotated[int | None, option("--max-runs", "N", "Leave after so many runs.", min=1)] = None,
    trust_results: TrustResults = False,
) -> None:
    """Run on every save of the manifest or of a file that it names, until Ctrl-C.

    Bad input is reported, and the next save tried. The exit code is that of the last run; as for `run`.
    """
    if not report and (port is not None or open_):
        raise typer.BadParameter("goes with --report", param_hint="--open" if open_ else "--port")
    (manifest,) = files.sources_of([manifest])
    shown = printed(format, otherwise=FindingsFormat.concise)
    fault = not_a_file(manifest)
    if fault is not None:
        raise refuse(fault, file=manifest, remedy=AS_A_FILE)
    files.check_output(output, inputs=[manifest])
    files.check_findings(shown.files, [manifest, output])
    how = reading(geometry, packages, deviation, allow_xacro=allow_xacro)
    gate = Gate(shown, fail_on, manifest.parent)
    with contextlib.ExitStack() as stack:
        server = stack.enter_context(PageServer(port or 0)) if report else None
        if server is not None:
            console.say(f"the page: {server.address}   (for this machine only)")
        if server is not None and open_:
            show_page(server.address)
        once = lambda: _run(manifest, output, allow_outside, how, cores(jobs), gate, server, trust_results)
        code = _watch(manifest, output, once, period, max_runs)
    raise typer.Exit(code)


def _watch(manifest: Path, output: Path, once: Callable[[], int | None], period: float, max_runs: int | None) -> int:
    """Runs `once` now and on every save; the exit code of the last run."""
    code, runs = errors.NOT_VERIFIED, 0
    try:
        while True:
            before = _stamps(_files(manifest, output))
            verdict = once()
            code = errors.NOT_VERIFIED if verdict is None else verdict
            runs += 1
            if runs == max_runs or console.settings.cut is not None:
                break
            watched = _files(manifest, output)
            # what was saved while the run went on counts as saved after it
            # after bad input the folders count too: what was missing may appear, and nothing was written there
            folders = [] if verdict is not None else sorted({path.parent for path in watched})
            seen = {path: before.get(path, stamp) for path, stamp in _stamps([*watched, *folders]).items()}
            console.say(f"watching {len(watched)} files; Ctrl-C ends")
            _wait(seen, period)
    except KeyboardInterrupt:
        console.say("watching ended")
    return code


def _run(
    manifest: Path,
    output: Path,
    allow_outside: bool,
    how: Reading,
    jobs: int,
    gate: Gate,
    server: PageServer | None,
    trust: bool,
) -> int | None:
    """One run: prints its findings or its errors, and serves its page; the exit code that it is due, None where the
    input is bad."""
    import kinform

    try:
        with Working("run") as working:
            outcome = kinform.run(
                manifest,
                output,
                jobs=jobs,
                progress=working.step,
                allow_outside=allow_outside,
                reading=how,
                say=console.say,
                trust_results=trust,
            )
    except (kinform.KinformError, OSError) as error:
        errors.report(error)
        if server is not None:
            server.say(f"The last save could not be read, the page is of the one before: {error}")
        return None
    code = gate.judge(outcome.gist, outcome)
    if server is not None:
        from kinform.reports.page import page_html

        with Working("page"):
            server.show(page_html(outcome.design, live=server.next_version))
    return code


def _files(manifest: Path, output: Path) -> list[Path]:
    """The files of the design as the last results know them, and always the manifest."""
    from kinform import results

    names = results.files_of(output)
    return sorted({manifest, *(manifest.parent / name for name in names)})


def _stamps(paths: list[Path]) -> dict[Path, Stamp]:
    """Identity, time and size of each file; None where there is none."""
    stamps: dict[Path, Stamp] = {}
    for path in paths:
        try:
            status = path.stat()
            stamps[path] = (status.st_ino, status.st_mtime_ns, status.st_size)
        except OSError:
            stamps[path] = None
    return stamps


def _wait(seen: dict[Path, Stamp], period: float) -> None:
    """Return when a file is another than was seen, and has not changed for a period: programs save in several steps."""
    paths = list(seen)
    while (now := _stamps(paths)) == seen:
        time.sleep(period)
    while True:
        time.sleep(period)
        if (later := _stamps(paths)) == now:
            return
        now = later

"""`kinform report`: one page to look at, and pictures for pull requests."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from kinform.foundation.words import counted
from kinform_cli import console, files, supervision
from kinform_cli.designs import whole_design
from kinform_cli.errors import refuse
from kinform_cli.options import (
    AllowOutside,
    AllowXacro,
    Deviation,
    Geometry,
    GeometryKind,
    Jobs,
    Packages,
    Units,
    argument,
    cores,
    examples,
    option,
    reading,
)
from kinform_cli.progress import Working

EXAMPLES = examples(
    "kinform report arm.h5",
    "kinform report arm.toml --open              # runs it, and opens the page",
    "kinform report robot.urdf -o robot.html",
    "kinform report arm.h5 --png out             # also PNG and summary.md",
    "kinform report arm.h5 --png out --notes     # notes pictured too",
)


def report(
    sources: Annotated[
        list[Path],
        argument("SOURCE", "A results file; or a manifest, robot description, scene, or meshes with --units."),
    ],
    output: Annotated[
        Path | None, option("--output -o", "FILE.html", "Page to write; else that of the source's name beside it.")
    ] = None,
    open_: Annotated[bool, option("--open", None, "Open the page in the browser.")] = False,
    png: Annotated[
        Path | None,
        option(
            "--png",
            "DIR",
            "Also write pictures of errors and warnings and a Markdown summary into this folder, which is made where "
            "it is missing.",
        ),
    ] = None,
    notes: Annotated[bool, option("--notes", None, "With --png: pictures of notes too.")] = False,
    as_it_is: Annotated[
        bool, option("--as-it-is", None, "Show a results file of some stages as it is; else the others are computed.")
    ] = False,
    units: Units = None,
    allow_outside: AllowOutside = False,
    allow_xacro: AllowXacro = False,
    geometry: Geometry = GeometryKind.visual,
    packages: Packages = None,
    deviation: Deviation = None,
    jobs: Jobs = None,
) -> None:
    """Write one self-contained page: verdict, findings, the assembly in 3D, joints, motion, curves.

    What has not been computed yet is computed, and not kept.
    """
    sources = files.sources_of(sources)
    if notes and png is None:
        raise typer.BadParameter("goes with --png DIR", param_hint="--notes")
    page = output or _beside(sources[0])
    files.check_page(page, inputs=sources)
    if png is not None:
        files.check_folder(png, inputs=sources)
        _make_folder(png)
    design = whole_design(
        sources,
        units=units,
        reading=reading(geometry, packages, deviation, allow_xacro=allow_xacro),
        allow_outside=allow_outside,
        jobs=cores(jobs),
        as_it_is=as_it_is,
    )
    from kinform.reports.page import Artist, Scene, page_html, page_pictures, page_summary

    with Working("report") as working:
        artist = Artist(Scene(design))
        text = page_html(design, artist)
        step = lambda done, total: working.step("pictures", done, total)
        images = {} if png is None else page_pictures(artist, notes=notes, progress=step)
    files.write_text(page, text)
    console.say(f"{page}: {max(len(text.encode()) / 1e6, 0.1):.1f} MB, to be opened in a browser")
    if png is not None:
        for name, data in images.items():
            files.write_bytes(png / name, data, below=png)
        files.write_text(png / "summary.md", page_summary(design, notes=notes))
        console.say(f"{png}: {counted(len(images), 'picture')} and summary.md")
    if design.report is None:
        console.warn("the rules have not been run, and the page says so")
    if open_:
        show_page(page.resolve().as_uri())


def show_page(address: str) -> None:
    """Open an address in the browser of the user; a warning where there is none."""
    import webbrowser

    supervision.leave_children()
    try:
        shown = webbrowser.open(address)
    except webbrowser.Error:
        shown = False
    if not shown:
        console.warn(f"no browser could be started: open {address} yourself")


def _beside(source: Path) -> Path:
    """The page's name where none is given; an error where another file has it."""
    page = source.with_suffix(".html")
    files.check_page(page, inputs=[source])
    if page.is_file() and b'name="generator" content="kinform' not in page.read_bytes()[:4096]:
        raise refuse("exists, and is no page of kinform", file=page, remedy="name the page: -o FILE.html")
    return page


def _make_folder(path: Path) -> None:
    """Make the folder for pictures; an error where that cannot be."""
    from kinform import results

    try:
        results.make_folder(path)
    except OSError as error:
        raise refuse(f"the folder cannot be made: {error.strerror}", file=path, remedy="name another folder") from None
    files.check_text_output(path / "summary.md")

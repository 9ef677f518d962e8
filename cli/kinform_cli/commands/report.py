"""`kinform report`: one page to look at, and pictures for pull requests."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from kinform.foundation.words import counted
from kinform_cli import console, files
from kinform_cli.errors import refuse
from kinform_cli.options import Results, examples, option
from kinform_cli.progress import Working

EXAMPLES = examples(
    "kinform report arm.h5 -o arm.html", "kinform report arm.h5 -o arm.html --png out   # also PNG and summary.md"
)


def report(
    source: Results,
    output: Annotated[Path, option("--output -o", "FILE.html", "Page to write.")],
    png: Annotated[
        Path | None,
        option(
            "--png",
            "DIR",
            "Also write pictures and a Markdown summary into this folder, which is made where it is missing.",
        ),
    ] = None,
) -> None:
    """Write one self-contained page: verdict, findings, the assembly in 3D, joints, motion, curves."""
    files.check_page(output, inputs=[source])
    if png is not None:
        _make_folder(png)
    design = files.read(source)
    from kinform.reports.page import Scene, page_html, page_pictures, page_summary

    with Working("report"):
        scene = Scene(design)
        text = page_html(design, scene)
        images = {} if png is None else page_pictures(scene)
    files.write_text(output, text)
    console.say(f"{output}: {len(text.encode()) / 1e6:.2g} MB, to be opened in a browser")
    if png is not None:
        for name, data in images.items():
            files.write_bytes(png / name, data)
        files.write_text(png / "summary.md", page_summary(design))
        console.say(f"{png}: {counted(len(images), 'picture')} and summary.md")
    if design.report is None:
        console.warn("the rules have not been run, and the page says so: kinform check F.h5 -o F.h5")


def _make_folder(path: Path) -> None:
    """Make the folder for pictures; an error where that cannot be."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise refuse(f"the folder cannot be made: {error.strerror}", file=path, remedy="name another folder") from None
    files.check_text_output(path / "summary.md")

"""Writes again what the documentation shows the program print: `python docs/generate.py`.

In `docs/seeker.md` every `console` block is run as it stands, in the folder of `fixtures/seeker` that the comment
above it names (`<!-- in FOLDER -->`), on a copy of the fixtures that lasts for the whole page; what a command prints
is put below it, and its exit code where that is not 0. `<!-- picture FOLDER/FILE as NAME -->` takes a file that a
command wrote to `docs/images`. `docs/gallery.md` shows the mechanisms among the fixtures: a picture, the verdict, the
manifest. In `README.md` the block between `<!-- demo -->` and `<!-- /demo -->` is what `make
demo` prints.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kinform.design import Design

ROOT = Path(__file__).resolve().parent.parent

__all__ = ["demo", "gallery", "mechanisms", "readme", "story"]

_BLOCK = re.compile(r"(<!-- in (?P<folder>\S+) -->\n```console\n)(?P<body>.*?)(```\n)", re.DOTALL)
_PICTURE = re.compile(r"<!-- picture (?P<file>\S+) as (?P<name>\S+) -->")
_DEMO = re.compile(r"(<!-- demo -->\n```\n).*?(```\n<!-- /demo -->)", re.DOTALL)
_SHELL = re.compile(r"[|&;<>$`*?]")
_TERMINALS = ("COLUMNS", "FORCE_COLOR", "NO_COLOR", "PY_COLORS", "KINFORM_DEBUG", "KINFORM_CATALOG")


def story(text: str, work: Path) -> tuple[str, dict[str, bytes]]:
    """The page with what its commands print now, and the pictures that it takes, by name; `work` is an empty folder."""
    home = work / "seeker"
    shutil.copytree(ROOT / "fixtures" / "seeker", home)
    with _kinform(work) as environment:
        made = _BLOCK.sub(lambda m: m[1] + _run_all(m["body"], home / m["folder"], environment) + m[4], text)
    return made, {m["name"]: (home / m["file"]).read_bytes() for m in _PICTURE.finditer(text)}


def _run_all(body: str, folder: Path, environment: dict[str, str]) -> str:
    """The commands of a block, each with its output below it."""
    out = []
    for line in body.splitlines():
        if not line.startswith("$ "):
            continue
        printed, code = _run(line[2:], folder, environment)
        out += [line, *(row.rstrip() for row in printed.splitlines())]
        out += [f"[exit code {code}]"] if code else []
    return "\n".join(out) + "\n"


def _run(command: str, folder: Path, environment: dict[str, str]) -> tuple[str, int]:
    """What the command prints, errors among it, and its exit code. Without a shell's help it runs in this process."""
    words = shlex.split(command, comments=True)
    if words[:1] != ["kinform"] or _SHELL.search(command.split("#")[0]):
        ran = subprocess.run(
            ["bash", "-c", command], cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            text=True, check=False,
        )  # fmt: skip
        return ran.stdout, ran.returncode
    from kinform_cli.main import main

    printed = io.StringIO()
    with contextlib.chdir(folder), contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
        code = main(words[1:])
    return printed.getvalue(), code


@contextlib.contextmanager
def _kinform(folder: Path) -> Iterator[dict[str, str]]:
    """An environment in which `kinform` is that of this interpreter, and nothing pretends to be a terminal."""
    tools = folder / "bin"
    tools.mkdir(parents=True, exist_ok=True)
    script = tools / "kinform"
    script.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m kinform_cli "$@"\n')
    script.chmod(0o755)
    kept = {name: os.environ.pop(name) for name in _TERMINALS if name in os.environ}
    try:
        yield {**os.environ, "PATH": f"{tools}{os.pathsep}{os.environ.get('PATH', '')}"}
    finally:
        os.environ.update(kept)


def demo(work: Path) -> str:
    """What `make demo` prints; `work` is an empty folder."""
    with _kinform(work) as environment:
        (work / "bin" / "python").symlink_to(sys.executable)
        (work / ".installed").touch()
        ran = subprocess.run(
            ["make", "--no-print-directory", "demo", f"VENV={work}", f"OUT={work / 'out'}"],
            cwd=ROOT,
            env={name: value for name, value in environment.items() if name not in ("MAKEFLAGS", "MFLAGS")},
            capture_output=True,
            text=True,
            check=False,
        )
    if ran.returncode:
        raise RuntimeError(f"make demo failed:\n{ran.stderr}")
    printed = ran.stdout.replace(str(work / "out"), "build")
    lines = [line.rstrip() for line in printed.splitlines() if not line.startswith("make[")]
    return "\n".join(lines) + "\n"


def gallery(designs: Mapping[str, Design]) -> tuple[str, dict[str, bytes]]:
    """The page of mechanisms, and their pictures by name; designs by the name of their folder in
    `fixtures/mechanisms`, which also names their manifest."""
    from kinform import reports
    from kinform.reports.page import Artist, Scene

    made, pictures = [_GALLERY], {}
    for name, design in sorted(designs.items()):
        assert design.report is not None and design.kinematics is not None
        pictures[f"{name}.png"] = Artist(Scene(design)).overview(480, 300)
        manifest = (ROOT / "fixtures" / "mechanisms" / name / f"{name}.toml").read_text(encoding="utf-8").strip()
        said = reports.render(design.report, design, "brief", width=100).strip()
        counts = f"{len(design.assembly.parts)} parts, {len(design.kinematics.joints)} joints, "
        counts += f"mobility {design.kinematics.mobility.effective}"
        made.append(
            f"## {name.replace('_', ' ')}\n\n![{name}](gallery/{name}.png)\n\n```\n{said}\n```\n\n"
            f"<details><summary>{counts}: the manifest</summary>\n\n```toml\n{manifest}\n```\n\n</details>\n"
        )
    return "\n".join(made), pictures


_GALLERY = """# Gallery

Mechanisms of `fixtures/mechanisms`, each as meshes and a manifest: what kinform draws of it, what `kinform run` says
of it, and its manifest. Written by `python docs/generate.py`; to see one move: `kinform report
fixtures/mechanisms/four_bar/four_bar.toml -o four_bar.html --open`.
"""


def mechanisms() -> list[Path]:
    """The manifests of the gallery."""
    return sorted(
        folder / f"{folder.name}.toml" for folder in (ROOT / "fixtures" / "mechanisms").iterdir() if folder.is_dir()
    )


def readme(text: str, work: Path) -> str:
    """The README with what `make demo` prints now."""
    printed = demo(work)
    return _DEMO.sub(lambda m: m[1] + printed + m[2], text)


def _write() -> None:
    with tempfile.TemporaryDirectory() as folder:
        page = ROOT / "docs" / "seeker.md"
        text, pictures = story(page.read_text(encoding="utf-8"), Path(folder) / "story")
        page.write_text(text, encoding="utf-8")
        images = ROOT / "docs" / "images"
        images.mkdir(exist_ok=True)
        for old in images.iterdir():
            if old.name not in pictures:
                old.unlink()
        for name, content in pictures.items():
            (images / name).write_bytes(content)
        import kinform

        text, pictures = gallery({path.stem: kinform.run(path).design for path in mechanisms()})
        (ROOT / "docs" / "gallery.md").write_text(text, encoding="utf-8")
        shutil.rmtree(ROOT / "docs" / "gallery", ignore_errors=True)
        (ROOT / "docs" / "gallery").mkdir()
        for name, content in pictures.items():
            (ROOT / "docs" / "gallery" / name).write_bytes(content)
        page = ROOT / "README.md"
        page.write_text(readme(page.read_text(encoding="utf-8"), Path(folder) / "demo"), encoding="utf-8")


if __name__ == "__main__":
    _write()

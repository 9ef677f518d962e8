"""Writes again what the documentation shows the program print: `python docs/generate.py`.

In `docs/seeker.md` every `console` block is run as it stands, in the folder of `fixtures/seeker` that the comment
above it names (`<!-- in FOLDER -->`), on a copy of the fixtures that lasts for the whole page; what a command prints
is put below it, and its exit code where that is not 0. `<!-- picture FOLDER/FILE as NAME -->` takes a file that a
command wrote to `docs/images`. In `README.md` the block between `<!-- demo -->` and `<!-- /demo -->` is what `make
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
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

__all__ = ["demo", "readme", "story"]

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
    lines = [line.rstrip() for line in ran.stdout.splitlines() if not line.startswith("make[")]
    return "\n".join(lines) + "\n"


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
        page = ROOT / "README.md"
        page.write_text(readme(page.read_text(encoding="utf-8"), Path(folder) / "demo"), encoding="utf-8")


if __name__ == "__main__":
    _write()

"""Hostile names go through the formats of the commands; what comes out is parsed by its reader, and scanned."""

from __future__ import annotations

import csv
import io
import json
import re
import shutil
import subprocess
import tomllib
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import pytest
from _pytest.mark import ParameterSet
from hostile.names import FEW, NAMES, forbidden, manifest, write_all
from support.command_line import ran_here

from kinform.exports import FORMATS as EXPORTS
from kinform_cli.files import ALWAYS, make_rule

FINDINGS = ("brief", "concise", "full", "github", "json", "junit", "md", "sarif")
TOPICS = ("assembly", "contacts", "joints", "bodies", "mobility", "mass", "behaviour", "simulation", "findings")
QUICK = ("assembly", "joints", "dot", "svg", "urdf")
"""Topics and exports that are tested always."""


def slow(value: str) -> ParameterSet:
    """The value, tested with those that are slow."""
    return pytest.param(value, marks=pytest.mark.slow)


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """The designs, and the results of the manifest."""
    made = tmp_path_factory.mktemp("hostile")
    write_all(made)
    (made / "m.toml").write_text(manifest(FEW), encoding="utf-8")
    ran = ran_here("run", "m.toml", "-o", "m.h5", cwd=made)
    assert ran.returncode == 1, ran.stderr
    assert not forbidden(ran.stdout + ran.stderr)
    return made


def parsed(format: str, text: str) -> None:
    """Raises where a parser of the format does not read it."""
    if format in ("json", "sarif"):
        json.loads(text)
    elif format == "junit":
        ElementTree.fromstring(text)


@pytest.mark.parametrize("format", FINDINGS)
def test_findings_are_parsed_and_command_nobody(folder, format):
    ran = ran_here("check", "m.h5", "-f", format, cwd=folder)
    assert ran.returncode == 1
    parsed(format, ran.stdout)
    assert not forbidden(ran.stdout, commands=format != "github")
    assert not forbidden(ran.stderr)
    if format == "github":
        *lines, last = ran.stdout.splitlines()
        assert all(re.match(r"::(error|warning|notice) ", line) and not forbidden(line[2:]) for line in lines)
        assert not forbidden(last)


@pytest.mark.parametrize("topic", [topic if topic in QUICK else slow(topic) for topic in TOPICS])
@pytest.mark.parametrize("format", ["table", slow("json")])
def test_topics_are_parsed_and_command_nobody(folder, topic, format):
    ran = ran_here("show", "m.h5", topic, "--format", format, cwd=folder)
    assert ran.returncode == 0, ran.stderr
    parsed(format, ran.stdout)
    assert not forbidden(ran.stdout + ran.stderr)


@pytest.mark.slow
def test_colours_are_all_that_a_terminal_is_sent(folder):
    for topic in ("assembly", "joints", "findings"):
        ran = ran_here("show", "m.h5", topic, cwd=folder, FORCE_COLOR="1")
        assert not forbidden(ran.stdout, colours=True)


@pytest.mark.slow
def test_a_name_never_becomes_a_line_of_a_table(folder):
    for topic in TOPICS:
        lines = ran_here("show", "m.h5", topic, cwd=folder, COLUMNS="3000").stdout.splitlines()
        assert not any(re.match(r"\s*(\\x3a:error::A|; end entity)", line) for line in lines), topic


@pytest.mark.parametrize("arguments", [
    ("query", "m.h5", "--intended"), ("query", "m.h5", "--intended", "--format", "json"), ("diff", "m.h5", "m.h5"),
    ("init", "r.urdf"), ("query", "m.h5", FEW[1], FEW[2], "--slide", "x"), ("show", "m.h5", "--joint", FEW[3]),
    ("explain", NAMES[5]), ("explain", NAMES[1]), ("run", NAMES[1] + ".toml"), ("run", "a\x1b[2J.toml"),
    ("check", "m.h5", "-f", NAMES[1]), ("lock", "m.h5", "-o", "lock.json"), ("run", "r.xml"), ("run", "r.sdf"),
    ("catalog", "build", "m.h5", "-o", "c.db"),
], ids=lambda arguments: " ".join(arguments[:2]).encode("unicode_escape").decode()[:20])  # fmt: skip
def test_what_commands_say_commands_nobody(folder, arguments):
    ran = ran_here(*arguments, cwd=folder)
    assert "internal error" not in ran.stderr
    assert not forbidden(ran.stdout + ran.stderr)
    if "json" in arguments:
        json.loads(ran.stdout)
    if arguments[0] == "init" and ran.returncode == 0:
        tomllib.loads(ran.stdout)


class _Page(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.inside, self.programs, self.images = "", list[str](), 0

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.inside = tag
        self.images += tag == "img" and any(name == "onerror" for name, _ in attributes)

    def handle_data(self, data: str) -> None:
        if self.inside == "script":
            self.programs.append(data)


@pytest.mark.slow
def test_the_page_runs_nothing_of_a_name(folder):
    ran = ran_here("report", "m.h5", "-o", "m.html", "--png", "png", cwd=folder)
    assert ran.returncode == 0, ran.stderr
    page = _Page()
    page.feed((folder / "m.html").read_text())
    assert page.images == 0
    assert "alert(1)" not in [program.strip() for program in page.programs]
    assert not forbidden((folder / "m.html").read_text(), commands=False)
    assert not forbidden((folder / "png" / "summary.md").read_text())


def tokens_of_dot(text: str) -> list[str]:
    """Words, strings and signs of the DOT language; AssertionError for what is none of them."""
    found = re.findall(r'"(?:[^"\\]|\\.)*"|->|--|[{}\[\]=;,]|[\w.]+|\s+|(.)', text, re.DOTALL)
    assert not any(found), found
    return re.findall(r'"(?:[^"\\]|\\.)*"', text, re.DOTALL)


@pytest.mark.parametrize("format", [format if format in QUICK else slow(format) for format in EXPORTS])
def test_exports_are_parsed_and_stay_in_their_folder(folder, format, tmp_path):
    ran = ran_here("export", "m.h5", "--to", format, "-o", tmp_path / "out", cwd=folder)
    assert "internal error" not in ran.stderr
    assert not forbidden(ran.stdout + ran.stderr)
    files = [path for path in (tmp_path / "out").rglob("*") if path.is_file()]
    if format == "csv":  # sticks do not move
        return
    assert files, ran.stderr
    assert all(re.fullmatch(r"[A-Za-z0-9_][\w.-]*", path.name, re.ASCII) for path in files)
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == files
    for path in files:
        if path.suffix in (".glb", ".stl"):
            continue
        text = path.read_text(encoding="utf-8")
        assert not forbidden(text), path
        if path.suffix in (".svg", ".urdf", ".sdf", ".xml"):
            ElementTree.fromstring(text)
        elif path.suffix == ".json":
            json.loads(text)
        elif path.suffix == ".dot":
            assert len(tokens_of_dot(text)) >= len(FEW)
        elif path.suffix == ".vhd":
            assert text.isascii()


def test_cells_are_no_formulas_and_numbers_stay_numbers():
    from kinform.foundation.escapes import csv_cell

    line = ",".join([*map(csv_cell, NAMES), "-1.5"])
    (row,) = csv.reader(io.StringIO(line))
    assert len(row) == len(NAMES) + 1 and row[-1] == "-1.5"
    assert not any(re.search(r"(^\s*|;)[=+\-@\t\r]", cell) for cell in row[:-1])
    assert csv_cell("plain name, with comma") == '"plain name, with comma"'


@pytest.mark.skipif(shutil.which("make") is None, reason="make is not installed")
@pytest.mark.parametrize("name", [
    *NAMES, "A=1\n-include\tevil.mk", "x;touch made-by-make;.stl", "a b.stl", "a#b", "a$b", "a%b", "a:b", ".IGNORE",
    "define x", "include", "a|b", "a&", "a\\", "(a)", "trail ", "~root", "`touch made-by-make`", "é.stl", "-f",
])  # fmt: skip
def test_make_reads_the_file_or_always_makes_the_target(tmp_path, name):
    (tmp_path / "evil.mk").write_text("$(shell touch made-by-make)\n")
    rule = make_rule(Path("out.h5"), [Path(name), Path("plain.stl")])
    (tmp_path / "d").write_text(rule, encoding="utf-8")
    (tmp_path / "Makefile").write_text("out.h5:\n\t@touch out.h5; echo made\ninclude d\n")
    (tmp_path / "plain.stl").touch()
    if ALWAYS not in rule:
        (tmp_path / name).touch()
    command = ["make", "-rR", "out.h5"]
    first, again = (subprocess.run(command, cwd=tmp_path, capture_output=True, text=True) for _ in range(2))
    assert first.returncode == again.returncode == 0, first.stderr
    assert "made\n" in first.stdout
    assert ("made\n" in again.stdout) == (ALWAYS in rule)
    assert not (tmp_path / "made-by-make").exists()


@pytest.mark.sweep
@pytest.mark.parametrize("design", ["m.toml", "r.urdf", "r.xml", "r.sdf"])
@pytest.mark.parametrize("format", FINDINGS)
def test_every_design_in_every_format_of_findings(folder, design, format):
    write_all(folder)
    ran = ran_here("run", design, "-f", format, cwd=folder)
    assert "internal error" not in ran.stderr
    parsed(format, ran.stdout)
    assert not forbidden(ran.stdout, commands=format != "github")
    assert not forbidden(ran.stderr)

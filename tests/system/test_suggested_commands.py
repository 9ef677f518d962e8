"""Every command that messages, rules, help and documents suggest is one that the command line takes."""

from __future__ import annotations

import ast
import re
import shlex
from collections.abc import Iterator
from enum import EnumType
from pathlib import Path

import pytest
import typer
from support.places import FIXTURES, ROOT

from kinform.consistency import RULES, explain
from kinform.reports import render
from kinform_cli.app import app
from kinform_cli.main import main

COMMAND = typer.main.get_command(app)
NAMES = "|".join(sorted(COMMAND.commands))  # type: ignore[attr-defined]
QUOTED = re.compile(r"`(?:[A-Z]+=\d+ )?kinform ([^`]+)`")
TOLD = re.compile(rf"(?:^|[\s(:$])kinform ((?:{NAMES})\b[^`\n]*)")
END = re.compile(r"  |, |;|\)| #| \(| and | does |: |(?<=\w)\.$|\. | \| | > | && ")
MAYBE = re.compile(r"""(?<!from )\bkinform [a-z{"'-]""")
"""Before a module is parsed."""
HOLE = "X1"
"""Stands for what a message fills in."""


def texts(tree: ast.AST) -> Iterator[str]:
    """The strings of a module, its docstrings included; what is filled in is a word."""
    inside = {id(part) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for part in ast.walk(node)}
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            yield "".join(str(p.value) if isinstance(p, ast.Constant) else HOLE for p in node.values)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in inside:
            yield node.value


def split(words: str) -> list[str]:
    words = re.sub(r"[][]", "", words)  # as in [-o FILE]
    try:
        return shlex.split(words, comments=True)
    except ValueError:  # an apostrophe in what follows
        return words.split()


def suggested(text: str) -> Iterator[list[str]]:
    """Words after `kinform` of the commands in a text."""
    for match in QUOTED.finditer(text):
        yield split(" ".join(match[1].split()).split(" | ")[0].split(" > ")[0])
    for match in TOLD.finditer(QUOTED.sub("", text)):
        words = END.split(match[1])[0].split(" …")[0]
        yield split(words)


def refusal(words: list[str]) -> str | None:
    """Why the command line would not take these words; None where it would, once what is missing is added."""
    command, rest = COMMAND, words
    while hasattr(command, "commands") and rest:
        if rest[0] not in command.commands:
            return None if rest[0].startswith(("-", HOLE)) or "." in rest[0] or "/" in rest[0] else f"no {rest[0]!r}"
        command, rest = command.commands[rest[0]], rest[1:]
    context = type(COMMAND).context_class(command, info_name="kinform")
    try:
        values, left, _ = command.make_parser(context).parse_args(list(rest))
    except Exception as error:
        return None if "requires an argument" in str(error) else str(error) or type(error).__name__
    if left:
        return f"{left} too many"
    for parameter in command.params:
        value = values.get(parameter.name)
        choices = allowed(parameter)
        if choices and isinstance(value, str) and value != HOLE and not value.isupper() and value not in choices:
            return f"{value!r} is none of {sorted(choices)}"
    return None


def allowed(parameter) -> set[str]:
    """The words that a parameter takes, where these are few; typer 0.20 and before keep them as click does."""
    if not hasattr(parameter, "type_descriptor"):
        return {getattr(choice, "value", choice) for choice in getattr(parameter.type, "choices", ())}
    kind = parameter.type_descriptor.annotation
    return set(kind) if isinstance(kind, EnumType) else set()


def sources() -> list[Path]:
    python = [path for root in ("pipeline", "cli") for path in sorted((ROOT / root).rglob("*.py"))]
    return python + sorted(ROOT.glob("*.md")) + sorted((ROOT / "docs").glob("*.md"))


def test_commands_in_sources_and_documents_are_taken():
    wrong, seen = [], set()
    for path in sources():
        whole = path.read_text(encoding="utf-8")
        if path.suffix == ".py" and not MAYBE.search(whole):
            continue
        for text in texts(ast.parse(whole)) if path.suffix == ".py" else [whole]:
            for words in suggested(text):
                seen.add(tuple(words))
                why = refusal(words)
                if why is not None:
                    wrong.append(f"{path.relative_to(ROOT)}: kinform {' '.join(words)}: {why}")
    assert not wrong, "\n".join(wrong)
    assert len(seen) > 100 and {words[0] for words in seen if words} >= set(COMMAND.commands) - {"schema"}


def test_wrong_commands_are_seen():
    assert refusal(["show", "F.h5", "joints", "--joint", "NAME"]) is None
    assert refusal(["show", "F.h5", "forces"]) is not None
    assert refusal(["show", "F.h5", "--joints"]) is not None
    assert refusal(["catalogue", "add"]) is not None
    assert refusal(["catalog", "remove"]) is not None
    assert refusal(["lock", "a.h5", "b.h5"]) is not None
    assert list(suggested("first `kinform run M.toml -o\n   M.h5`, then")) == [["run", "M.toml", "-o", "M.h5"]]


def test_codes_that_rules_name_are_rules():
    known = {rule.code for rule in RULES}
    for rule in RULES:
        for code in re.findall(r"KF\d{3}", explain(rule.code)):
            assert code in known, f"{rule.code} names {code}"


DEAR = ("seeker_wrong_units", "seeker_missing_dowel", "seeker_open_mesh")


@pytest.mark.parametrize(
    "fixture",
    [
        pytest.param(path.name, marks=pytest.mark.slow if path.name in DEAR else [])
        for path in sorted((FIXTURES / "broken").iterdir())
    ],
)
def test_what_findings_suggest_is_taken(fixture, derive_design):
    design = derive_design(FIXTURES / "broken" / fixture / f"{fixture}.toml")
    text = " ".join(render(design.report, design, "full").split())
    for words in suggested(text):
        assert refusal(words) is None, words


def test_what_comes_next_works_as_it_is_written(tmp_path, monkeypatch, capsys):
    """From meshes in a folder with a blank in its name to a page, by nothing but what is printed."""
    folder = tmp_path / "my arm"
    folder.mkdir()
    for mesh in (FIXTURES / "pairs" / "revolute_fork").glob("*.stl"):
        (folder / mesh.name).write_bytes(mesh.read_bytes())
    monkeypatch.chdir(tmp_path)
    names = sorted(str(path.relative_to(tmp_path)) for path in folder.iterdir())
    assert main(["init", *names, "--units", "mm", "-o", "my arm/arm.toml"]) == 0
    then = re.search(r"then: kinform (.*)", capsys.readouterr().err)[1]
    assert main(shlex.split(then)) in (0, 1)
    told = capsys.readouterr().err
    following = re.findall(r"(?:next|or): kinform (.*?)(?:   \(.*)?$", told, re.MULTILINE)
    assert len(following) == 2
    for command in following:
        assert main(shlex.split(command)) == 0
    assert (tmp_path / "my arm" / "arm.html").is_file()


def test_where_nothing_was_kept_the_command_that_keeps_it_works(tmp_path, monkeypatch, capsys):
    for mesh in (FIXTURES / "pairs" / "revolute_fork").glob("*.stl"):
        (tmp_path / mesh.name).write_bytes(mesh.read_bytes())
    monkeypatch.chdir(tmp_path)
    meshes = sorted(path.name for path in tmp_path.glob("*.stl"))
    main(["run", *meshes, "--units", "mm"])
    again = re.search(r"nothing was kept: kinform (.*?) keeps it", " ".join(capsys.readouterr().err.split()))
    assert again is not None
    assert main(shlex.split(again[1])) in (0, 1)
    assert len(list(tmp_path.glob("*.h5"))) == 1

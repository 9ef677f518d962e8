"""What every invocation has in common: help, version, usage errors, completion, quick start."""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import entry_points
from pathlib import Path

import pytest
import typer
from support.command_line import Ran, modules_after

from kinform import __version__
from kinform_cli.app import COMMANDS as REGISTERED
from kinform_cli.app import app
from kinform_cli.main import entry, main

COMMANDS = sorted(REGISTERED)
HEAVY = {"scipy", "trimesh", "numba", "h5py", "numpy", "manifold3d", "fcl", "pydantic", "matplotlib", "jinja2"}


def test_the_console_script_is_the_entry() -> None:
    (script,) = entry_points(group="console_scripts", name="kinform")
    assert script.load() is entry


def test_the_commands_are_those_of_the_contract_so_far() -> None:
    assert COMMANDS == sorted(
        "import contacts joints mass simulate check run show query report export explain init schema diff lock watch "
        "catalog batch study".split()
    )


def test_version_is_that_of_the_package(kinform: Callable[..., Ran]) -> None:
    ran = kinform("--version")
    assert (ran.returncode, ran.stdout, ran.stderr) == (0, f"kinform {__version__}\n", "")


@pytest.mark.parametrize("arguments", [["--version"], ["--help"], ["run", "--help"]], ids=" ".join)
def test_nothing_heavy_is_imported_to_answer(arguments: list[str]) -> None:
    imported = {name.split(".")[0] for name in modules_after(arguments)}
    assert "typer" in imported
    assert not imported & (HEAVY - {"pydantic"})


def test_a_command_imports_the_module_of_no_other() -> None:
    commands = [name for name in modules_after(["schema", "--help"]) if name.startswith("kinform_cli.commands.")]
    assert commands == ["kinform_cli.commands.schema"]


@pytest.mark.parametrize("command", COMMANDS)
def test_help_of_each_command_ends_with_examples_of_it(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([command, "--help"]) == 0
    text, errors = capsys.readouterr()
    assert errors == ""
    usage, examples = text.split("Examples:")
    assert f"kinform {command}" in usage
    assert f"kinform {command}" in examples


def test_examples_use_options_that_exist() -> None:
    """Every line of every example is understood: no unknown command or option."""
    group = typer.main.get_command(app)

    def options_of(command):
        below = getattr(command, "commands", {}).values()
        flags = {flag for parameter in command.params for flag in (*parameter.opts, *parameter.secondary_opts)}
        return flags.union(*map(options_of, below))

    options = {name: options_of(command) for name, command in group.commands.items()}
    for name, command in group.commands.items():
        for line in command.epilog.splitlines():
            words = line.split("#")[0].split("|")[0].split()
            if words[:1] != ["kinform"]:
                continue
            assert words[1] in options, line
            flags = {word for word in words[2:] if word.startswith("-") and not word[1:2].isdigit()}
            assert flags <= options[words[1]], f"{name}: {line}"


def test_without_arguments_it_helps_and_is_not_a_success(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 2
    assert "Usage: kinform" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["frobnicate"], "frobnicate"),
        (["--frobnicate"], "--frobnicate"),
        (["contacts", "a.h5"], "--output"),
        (["contacts", "a.h5", "-o", "b.h5", "--jobs", "0"], "--jobs"),
        (["contacts", "a.h5", "-o", "b.h5", "--jobs", "many"], "--jobs"),
        (["check"], "F.h5"),
        (["check", "a.h5", "--format", "xml"], "--format"),
        (["check", "a.h5", "--fail-on", "never"], "--fail-on"),
        (["show", "a.h5", "masses"], "masses"),
        (["simulate", "a.h5", "-o", "b.h5", "--level", "total"], "--level"),
        (["query", "a.h5", "a", "b"], "--turn"),
        (["query", "a.h5", "a", "b", "--turn", "z@0,0,0", "--slide", "x"], "--turn"),
        (["query", "a.h5", "a", "b", "--turn", "z"], "--turn"),
        (["query", "a.h5", "a", "b", "--turn", "z@0,0"], "--turn"),
        (["query", "a.h5", "a", "b", "--slide", "0,0,0"], "--slide"),
        (["query", "a.h5", "a", "b", "--slide", "0,nan,1"], "--slide"),
        (["report", "a.h5", "--notes"], "--notes"),
    ],
    ids=" ".join,
)
def test_usage_errors_name_what_is_wrong_and_exit_2(
    arguments: list[str], named: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    text, errors = capsys.readouterr()
    assert text == ""
    assert named in errors
    assert "error:" in errors
    assert "--help" in errors
    assert "Traceback" not in errors


@pytest.mark.parametrize("shell", ["bash", *(pytest.param(s, marks=pytest.mark.sweep) for s in ("zsh", "fish"))])
def test_a_completion_script_is_printed_for_each_shell(shell: str, kinform: Callable[..., Ran]) -> None:
    ran = kinform("--show-completion", shell, _TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION="1")
    assert ran.returncode == 0
    assert "_KINFORM_COMPLETE" in ran.stdout


def test_completion_offers_commands_topics_and_choices(kinform: Callable[..., Ran]) -> None:
    def offered(line: str) -> set[str]:
        words = line.split(" ")
        ran = kinform(_KINFORM_COMPLETE="complete_bash", COMP_WORDS=line, COMP_CWORD=str(len(words) - 1))
        return set(ran.stdout.split())

    assert offered("kinform s") == {"simulate", "show", "schema", "study"}
    assert {"joints", "findings"} <= offered("kinform show a.h5 ")
    assert offered("kinform check --fail-on ") == {"error", "warning", "note"}


def test_help_reads_at_80_columns(command: Callable[..., Ran]) -> None:
    for name in COMMANDS:
        lines = command(name, "--help", COLUMNS="80").stdout.splitlines()
        assert 60 < max(map(len, lines)) <= 80, name


def test_meshes_without_a_unit_are_told_what_to_add(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.stl").write_bytes(bytes(84))
    assert main(["init", str(tmp_path / "a.stl")]) == 2
    assert "--units mm" in capsys.readouterr().err
